"""A camera that is known before the first view, in the place of the start-up's estimate.

It is a prior for guidance alone. The first targets are searched for what it leaves open, and the
board is followed with it, until the new views determine a camera by themselves; the calibration is
theirs alone. An older calibration that no longer holds so costs a few views at most, and is never
mixed into a result.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.information import covariance_of
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera, planning_camera
from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.startup import Startup
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import Cost, Method
from venus3d.engine.planning.suggest import Planner
from venus3d.engine.planning.target import Target

_NOISE_PX = 0.25
"""Of a corner, as long as no view shows it."""


@dataclass(frozen=True, eq=False)
class KnownCamera:
    """A camera from an earlier calibration."""

    camera: Camera
    information: Array
    """(p, p) inverse of the covariance of its parameters; zero rows and columns for those whose
    uncertainty is not known. For them `prior_information` stands: 30 % of f, 10 % of the width."""

    @classmethod
    def of(cls, camera: Camera, covariance: Array | None = None) -> KnownCamera:
        """A camera with its covariance (p, p); zero rows and columns, or None: not known."""
        information = np.zeros((len(camera.parameters),) * 2)
        if covariance is not None:
            known = np.flatnonzero(np.diag(covariance) > 0)
            part = np.ix_(known, known)
            if _is_covariance(covariance[part]):
                information[part] = covariance_of(covariance[part])  # the inverse
        return cls(camera, information)

    @property
    def has_uncertainty(self) -> bool:
        """Whether it is known how well it is known."""
        return bool(self.information.any())


def _is_covariance(matrix: Array) -> bool:
    if not matrix.size or not np.isfinite(matrix).all():
        return False
    scale = 1.0 / np.sqrt(np.diag(matrix))
    return bool(np.linalg.eigvalsh(matrix * scale[:, None] * scale).min() > 1e-10)


class KnownStart(Startup):
    """The start from a known camera: nothing is estimated, and target 1 is searched."""

    def __init__(self, board: Board, known: KnownCamera, settings: Settings) -> None:
        """Start with a board; the limits and the search are those of the settings."""
        super().__init__(board, known.camera.image_size)
        self._known, self._settings = known, settings
        self.camera = known.camera

    @property
    def is_ready(self) -> bool:
        """From the beginning."""
        return True

    def observe(self, observation: Observation) -> bool:
        """Nothing to learn from a single frame."""
        return False

    def updated_target(
        self, old: Target | None, number: int, method: Method, cost: Cost | None
    ) -> Target | None:
        """The best first view for what the known camera leaves open, searched once; None if the
        limits leave no pose."""
        if old is not None:
            return old
        settings, known = self._settings, self._known
        posterior = Posterior.of(
            self._board,
            planning_camera(known.camera),
            np.zeros_like(known.information),
            _NOISE_PX,
            known=known.information,
        )
        planner = Planner(posterior, settings, Space.of(posterior, settings))
        rng = np.random.default_rng([settings.seed, number])
        try:
            return planner.next_target(number, rng).target
        except VenusError:
            return None

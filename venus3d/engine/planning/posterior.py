"""What is known of a camera now, and what one more view would make of it.

The start of everything that plans ahead: the suggestion, its alternatives, the forecast, the test
whether a view is useful. What a pose is worth to a search is left to `costs`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.calibration.corner_noise import NoiseModel
from venus3d.engine.calibration.information import (
    covariance_of,
    prior_information,
    view_information,
)
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera, planning_camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.costs import predicted_covariance, projection_uncertainty_px


@dataclass(frozen=True, eq=False)
class Posterior:
    """The information gathered so far, with the camera to plan with."""

    board: Board
    camera: Camera
    information: Array
    """(9, 9) for corner noise of one pixel; never singular."""
    sigma_px: float
    """Standard deviation of a corner coordinate, pixels."""
    noise: NoiseModel | None = None
    """How noise and found corners depend on the pose; None: they do not."""
    settled: bool = True
    """Whether the views alone say this much; otherwise a wide prior is part of the information."""

    @classmethod
    def of(
        cls,
        board: Board,
        camera: Camera,
        information: ArrayLike,
        sigma_px: float,
        noise: NoiseModel | None = None,
    ) -> Posterior:
        """The posterior after views of this `information`, (9, 9).

        The wide prior of `prior_information` is added while the views alone say less than it does.
        """
        known = np.asarray(information, dtype=np.float64)
        prior = prior_information(camera, sigma_px)
        settled = _settled(known, prior, sigma_px)
        if not settled:
            known = known + prior
        return cls(board, planning_camera(camera), known, sigma_px, noise, settled)

    @cached_property
    def covariance(self) -> Array:
        """(9, 9) of the intrinsics now."""
        return covariance_of(self.information, self.sigma_px)

    @cached_property
    def uncertainty_px(self) -> float:
        """Mean projection error over the image to expect now, pixels, the prior included."""
        return projection_uncertainty_px(self.camera, self.covariance)

    def after(self, vectors: ArrayLike) -> Array:
        """(N, 9, 9) covariances after one more view under each pose vector (N, 6)."""
        return self.sigma_px**2 * predicted_covariance(
            self.board, self.camera, self.information, vectors, noise=self.noise
        )

    def with_view(self, vector: ArrayLike) -> Posterior:
        """The posterior once a view under the pose vector (6,) is taken."""
        # The inverse of a covariance is its information.
        after = covariance_of(self.after(vector)[0] / self.sigma_px**2)
        return replace(self, information=after)

    def with_seen(self, observation: Observation, pose: Pose) -> Posterior:
        """The posterior with a view as it is seen: those corners, under that pose."""
        points = self.board.points_of(observation.ids)
        told = view_information(self.camera, points, pose.R[None], pose.t[None])[0]
        return replace(self, information=self.information + told)


def _settled(information: Array, prior: Array, sigma_px: float) -> bool:
    """Whether the views alone know each parameter better than the prior does."""
    with np.errstate(all="ignore"):
        try:
            variance = np.diag(covariance_of(information, sigma_px))
        except np.linalg.LinAlgError:
            return False
    # A variance below zero, or none: the information is singular but for rounding.
    return bool((variance > 0).all() and (variance < sigma_px**2 / np.diag(prior)).all())

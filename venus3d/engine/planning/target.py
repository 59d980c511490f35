"""The next target: the pose, its purpose, and its expected gain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PARAMETERS, Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.method import Cost, Method


@dataclass(frozen=True, eq=False)
class Target:
    """A pose for the user to reach, its purpose, and the steps to it."""

    number: int
    """Counts from 1; skipped targets are counted."""
    pose: Pose
    steps: Steps
    """Eq. (15): from the frontal, upright board to the target."""
    method: Method
    cost: Cost
    serves: tuple[str, ...]
    """The parameters this view helps most, best first."""
    reason: str
    """One sentence: the purpose of this pose."""
    predicted_sigma: Array
    """(9,) expected standard deviations after this view; NaN if unknown."""
    predicted_uncertainty_px: float
    """Projection uncertainty over the image after this view, pixels; NaN if unknown."""
    evaluated: int
    """Number of candidate poses evaluated."""
    search_s: float
    """Duration of the search."""
    uncertainty_px: float = float("nan")
    """Projection uncertainty over the image before this view, pixels; NaN if unknown."""
    alternatives: tuple[Target, ...] = ()
    """Clearly different poses that are nearly as good, best first."""
    held: str = ""
    """How the board is held, in a few words: upright or turned, place, tilt, distance."""

    @property
    def gain_px(self) -> float:
        """Expected drop of the projection uncertainty by this view, pixels; NaN if unknown."""
        return self.uncertainty_px - self.predicted_uncertainty_px


def unpredicted_target(
    number: int,
    pose: Pose,
    camera: Camera,
    board: Board,
    *,
    reason: str,
    method: Method = "global",
    cost: Cost = "projection-variance",
    serves: tuple[str, ...] = (),
) -> Target:
    """A target without a search, whose gain is unknown."""
    return Target(
        number=number,
        pose=pose,
        steps=decompose(pose, camera, board),
        method=method,
        cost=cost,
        serves=serves,
        reason=reason,
        predicted_sigma=np.full(len(PARAMETERS), np.nan),
        predicted_uncertainty_px=float("nan"),
        evaluated=0,
        search_s=0.0,
    )

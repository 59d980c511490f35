"""The next target: the pose asked for, what it is for, and what it is expected to give."""

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
    """The pose asked for, why, and how to get there."""

    number: int
    """Counts from 1; a skipped target uses up its number."""
    pose: Pose
    steps: Steps
    """Eq. (15): from the frontal, upright board to the target."""
    method: Method
    cost: Cost
    serves: tuple[str, ...]
    """The parameters this view helps most, best first."""
    reason: str
    """One sentence: what this pose is for."""
    predicted_sigma: Array
    """(9,) expected standard deviations after this view; NaN where not known."""
    predicted_uncertainty_px: float
    """Projection uncertainty over the image after this view, pixels; NaN where not known."""
    evaluated: int
    """How many candidate poses were looked at."""
    search_s: float
    """How long the search took."""
    uncertainty_px: float = float("nan")
    """Projection uncertainty over the image before this view, pixels; NaN where not known."""
    alternatives: tuple[Target, ...] = ()
    """Clearly different poses that are nearly as good, best first; one may suit the wrists."""
    held: str = ""
    """In a few words, how the board is held there: upright or turned, place, tilt, distance."""

    @property
    def gain_px(self) -> float:
        """By how much this view should lower the projection uncertainty, pixels; NaN if unknown."""
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
    """A target that no search has found: what it would give is not known."""
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

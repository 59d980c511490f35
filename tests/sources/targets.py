"""Targets as a search would ask for them: random poses within the default limits."""

from __future__ import annotations

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.target import Target


def random_poses(camera: Camera, board: Board, count: int, seed: int = 0) -> list[Pose]:
    """Valid target poses."""
    rng = np.random.default_rng(seed)
    low = [-60, -60, -45, -0.25, -0.15, 0.22]
    high = [60, 60, 45, 0.25, 0.15, 0.7]
    limits, found = Limits(), []
    while len(found) < count:
        vectors = rng.uniform(low, high, (200, 6))
        found += [Pose.from_vector(p) for p in vectors[limits.accepts(camera, board, vectors)]]
    return found[:count]


def target_of(pose: Pose, camera: Camera, board: Board, number: int = 1) -> Target:
    """A target that asks for this pose."""
    unknown: Array = np.full(9, np.nan)
    return Target(
        number=number,
        pose=pose,
        steps=decompose(pose, camera, board),
        method="random",
        cost="projection-variance",
        serves=(),
        reason="",
        predicted_sigma=unknown,
        predicted_uncertainty_px=float("nan"),
        evaluated=1,
        search_s=0.0,
    )

"""The space of allowed poses, and its map from the unit cube."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose, rotations_of
from venus3d.engine.planning.limit_projection import onto_limits
from venus3d.engine.planning.limits import Limits, Mask
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import PlanningSettings

SKIPPED_DEG = 15.0
SKIPPED_FRACTION = 0.1
_TRIES = 50  # batches of 64 poses drawn for a random one within the limits


@dataclass(frozen=True, eq=False)
class Space:
    """The allowed poses: within the limits and not near a skipped one."""

    board: Board
    camera: Camera
    limits: Limits
    skipped: tuple[Pose, ...] = ()
    """Poses within 15 degrees and a tenth of the distance are not offered again."""

    @staticmethod
    def of(posterior: Posterior, settings: PlanningSettings, skipped: Iterable[Pose] = ()) -> Space:
        """The space for a plan with these settings."""
        board, camera = posterior.board, posterior.camera
        return Space(board, camera, settings.limits_for(board, camera), tuple(skipped))

    def accepts(self, vectors: ArrayLike) -> Mask:
        """Which pose vectors (N, 6) are in the space: (N,) bool."""
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        good = self.limits.accepts(self.camera, self.board, p)
        for pose in self.skipped:
            good &= ~_near(p, pose)
        return good

    def bring_inside(self, vectors: Array) -> tuple[Array, Mask]:
        """Pose vectors (N, 6) moved onto the limits they break, and which (N,) are now inside."""
        moved, good = onto_limits(self.limits, self.camera, self.board, vectors)
        for pose in self.skipped:
            # Only those: the others may be anywhere, even beyond the range of floats.
            good[good] = ~_near(moved[good], pose)
        return moved, good

    def excess(self, vectors: Array) -> Array:
        """(N,) how far pose vectors (N, 6) are outside: 0 inside, else a slope that leads back.
        By how much they break the limits (`Limits.excess`), plus 1 for each skipped pose nearby."""
        total = self.limits.excess(self.camera, self.board, vectors)
        for pose in self.skipped:
            total += _near(vectors, pose)
        return total

    def from_unit(self, unit: Array) -> Array:
        """Points (N, 6) of the unit cube to pose vectors (N, 6), most of them not in the space.

        Three angles over their range, the board's centre over the image, its distance over the
        logarithm of its range.
        """
        limits, camera = self.limits, self.camera
        angles = (2 * unit[:, :3] - 1) * limits.max_angle_deg
        z = limits.nearest * (limits.farthest / limits.nearest) ** unit[:, 5]
        x = (unit[:, 3] * camera.width - 0.5 - camera.cx) / camera.fx * z
        y = (unit[:, 4] * camera.height - 0.5 - camera.cy) / camera.fy * z
        return np.column_stack([angles, x, y, z])

    def to_unit(self, vectors: Array) -> Array:
        """The inverse of `from_unit`."""
        limits, camera = self.limits, self.camera
        z = vectors[:, 5]
        return np.column_stack(
            [
                (vectors[:, :3] / limits.max_angle_deg + 1) / 2,
                (vectors[:, 3] / z * camera.fx + camera.cx + 0.5) / camera.width,
                (vectors[:, 4] / z * camera.fy + camera.cy + 0.5) / camera.height,
                np.log(z / limits.nearest) / np.log(limits.farthest / limits.nearest),
            ]
        )


def random_pose(space: Space, rng: np.random.Generator) -> Array:
    """(6,) a random pose vector of the space. Raises `VenusError` if none is found."""
    for _ in range(_TRIES):
        vectors = space.from_unit(rng.random((64, 6)))
        good = np.flatnonzero(space.accepts(vectors))
        if good.size:
            return vectors[good[0]]
    raise nothing_fits(space)


def _near(vectors: Array, pose: Pose) -> Mask:
    """Which vectors (N, 6) are within 15 degrees and a tenth of the distance of a pose."""
    shift = np.linalg.norm(vectors[:, 3:] - pose.t, axis=1)
    trace = np.einsum("nij,ij->n", rotations_of(vectors), pose.R)
    angle = np.degrees(np.arccos(np.clip((trace - 1) / 2, -1.0, 1.0)))
    near = shift < SKIPPED_FRACTION * np.linalg.norm(pose.t)
    return near & (angle < SKIPPED_DEG)


def nothing_fits(space: Space) -> VenusError:
    """The error to raise if no pose of the space was found."""
    return VenusError(
        "No pose of this board fits the limits on a target; widen them (the distances "
        f"{space.limits.nearest:g} to {space.limits.farthest:g} m, the tilt, the smallest square)."
    )

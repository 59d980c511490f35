"""How well a board's corners are found under a pose: noise and share grow worse with tilt and size.

The figures come from renders of the simulated camera (`study.noise` measures and fits them); which
pose to take all the same is left to `costs` and `search`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.pose import Array, rotations_of


@dataclass(frozen=True)
class NoiseModel:
    """Noise of a detected corner and the share of corners found, by tilt and size of a square."""

    size_px: float
    """A square this wide has twice the variance of a large one."""
    power: float
    """How fast the excess of variance falls with the width."""
    found_px: float
    """Of squares this wide half of the corners are found."""
    found_slope: float
    """How sharply the share rises about there, per pixel."""

    def sigma(self, tilt_deg: ArrayLike, side_px: ArrayLike) -> Array:
        """Standard deviation over that of a frontal board of large squares, elementwise."""
        side = np.asarray(side_px, dtype=np.float64)
        return np.sqrt(1 + (self.size_px / side) ** self.power) + 0 * np.asarray(tilt_deg)

    def found(self, tilt_deg: ArrayLike, side_px: ArrayLike) -> Array:
        """Share of the corners that is found, 0 ... 1, elementwise."""
        side = np.asarray(side_px, dtype=np.float64)
        return 1 / (1 + np.exp(-self.found_slope * (side - self.found_px))) + 0 * np.asarray(
            tilt_deg
        )

    def weight(self, camera: Camera, board: Board, vectors: ArrayLike) -> Array:
        """(N,) what the information of a view under each pose vector (N, 6) is to be multiplied by.

        The share of corners found over the square of their relative noise.
        """
        tilt, side = tilt_and_side(camera, board, vectors)
        return self.found(tilt, side) / self.sigma(tilt, side) ** 2


def tilt_and_side(camera: Camera, board: Board, vectors: ArrayLike) -> tuple[Array, Array]:
    """Tilt to the line of sight, degrees, and width of a square at the board's centre, pixels.

    Both (N,). The width is the shortest of the square's extents, so a tilted square is narrow: the
    smaller singular value of the projection's derivative at the centre, distortion left out.
    """
    p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
    R, t = rotations_of(p), p[:, 3:]
    distance = np.linalg.norm(t, axis=1)
    cosine = np.clip(np.einsum("ni,ni->n", R[:, :, 2], t) / distance, -1.0, 1.0)
    axes = R[:, :2, :2] - (t[:, :2] / t[:, 2:])[:, :, None] * R[:, 2:, :2]
    axes = axes * (np.array([camera.fx, camera.fy])[:, None] * board.square) / t[:, 2, None, None]
    squares = np.sum(axes**2, axis=(1, 2))
    area = np.abs(axes[:, 0, 0] * axes[:, 1, 1] - axes[:, 0, 1] * axes[:, 1, 0])
    small = squares / 2 - np.sqrt(np.maximum((squares / 2) ** 2 - area**2, 0.0))
    return np.degrees(np.arccos(cosine)), np.sqrt(np.maximum(small, 0.0))


RENDERED = NoiseModel(size_px=12.0, power=2.0, found_px=17.0, found_slope=0.5)
"""As measured on renders of the simulated camera with its default noise and blur."""

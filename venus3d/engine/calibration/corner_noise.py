"""How corner detection depends on the pose: worse with tilt and with small squares.

The curve is fitted to renders of the simulated camera (docs/costs.md). It does not
decide what a pose is worth: see `costs`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, rotations_of

MEASURED_PX = (15.0, 80.0)
"""Widths of a square between which the curve was measured; constant beyond."""


@dataclass(frozen=True)
class NoiseModel:
    """Noise of a detected corner and the share of corners found, by tilt and width of a square.

    With width w of a square at the board's centre, foreshortened, and tilt a:

        sigma / sigma_reference = (reference_px / w)^noise_power * cos(a)^-tilt_power
        found = 1 / (1 + (found_px cos(a)^found_tilt_power / w)^found_power)
    """

    reference_px: float
    """The width at which, frontal, the relative noise is 1."""
    noise_power: float
    tilt_power: float
    found_px: float
    """The width at which, frontal, half of the corners are found."""
    found_power: float
    found_tilt_power: float

    def sigma(self, tilt_deg: ArrayLike, width_px: ArrayLike) -> Array:
        """Standard deviation relative to that at `reference_px`, frontal; elementwise."""
        width = np.clip(np.asarray(width_px, dtype=np.float64), *MEASURED_PX)
        return (self.reference_px / width) ** self.noise_power * _cosine(
            tilt_deg
        ) ** -self.tilt_power

    def found(self, tilt_deg: ArrayLike, width_px: ArrayLike) -> Array:
        """Share of the corners found, 0 ... 1, elementwise."""
        half = self.found_px * _cosine(tilt_deg) ** self.found_tilt_power
        width = np.maximum(np.asarray(width_px, dtype=np.float64), 1e-3)
        return 1 / (1 + (half / width) ** self.found_power)

    def weight(self, camera: Camera, board: Board, vectors: ArrayLike) -> Array:
        """(N,) factors on the information of a view under each pose vector (N, 6).
        The share of corners found over the square of their relative noise."""
        tilt, width = tilt_and_width(camera, board, vectors)
        return self.found(tilt, width) / self.sigma(tilt, width) ** 2

    def relative_to(self, camera: Camera, board: Board, vectors: ArrayLike) -> NoiseModel:
        """The model rescaled so that the mean variance under these poses (N, 6) is 1.
        For noise measured on views of those poses instead of the reference."""
        variance = float(np.mean(self.sigma(*tilt_and_width(camera, board, vectors)) ** 2))
        reference = self.reference_px * variance ** (-0.5 / self.noise_power)
        return replace(self, reference_px=reference)


RENDERED = NoiseModel(
    reference_px=40.0,
    noise_power=0.86,
    tilt_power=0.49,
    found_px=23.8,
    found_power=14.9,
    found_tilt_power=0.22,
)
"""Fitted to 600 renders of the simulated camera with its default noise and blur: tilts 0 ... 65
degrees, squares 12 ... 80 px wide. Sigma at the reference is 0.032 px. Standard deviations of the
fit: 0.07, 0.16, 0.14 px, 0.7 and 0.02."""


def tilt_and_width(camera: Camera, board: Board, vectors: ArrayLike) -> tuple[Array, Array]:
    """Tilt to the line of sight, degrees, and width of a square at the board's centre, pixels.

    Both (N,). The width is the smallest over all directions, so a tilted square is narrow: the
    smaller singular value of the projection's derivative at the centre, without distortion but for
    a wide lens.
    """
    p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
    R, t = rotations_of(p), p[:, 3:]
    distance = np.linalg.norm(t, axis=1)
    cosine = np.clip(np.einsum("ni,ni->n", R[:, :, 2], t) / distance, -1.0, 1.0)
    if camera.lens.is_perspective:
        A = R[:, :2, :2] - (t[:, :2] / t[:, 2:])[:, :, None] * R[:, 2:, :2]
        A = A * (np.array([[camera.fx], [camera.fy]]) * board.square) / t[:, 2, None, None]
    else:
        by_point = camera.jacobians(np.zeros((1, 3)), R, t)[:, 3:6, :, 0]
        A = by_point.swapaxes(1, 2) @ R[:, :, :2] * board.square
    # Singular values of 2 x 2: their squares add up to |A|^2, their product is |det A|.
    half = np.sum(A * A, axis=(1, 2)) / 2
    area = A[:, 0, 0] * A[:, 1, 1] - A[:, 0, 1] * A[:, 1, 0]
    small = half - np.sqrt(np.maximum(half**2 - area**2, 0.0))
    return np.degrees(np.arccos(cosine)), np.sqrt(np.maximum(small, 0.0))


def _cosine(tilt_deg: ArrayLike) -> Array:
    # Nothing is visible at 90 degrees; keep the curve finite.
    return np.maximum(np.cos(np.radians(np.asarray(tilt_deg, dtype=np.float64))), 0.05)

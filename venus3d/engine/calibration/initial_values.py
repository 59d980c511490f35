"""Where bundle adjustment starts: homographies, a focal length from them, and a few guesses."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from venus3d.engine.calibration.bundle import Corners, Parameters
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

FIELDS_OF_VIEW_DEG = (60.0, 40.0, 90.0)
"""Horizontal fields of view that are tried beside the closed form."""
_PLAUSIBLE = (0.05, 50.0)
"""Focal lengths, in widths of the image, at which the closed form is believed."""


def initial_parameters(corners: Corners, size: tuple[int, int]) -> Iterator[Parameters]:
    """Pinholes without distortion, centred in an image of `size` (width, height), with poses: of
    the closed form, if the homographies give one, and of `FIELDS_OF_VIEW_DEG`."""
    centred = Camera.guess(size)
    scale = float(size[0])
    H = homographies(corners, scale, np.array([centred.cx, centred.cy]))
    focal = focal_of(H)
    if _PLAUSIBLE[0] < focal < _PLAUSIBLE[1]:
        yield located(H, focal, size)
    for angle in FIELDS_OF_VIEW_DEG:
        yield located(H, Camera.guess(size, angle).fx / scale, size)


def located_by(corners: Corners, camera: Camera) -> Parameters:
    """A camera with poses for its pinhole."""
    centre = np.array([camera.cx, camera.cy])
    H = homographies(corners, camera.width, centre)
    found = located(H, camera.fx / camera.width, camera.image_size)
    return replace(found, camera=camera)


def located(H: Array, focal: float, size: tuple[int, int]) -> Parameters:
    """Poses from homographies (N, 3, 3) to pixels from the centre, in widths of the image, for a
    focal length in the same unit."""
    M = H / np.array([focal, focal, 1.0])[:, None]
    M = M * np.sign(M[:, 2:, 2:])
    length = np.linalg.norm(M[:, :, :2], axis=1).mean(axis=1)
    # The nearest two orthonormal columns.
    U, _, Vt = np.linalg.svd(M[:, :, :2], full_matrices=False)
    two = U @ Vt
    R = np.concatenate([two, np.cross(two[:, :, 0], two[:, :, 1])[:, :, None]], axis=2)
    f = focal * size[0]
    camera = Camera(*size, f, f, (size[0] - 1) / 2, (size[1] - 1) / 2)
    return Parameters(camera, np.zeros(0), R, M[:, :, 2] / length[:, None])


def homographies(corners: Corners, scale: float, centre: Array) -> Array:
    """(N, 3, 3) from board points (x, y) to pixels less `centre`, over `scale`: linear (DLT)."""
    xy = corners.points[:, :, :2]
    weights = corners.weights[:, :, None]
    middle = (xy * weights).sum(1, keepdims=True) / weights.sum(1, keepdims=True)
    spread = np.sqrt((((xy - middle) ** 2) * weights).sum((1, 2)) / weights.sum((1, 2)))
    x, y = np.moveaxis((xy - middle) / spread[:, None, None], 2, 0)
    u, v = np.moveaxis((corners.pixels - centre[:, None]) / scale, 1, 0)
    one, zero = np.ones_like(x), np.zeros_like(x)
    first = np.stack([x, y, one, zero, zero, zero, -u * x, -u * y, -u], axis=2)
    second = np.stack([zero, zero, zero, x, y, one, -v * x, -v * y, -v], axis=2)
    rows = np.concatenate([first * weights, second * weights], axis=1)
    H = np.linalg.eigh(rows.swapaxes(1, 2) @ rows)[1][:, :, 0].reshape(-1, 3, 3)
    back = np.zeros_like(H)
    back[:, 0, 0] = back[:, 1, 1] = 1 / spread
    back[:, :2, 2] = -middle[:, 0] / spread[:, None]
    back[:, 2, 2] = 1.0
    return H @ back


def focal_of(H: Array) -> float:
    """One focal length for homographies (N, 3, 3) about the principal point, in their unit; NaN if
    they determine none (Zhang 2000, with square pixels and the principal point known)."""
    H = H / np.linalg.norm(H, axis=(1, 2), keepdims=True)
    one, two = H[:, :, 0], H[:, :, 1]
    across = np.concatenate(
        [
            (one[:, :2] * two[:, :2]).sum(axis=1),
            (one[:, :2] ** 2 - two[:, :2] ** 2).sum(axis=1),
        ]
    )
    along = np.concatenate([one[:, 2] * two[:, 2], one[:, 2] ** 2 - two[:, 2] ** 2])
    inverse_square = -float(across @ along) / max(float(across @ across), 1e-300)
    return inverse_square**-0.5 if inverse_square > 0 else float("nan")

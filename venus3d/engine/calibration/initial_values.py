"""Where bundle adjustment starts: homographies, a focal length from them, and a few guesses.

The image of a board in a wide lens is no homography's. With an equidistant lens as a guess, of a
few fields of view, each corner becomes a ray; turned so that their mean is the axis, the rays of a
view meet a plane in the board's homography, also beside the lens where Z is not positive.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from venus3d.engine.calibration.bundle import Corners, Parameters
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import BROWN5, EQUIDISTANT, LensModel
from venus3d.engine.geometry.pose import Array

FIELDS_OF_VIEW_DEG = (60.0, 40.0, 90.0)
"""Horizontal fields of view that are tried beside the closed form."""
WIDE_FIELDS_DEG = (100.0, 140.0, 190.0, 250.0)
"""The same for wide lenses; an image circle inside the picture leaves the width unseen."""
_NEAR_EDGES = (0.05, 0.5, 0.95)
"""Shares of the image's width and height where a principal point off the centre is looked for."""
_STEEPEST = np.radians(80.0)
"""Of a ray to the mean of its view's."""
_PLAUSIBLE = (0.05, 50.0)
"""Focal lengths, in widths of the image, at which the closed form is believed."""


def initial_parameters(
    corners: Corners, size: tuple[int, int], lens: LensModel = BROWN5
) -> Iterator[Parameters]:
    """Cameras with a lens that is centred in an image of `size` (width, height), with poses.

    Perspective lenses begin as pinholes: of the closed form, if the homographies give one, and of
    `FIELDS_OF_VIEW_DEG`. Lenses that have a form of a wide one begin with that too.
    """
    if lens.is_perspective:
        for start in _pinholes(corners, size):
            yield replace(start, camera=replace(start.camera, lens=lens, coefficients=()))
    if lens.wide is not None:
        for angle in WIDE_FIELDS_DEG:
            wide = equidistant(size, angle)
            found = _seen_wide(corners, wide)
            yield replace(found, camera=replace(wide, lens=lens, coefficients=lens.wide))


def off_centre_parameters(
    corners: Corners, size: tuple[int, int], lens: LensModel = BROWN5
) -> Iterator[Parameters]:
    """The same of a perspective lens with its principal point near an edge of the image. It may be
    there, and from the middle the lens and the poses settle to what makes up for it."""
    if not lens.is_perspective:
        return
    f = Camera.guess(size).fx
    for across, down in product(_NEAR_EDGES, repeat=2):
        if (across, down) != (0.5, 0.5):
            cx, cy = across * size[0], down * size[1]
            yield located_by(corners, Camera(*size, f, f, cx, cy, lens=lens))


def equidistant(size: tuple[int, int], field_deg: float) -> Camera:
    """A camera whose image radius is the angle, of this field across the image's width."""
    width, height = size
    f = width / np.radians(field_deg)
    return Camera(width, height, f, f, (width - 1) / 2, (height - 1) / 2, lens=EQUIDISTANT)


def on_planes(corners: Corners, camera: Camera) -> tuple[Corners, Array]:
    """The corners where their rays meet a plane before each view's mean ray, at unit distance, with
    weight 0 where they do not; and (N, 3, 3) the turns from the camera's frame to the plane's."""
    rays = camera.unproject(corners.pixels.swapaxes(1, 2))
    weights = corners.weights * np.isfinite(rays).all(axis=2)
    rays = np.nan_to_num(rays)
    mean = (rays * weights[:, :, None]).sum(axis=1)
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
    # The smallest turn from the mean to z: half a turn about each of the mean and the half way.
    half = mean + np.array([0.0, 0.0, 1.0])
    half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-12)
    turns = _half_turns(half) @ _half_turns(mean)
    turned = rays @ turns.swapaxes(1, 2)
    steep = turned[:, :, 2] > np.cos(_STEEPEST)
    plane = turned[:, :, :2] / np.where(steep, turned[:, :, 2], 1.0)[:, :, None]
    return Corners(corners.points, plane.swapaxes(1, 2), weights * steep), turns


def _half_turns(axes: Array) -> Array:
    """(N, 3, 3) rotations by 180° about unit vectors (N, 3)."""
    return np.asarray(2 * axes[:, :, None] * axes[:, None] - np.eye(3))


def _pinholes(corners: Corners, size: tuple[int, int]) -> Iterator[Parameters]:
    centred = Camera.guess(size)
    scale = float(size[0])
    H = homographies(corners, scale, np.array([centred.cx, centred.cy]))
    focal = focal_of(H)
    if _PLAUSIBLE[0] < focal < _PLAUSIBLE[1]:
        yield located(H, focal, size)
    for angle in FIELDS_OF_VIEW_DEG:
        yield located(H, Camera.guess(size, angle).fx / scale, size)


def _seen_wide(corners: Corners, camera: Camera) -> Parameters:
    planes, turns = on_planes(corners, camera)
    found = located(homographies(planes, 1.0, np.zeros(2)), 1.0, camera.image_size)
    back = turns.swapaxes(1, 2)
    t = (back @ found.t[:, :, None])[:, :, 0]
    return Parameters(camera, np.zeros(0), back @ found.R, t)


def located_by(corners: Corners, camera: Camera) -> Parameters:
    """A camera with poses: for a perspective lens those of its pinhole."""
    if not camera.lens.is_perspective:
        return _seen_wide(corners, camera)
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

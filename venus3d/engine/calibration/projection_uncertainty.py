"""Uncertainty of a camera in pixels over the image, with common rotations removed.

A change of the intrinsics moves the pixel of every ray, and so does a rotation of the camera. As
a camera's orientation is not known anyway, a move that a rotation undoes does no harm: it is
projected out of every uncertainty in pixels. `costs` turns covariances into costs.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

GRID = (12, 8)
"""Rays across and down the image over which projection errors are averaged."""
ERE_GRID = (5, 5)
"""Rays across and down of MaxERE, the outermost on the image's border (Richardson 2013)."""


@lru_cache(maxsize=16)
def projection_weight(camera: Camera) -> Array:
    """(p, p) matrix W with `trace(W cov)` = mean variance of a projected pixel, px^2.

    A change d of the intrinsics moves the pixel of ray k by `Jk d`. A common rotation w (3,) of all
    rays moves it by `Gk w`; the rotation that best undoes the move is `w = -(G^T G)^-1 G^T J d`,
    where G (2n, 3) and J (2n, p) stack all rays. The rest is `P J d` with the projector
    `P = 1 - G (G^T G)^-1 G^T`. Its mean square length over the n rays is `d^T (J^T P J / n) d`, and
    the expectation over d with covariance C is `trace(W C)`, W = J^T P J / n. Both pixel axes are
    summed: the root is the rms distance in the image.
    """
    left = _pixel_derivatives(camera, grid_pixels(camera.image_size))[1]
    left = left.reshape(-1, left.shape[2])
    return 2 * left.T @ left / len(left)


@lru_cache(maxsize=16)
def border_derivatives(camera: Camera) -> Array:
    """(n, 2, p) derivatives E_k of MaxERE's pixels by the intrinsics, best rotation removed.
    For intrinsics of covariance C the ray's pixel has the covariance `E_k C E_k^T`."""
    width, height = camera.image_size
    u, v = np.linspace(0, width - 1, ERE_GRID[0]), np.linspace(0, height - 1, ERE_GRID[1])
    pixels = np.stack([np.tile(u, len(v)), np.repeat(v, len(u))], axis=1).astype(np.float64)
    return _pixel_derivatives(camera, pixels)[1]


def projection_uncertainty_px(camera: Camera, covariance: ArrayLike) -> float:
    """Projection uncertainty: expected rms error over the image, pixels, of a covariance (p, p)."""
    mean_variance = np.sum(projection_weight(camera) * np.asarray(covariance, dtype=np.float64))
    return float(np.sqrt(max(mean_variance, 0.0)))


def uncertainty_map(camera: Camera, covariance: ArrayLike, grid: tuple[int, int] = GRID) -> Array:
    """(down, across) projection uncertainty, pixels, at the centres of a `grid` of equal cells.

    NaN where no ray reaches the pixel. The rotation removed is the best one for the pixels of
    `GRID`: there the map's mean square is that of `projection_uncertainty_px`.
    """
    at, derivatives = _map_derivatives(camera, grid)
    variance = np.einsum(
        "nij,jk,nik->n", derivatives, np.asarray(covariance, np.float64), derivatives
    )
    errors = np.full(grid[0] * grid[1], np.nan)
    errors[at] = np.sqrt(np.maximum(variance, 0.0))
    return errors.reshape(grid[1], grid[0])


@lru_cache(maxsize=4)
def _map_derivatives(camera: Camera, grid: tuple[int, int]) -> tuple[NDArray[np.intp], Array]:
    size = camera.image_size
    return _pixel_derivatives(camera, grid_pixels(size), grid_pixels(size, grid))


def projection_diff_px(true: Camera, estimate: Camera, grid: tuple[int, int] = GRID) -> float:
    """Rms distance, pixels, of two cameras' projections after the best common rotation.

    The rays are those of a `grid` (across, down) of the true camera's image.
    Raises `CalibrationError` if the cameras have different image sizes.
    """
    _, rays = _rays(true, grid_pixels(true.image_size, grid))
    moved = _projection_diff(true, estimate, rays, _common_rotation(true, estimate, rays))
    return float(np.sqrt((moved**2).sum(axis=1).mean()))


def projection_diff_map(true: Camera, estimate: Camera, grid: tuple[int, int]) -> Array:
    """(down, across) distance, pixels, of two cameras' projections at the centres of a `grid` of
    equal cells of the true camera's image; NaN where no ray reaches the pixel. The rotation removed
    is that of `projection_diff_px`. Raises `CalibrationError` likewise."""
    turn = _common_rotation(true, estimate, _rays(true, grid_pixels(true.image_size))[1])
    at, rays = _rays(true, grid_pixels(true.image_size, grid))
    found = np.full(grid[0] * grid[1], np.nan)
    found[at] = np.linalg.norm(_projection_diff(true, estimate, rays, turn), axis=1)
    return found.reshape(grid[1], grid[0])


def _common_rotation(true: Camera, estimate: Camera, rays: Array) -> Array:
    """Rotation vector (3,) of the estimate that brings its projections of rays (n, 3) nearest."""
    if true.image_size != estimate.image_size:
        raise CalibrationError("Two cameras can be compared only on images of the same size.")

    def residuals(rotvec: Array) -> Array:
        return _projection_diff(true, estimate, rays, rotvec).ravel()

    return np.asarray(least_squares(residuals, np.zeros(3), xtol=1e-12, ftol=1e-12, gtol=1e-12).x)


def _projection_diff(true: Camera, estimate: Camera, rays: Array, rotvec: Array) -> Array:
    """(n, 2) how far the rotated estimate's projections of rays (n, 3) are from the true ones."""
    turned = np.asarray(Rotation.from_rotvec(rotvec).apply(rays))
    return _unlimited_pixels(estimate, turned) - _unlimited_pixels(true, rays)


def grid_pixels(image_size: tuple[int, int], grid: tuple[int, int] = GRID) -> Array:
    """(across * down, 2) centres of equal cells of the image, pixels."""
    across, down = grid
    u = (np.arange(across) + 0.5) * image_size[0] / across - 0.5
    v = (np.arange(down) + 0.5) * image_size[1] / down - 0.5
    return np.stack([np.tile(u, down), np.repeat(v, across)], axis=1)


def _pixel_derivatives(
    camera: Camera, pixels: Array, at: Array | None = None
) -> tuple[NDArray[np.intp], Array]:
    """(n, 2, p) derivatives by the intrinsics of the pixels `at` (default: `pixels`), with the best
    rotation for `pixels` removed; and (n,) which of these a ray reaches."""
    seen, rays = _rays(camera, pixels)
    if len(rays) < len(pixels) // 2:
        # The estimate's distortion folds back within the image: planning without it is better.
        camera = replace(camera, coefficients=())
        seen, rays = _rays(camera, pixels)
    J, G = _derivatives(camera, rays)
    turn = np.linalg.solve(G.T @ G, G.T @ J)
    if at is not None:
        seen, rays = _rays(camera, at)
        J, G = _derivatives(camera, rays)
    return seen, (J - G @ turn).reshape(-1, 2, J.shape[1])


def _derivatives(camera: Camera, rays: Array) -> tuple[Array, Array]:
    """Derivatives of the pixels of rays (n, 3) by the intrinsics (2n, p) and a rotation (2n, 3)."""
    _, intrinsic, pose = camera.project_with_jacobians(rays, np.eye(3)[None], np.zeros((1, 3)))
    return intrinsic.reshape(-1, intrinsic.shape[-1]), pose.reshape(-1, 6)[:, :3]


def _rays(camera: Camera, pixels: Array) -> tuple[NDArray[np.intp], Array]:
    """(n,) which of the pixels a ray reaches, and those rays, unit vectors (n, 3)."""
    rays = camera.unproject(pixels)
    seen = np.flatnonzero(np.isfinite(rays).all(axis=1))
    return seen, rays[seen]


def _unlimited_pixels(camera: Camera, rays: Array) -> Array:
    """Like `Camera.project`, but finite beyond the angle where the model folds, too."""
    return camera.pixels_of(np.ascontiguousarray(rays.T)).T

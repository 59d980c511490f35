"""What a candidate pose is worth: one cost per name, all with the same interface.

`make_cost(...)` returns `cost(vectors (N, 6)) -> (N,)`, smaller is better. All but "rms" come from
the predicted covariance `sigma^2 (I + I_view)^-1` of the nine intrinsics (see `information`); "rms"
really calibrates, which takes milliseconds a pose instead of microseconds.

Which pose to try next is `search`'s business.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.engine.information import covariance_of, view_information
from venus3d.engine.observation import Observation
from venus3d.engine.pose import Array, rotations_of
from venus3d.engine.snapshot import COSTS, Cost

CostFunction = Callable[[Array], Array]
GRID = (12, 8)
"""Rays across and down the image over which projection errors are averaged."""


def make_cost(
    name: Cost,
    *,
    board: Board,
    camera: Camera,
    information: ArrayLike,
    sigma_px: float = 1.0,
    observations: Sequence[Observation] = (),
    rng: np.random.Generator | None = None,
) -> CostFunction:
    """The cost of that name.

    Args:
        information: (9, 9) what the views so far say, for corner noise of one pixel.
        sigma_px: standard deviation of a corner coordinate, pixels.
        observations, rng: the views so far and a source of noise; only "rms" needs them.

    Raises `VenusError` for an unknown name and for "rms" without observations.
    """
    if name == "rms":
        return _rms_cost(board, camera, sigma_px, observations, rng)
    if name not in COSTS:
        raise VenusError(f"There is no cost {name!r}; use one of {', '.join(COSTS)}.")
    known = np.asarray(information, dtype=np.float64)
    variance = sigma_px**2
    if name == "projection-variance":
        weight = projection_weight(camera)

        def projection(vectors: Array) -> Array:
            covariance = variance * predicted_covariance(board, camera, known, vectors)
            return np.einsum("ij,nji->n", weight, covariance)

        return projection
    over = dispersion_scale(camera)
    total = np.sum if name == "sum-iod" else np.max

    def dispersion(vectors: Array) -> Array:
        covariance = variance * predicted_covariance(board, camera, known, vectors)
        return np.asarray(total(np.einsum("nii->ni", covariance) / over, axis=1))

    return dispersion


def predicted_covariance(
    board: Board, camera: Camera, information: ArrayLike, vectors: ArrayLike
) -> Array:
    """Covariance (N, 9, 9) of the intrinsics after one more view, for each pose vector (N, 6).

    For corner noise of one pixel; the whole board is seen.
    """
    p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
    view = view_information(camera, board.corners, rotations_of(p), p[:, 3:])
    return covariance_of(np.asarray(information, dtype=np.float64) + view)


def dispersion_scale(camera: Camera) -> Array:
    """(9,) what eq. (13) divides a variance by: |value|, and 1 where the value is exactly 0."""
    values = np.abs(camera.parameters)
    return np.where(values == 0, 1.0, values)


def index_of_dispersion(camera: Camera, covariance: ArrayLike) -> Array:
    """Eq. (13), (9,): variance over |value| of each parameter."""
    return np.diag(np.asarray(covariance, dtype=np.float64)) / dispersion_scale(camera)


@lru_cache(maxsize=16)
def projection_weight(camera: Camera) -> Array:
    """(9, 9) matrix W with `trace(W cov)` = mean variance of a projected pixel, px^2.

    A change d of the intrinsics moves the pixel of ray k by `Jk d`. A common turn w (3,) of all
    rays moves it by `Gk w`; since the camera's own orientation is never given, the turn that best
    undoes the move costs nothing: `w = -(G^T G)^-1 G^T J d`, where G (2n, 3) and J (2n, 9) stack
    all rays. What is left is `P J d` with the projector `P = 1 - G (G^T G)^-1 G^T`. Its mean square
    length over the n rays is `d^T (J^T P J / n) d`, and the expectation of that over d with
    covariance C is `trace(W C)`, W = J^T P J / n. Both pixel axes are summed: the root is the rms
    distance in the image.
    """
    rays = _rays(camera)
    if len(rays) < GRID[0] * GRID[1] // 2:
        # The estimate's distortion folds back within the image: better to plan without it.
        camera = camera.without_distortion()
        rays = _rays(camera)
    _, intrinsic, pose = camera.project_with_jacobians(rays, np.eye(3)[None], np.zeros((1, 3)))
    J, G = intrinsic.reshape(-1, 9), pose.reshape(-1, 6)[:, :3]
    left = J - G @ np.linalg.solve(G.T @ G, G.T @ J)
    return left.T @ left / len(rays)


def projection_error_px(camera: Camera, covariance: ArrayLike) -> float:
    """Expected rms projection error over the image, pixels, of a covariance (9, 9)."""
    mean_variance = np.sum(projection_weight(camera) * np.asarray(covariance, dtype=np.float64))
    return float(np.sqrt(max(mean_variance, 0.0)))


def mean_projection_error_px(true: Camera, estimate: Camera, grid: tuple[int, int] = GRID) -> float:
    """Rms distance, pixels, of two cameras' projections after the best common rotation.

    The rays are those of a `grid` (across, down) of the true camera's image.
    Raises `CalibrationError` if the cameras have different image sizes.
    """
    if true.image_size != estimate.image_size:
        raise CalibrationError("Two cameras can be compared only on images of the same size.")
    rays = _rays(true, grid)
    pixels = _unlimited_pixels(true, rays)

    def residuals(rotvec: Array) -> Array:
        turned = np.asarray(Rotation.from_rotvec(rotvec).apply(rays))
        return (_unlimited_pixels(estimate, turned) - pixels).ravel()

    best = least_squares(residuals, np.zeros(3), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    return float(np.sqrt(2 * best.cost / len(rays)))


def grid_pixels(image_size: tuple[int, int], grid: tuple[int, int] = GRID) -> Array:
    """(across * down, 2) centres of equal cells of the image, pixels."""
    across, down = grid
    u = (np.arange(across) + 0.5) * image_size[0] / across - 0.5
    v = (np.arange(down) + 0.5) * image_size[1] / down - 0.5
    return np.stack([np.tile(u, down), np.repeat(v, across)], axis=1)


def _rays(camera: Camera, grid: tuple[int, int] = GRID) -> Array:
    xy = camera.unproject(grid_pixels(camera.image_size, grid))
    xy = xy[np.isfinite(xy).all(axis=1)]
    return np.concatenate([xy, np.ones((len(xy), 1))], axis=1)


def _unlimited_pixels(camera: Camera, rays: Array) -> Array:
    """Like `Camera.project`, but beyond the radius where the model folds too: finite errors."""
    return camera.distort(rays[:, :2] / rays[:, 2:]) * [camera.fx, camera.fy] + [
        camera.cx,
        camera.cy,
    ]


def _rms_cost(
    board: Board,
    camera: Camera,
    sigma_px: float,
    observations: Sequence[Observation],
    rng: np.random.Generator | None,
) -> CostFunction:
    """RmsErr: the rms over all views of a real calibration that includes the candidate."""
    from venus3d.engine.calibration import calibrate

    if not observations:
        raise VenusError("The cost rms calibrates really and needs the views captured so far.")
    # One draw of noise for all candidates, or the search would hunt for lucky noise.
    noise = (rng or np.random.default_rng(0)).normal(0, sigma_px, (board.corner_count, 2))
    ids = np.arange(board.corner_count)

    def rms(vectors: Array) -> Array:
        p = np.atleast_2d(vectors)
        pixels = camera.project_board(board.corners, rotations_of(p), p[:, 3:]) + noise
        costs = np.full(len(p), np.inf)
        for i, corners in enumerate(pixels):
            view = Observation(ids, corners, camera.image_size)
            try:
                costs[i] = calibrate(board, [*observations, view], start=camera).rms_px
            except CalibrationError:
                continue
        return costs

    return rms

"""Fisher information of a view on the intrinsic parameters, before it is taken.

With unit noise, a view's corners have Jacobians Ji by the intrinsics and Je by the view's pose. The
pose is a nuisance parameter, eliminated by the Schur complement:

    I_view = Ji^T Ji - Ji^T Je (Je^T Je)^-1 Je^T Ji        (p, p)

Views are independent, so their informations add, and `sigma^2 (sum I)^-1` is the covariance of the
intrinsics (Triggs et al. 2000, "Bundle Adjustment", section 6; its diagonal is the square of
OpenCV's `stdDeviationsIntrinsics`). A hypothetical view is one p x p addition.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose

DEGREE = 3
"""Highest degree of the polynomials over the board in `shared_modes`."""


def view_information(
    camera: Camera,
    points: ArrayLike,
    R: ArrayLike,
    t: ArrayLike,
    *,
    shared: Array | None = None,
) -> Array:
    """Information (N, p, p) of views of board points (M, 3) under poses (N, 3, 3), (N, 3).
    For corner noise of one pixel per axis. All points must be in front of the lens. `shared`: see
    `normal_matrices`."""
    gram = normal_matrices(camera, points, R, t, shared=shared)
    # The pose columns differ in scale by orders of magnitude; unit diagonals keep the solve exact.
    scale = 1.0 / np.sqrt(np.einsum("nii->ni", gram[:, :6, :6]))
    pose_gram = gram[:, :6, :6] * scale[:, :, None] * scale[:, None, :]
    cross = gram[:, :6, 6:] * scale[:, :, None]
    marginal = gram[:, 6:, 6:] - np.swapaxes(cross, 1, 2) @ np.linalg.solve(pose_gram, cross)
    return 0.5 * (marginal + np.swapaxes(marginal, 1, 2))


def information_of(
    camera: Camera, board: Board, seen: Observation, pose: Pose, shared_ratio: float = 0.0
) -> Array:
    """Information (p, p) of one observation under its pose; `shared_ratio`: see `shared_share`."""
    points = board.points_of(seen.ids)
    shared = shared_share(board, points, shared_ratio)
    return view_information(camera, points, pose.R[None], pose.t[None], shared=shared)[0]


def shared_modes(board: Board, points: Array) -> Array:
    """(M, 10) T: polynomials up to the third degree at board points (M, 3), unit rms over all."""
    half = np.abs(board.corners[:, :2]).max()
    powers = [(i, d - i) for d in range(DEGREE + 1) for i in range(d + 1)]

    def at(p: Array) -> Array:
        x, y = (p[:, :2] / half).T
        return np.stack([x**i * y**j for i, j in powers], axis=1)

    return at(points) / np.sqrt((at(board.corners) ** 2).mean(axis=0))


def shared_share(
    board: Board, points: Array, ratio: float, weights: Array | None = None
) -> Array | None:
    """(M, k) C with (I + ratio^2 T T^T)^-1 = I - C C^T, T the modes at the board's points (M, 3).
    With weights (M,), T's rows are multiplied by their roots. None without a shared part."""
    if ratio <= 0:
        return None
    modes = shared_modes(board, points)
    if weights is not None:
        modes = modes * np.sqrt(weights)[:, None]
    k = modes.shape[1]
    root = np.linalg.cholesky(np.eye(k) / ratio**2 + modes.T @ modes)
    return np.asarray(np.linalg.solve(root, modes.T).T, dtype=np.float64)


def normal_matrices(
    camera: Camera,
    points: ArrayLike,
    R: ArrayLike,
    t: ArrayLike,
    weights: ArrayLike | None = None,
    shared: Array | None = None,
) -> Array:
    """J^T J (N, 6 + p, 6 + p) of views, the six of the pose first; arguments as `view_information`.

    Args:
        weights: (M,) of the points.
        shared: (M, k) C of `shared_share`; the result is then J^T (I - C C^T) J, with
            J's rows multiplied by the roots of the weights.
    """
    J = camera.jacobians(points, R, t)
    if weights is not None:
        J *= np.sqrt(np.asarray(weights, dtype=np.float64))
    rows = J.reshape(*J.shape[:2], -1)
    normal = rows @ np.swapaxes(rows, 1, 2)
    if shared is not None:
        # One large product: many small ones take twice the time.
        taken = (J.reshape(-1, J.shape[3]) @ shared).reshape(*J.shape[:2], -1)
        normal -= taken @ np.swapaxes(taken, 1, 2)
    return normal


def covariance_of(information: ArrayLike, sigma_px: float = 1.0) -> Array:
    """Covariance (..., p, p) of an information (..., p, p), for corner noise `sigma_px`.
    Raises numpy's `LinAlgError` if the information is singular."""
    matrix = np.asarray(information, dtype=np.float64)
    # Informations of f and k3 differ by 1e9 and more; invert the matrix with a unit diagonal.
    scale = 1.0 / np.sqrt(np.einsum("...ii->...i", matrix))
    outer = scale[..., :, None] * scale[..., None, :]
    return sigma_px**2 * np.linalg.inv(matrix * outer) * outer


def prior_information(camera: Camera, sigma_px: float = 1.0) -> Array:
    """(p, p) a wide prior for any camera, far weaker than one good view.

    Lets the search rank second views while one alone leaves parameters undetermined. Never part of
    a reported covariance. In the units of `view_information`.
    """
    f, w = (camera.fx + camera.fy) / 2, camera.width
    believed = np.array([0.3 * f, 0.3 * f, 0.1 * w, 0.1 * w, *camera.lens.usual])
    return np.diag(sigma_px**2 / believed**2)

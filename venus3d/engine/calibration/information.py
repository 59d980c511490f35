"""Fisher information of a view on the nine intrinsic parameters, before it is taken.

With unit noise, a view's corners have Jacobians Ji by the intrinsics and Je by the view's pose. The
pose is a nuisance parameter, eliminated by the Schur complement:

    I_view = Ji^T Ji - Ji^T Je (Je^T Je)^-1 Je^T Ji        (9, 9)

Views are independent, so their informations add, and `sigma^2 (sum I)^-1` is the covariance of the
intrinsics (Triggs et al. 2000, "Bundle Adjustment", section 6; its diagonal is the square of
OpenCV's `stdDeviationsIntrinsics`). A hypothetical view is one 9 x 9 addition.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose


def view_information(camera: Camera, points: ArrayLike, R: ArrayLike, t: ArrayLike) -> Array:
    """Information (N, 9, 9) of views of board points (M, 3) under poses (N, 3, 3), (N, 3).
    For corner noise of one pixel per axis. All points must be in front of the lens."""
    gram = normal_matrices(camera, points, R, t)
    # The pose columns differ in scale by orders of magnitude; unit diagonals keep the solve exact.
    scale = 1.0 / np.sqrt(np.einsum("nii->ni", gram[:, :6, :6]))
    pose_gram = gram[:, :6, :6] * scale[:, :, None] * scale[:, None, :]
    cross = gram[:, :6, 6:] * scale[:, :, None]
    marginal = gram[:, 6:, 6:] - np.swapaxes(cross, 1, 2) @ np.linalg.solve(pose_gram, cross)
    return 0.5 * (marginal + np.swapaxes(marginal, 1, 2))


def information_of(camera: Camera, board: Board, seen: Observation, pose: Pose) -> Array:
    """Information (9, 9) of one observation under its pose."""
    return view_information(camera, board.points_of(seen.ids), pose.R[None], pose.t[None])[0]


def normal_matrices(
    camera: Camera,
    points: ArrayLike,
    R: ArrayLike,
    t: ArrayLike,
    weights: ArrayLike | None = None,
) -> Array:
    """J^T J (N, 15, 15) of views, the six of the pose first; arguments as `view_information`.
    With weights (M,) for the points."""
    J = camera.jacobians(points, R, t)
    if weights is not None:
        J *= np.sqrt(np.asarray(weights, dtype=np.float64))
    J = J.reshape(*J.shape[:2], -1)
    return J @ np.swapaxes(J, 1, 2)


def covariance_of(information: ArrayLike, sigma_px: float = 1.0) -> Array:
    """Covariance (..., 9, 9) of an information (..., 9, 9), for corner noise `sigma_px`.
    Raises numpy's `LinAlgError` if the information is singular."""
    matrix = np.asarray(information, dtype=np.float64)
    # Informations of f and k3 differ by 1e9 and more; invert the matrix with a unit diagonal.
    scale = 1.0 / np.sqrt(np.einsum("...ii->...i", matrix))
    outer = scale[..., :, None] * scale[..., None, :]
    return sigma_px**2 * np.linalg.inv(matrix * outer) * outer


def prior_information(camera: Camera, sigma_px: float = 1.0) -> Array:
    """(9, 9) a wide prior for any webcam, far weaker than one good view.

    Lets the search rank second views while one alone leaves parameters undetermined. Never part of
    a reported covariance. In the units of `view_information`.
    """
    f, w = (camera.fx + camera.fy) / 2, camera.width
    believed = np.array([0.3 * f, 0.3 * f, 0.1 * w, 0.1 * w, 0.5, 1.0, 0.02, 0.02, 2.0])
    return np.diag(sigma_px**2 / believed**2)

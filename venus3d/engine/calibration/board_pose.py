"""The board's pose from one observation by a calibrated camera (PnP)."""

from __future__ import annotations

import cv2
import numpy as np

from venus3d.engine.calibration.bundle import Corners, Parameters, Problem, adjust
from venus3d.engine.calibration.initial_values import on_planes
from venus3d.engine.calibration.observation import (
    Observation,
    reprojection_errors,
    rms_distance,
)
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose

_FEWEST_CORNERS = 6
# A larger reprojection error, as a share of the image width, is not a pose of this board.
_LARGEST_ERROR = 0.02
_ITERATIONS = 8


def estimate_pose(
    camera: Camera, board: Board, observation: Observation, previous: Pose | None = None
) -> Pose | None:
    """`T_camera_board` of an observation, or None if its corners do not determine a pose.

    A plane far away fits two tilts almost equally well (Schweighofer and Pinz 2006): the better one
    is taken or, if they hardly differ, the one nearer to `previous`.
    """
    if observation.count < _FEWEST_CORNERS:
        return None
    points = board.points_of(observation.ids)
    spread = np.linalg.svd(points[:, :2] - points[:, :2].mean(axis=0), compute_uv=False)
    if spread[1] < board.square / 2:
        return None  # all corners on one line
    try:
        if camera.lens.is_perspective:
            poses = _perspective_poses(camera, board, observation, points)
        else:
            poses = _wide_poses(camera, board, observation, points)
    except (cv2.error, CalibrationError):
        return None
    poses = [(pose, error) for pose, error in poses if np.isfinite(error)]
    if not poses:
        return None
    best = min(error for _, error in poses)
    if best > _LARGEST_ERROR * camera.width:
        return None
    rivals = [pose for pose, error in poses if error < 1.2 * best + 1e-9]
    if previous is None or len(rivals) == 1:
        return min(poses, key=lambda item: item[1])[0]
    return min(rivals, key=previous.angle_to_deg)


def _perspective_poses(
    camera: Camera, board: Board, observation: Observation, points: Array
) -> list[tuple[Pose, float]]:
    """The two poses of a plane, with their errors in pixels."""
    rays = camera.unproject(observation.corners)
    seen = np.isfinite(rays).all(axis=1)
    if seen.sum() < _FEWEST_CORNERS:
        return []
    found = _poses_of_plane(points[seen], rays[seen, :2] / rays[seen, 2:])
    refined = [_refined(camera, board, observation, pose) for pose in found]
    return [(pose, error) for pose, error in refined if pose.t[2] > 0]


def _wide_poses(
    camera: Camera, board: Board, observation: Observation, points: Array
) -> list[tuple[Pose, float]]:
    """The same by a lens that may see beside and behind itself."""
    corners = Corners.of([points], [observation.corners])
    planes, turns = on_planes(corners, camera)
    seen = planes.weights[0] > 0
    if seen.sum() < _FEWEST_CORNERS:
        return []
    problem = Problem(corners, np.zeros((len(camera.parameters), 0)))
    back = Pose(turns[0].T, np.zeros(3))
    found: list[tuple[Pose, float]] = []
    for plane_pose in _poses_of_plane(points[seen], planes.pixels[0].T[seen]):
        start = back @ plane_pose
        at = Parameters(camera, np.zeros(0), start.R[None], start.t[None])
        pose = adjust(problem, at, _ITERATIONS).parameters.poses[0]
        found.append((pose, rms_distance(reprojection_errors(camera, board, observation, pose))))
    return found


def _poses_of_plane(points: Array, image: Array) -> list[Pose]:
    """Of points (n, 3) on the board from where they are on the plane z = 1 (n, 2)."""
    flat = points * [1.0, 1.0, 0.0]
    _, rvecs, tvecs, _ = cv2.solvePnPGeneric(
        flat, np.ascontiguousarray(image), np.eye(3), np.zeros(5), flags=cv2.SOLVEPNP_IPPE
    )
    # Of points without any noise OpenCV's second pose may be no number.
    found = [(r, t) for r, t in zip(rvecs, tvecs, strict=True) if np.isfinite([r, t]).all()]
    return [Pose.from_rvec_tvec(r, t) for r, t in found]


def _refined(
    camera: Camera, board: Board, observation: Observation, start: Pose
) -> tuple[Pose, float]:
    rvec, tvec = cv2.solvePnPRefineLM(
        board.points_of(observation.ids),
        observation.corners,
        camera.K,
        camera.distortion,
        start.rvec.reshape(3, 1).copy(),
        start.t.reshape(3, 1).copy(),
    )
    pose = Pose.from_rvec_tvec(rvec, tvec)
    return pose, rms_distance(reprojection_errors(camera, board, observation, pose))

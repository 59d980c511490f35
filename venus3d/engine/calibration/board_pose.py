"""The board's pose from one observation by a calibrated camera (PnP)."""

from __future__ import annotations

import cv2
import numpy as np

from venus3d.engine.calibration.observation import (
    Observation,
    reprojection_errors,
    rms_distance,
)
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

_FEWEST_CORNERS = 6
# A larger reprojection error, as a share of the image width, is not a pose of this board.
_LARGEST_ERROR = 0.02


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
    rays = camera.unproject(observation.corners)
    seen = np.isfinite(rays).all(axis=1)
    if seen.sum() < _FEWEST_CORNERS:
        return None
    try:
        flat = points[seen] * [1.0, 1.0, 0.0]
        plane = np.ascontiguousarray(rays[seen, :2] / rays[seen, 2:])
        _, rvecs, tvecs, _ = cv2.solvePnPGeneric(
            flat, plane, np.eye(3), np.zeros(5), flags=cv2.SOLVEPNP_IPPE
        )
        candidates = [Pose.from_rvec_tvec(r, t) for r, t in zip(rvecs, tvecs, strict=True)]
        refined = [_refined(camera, board, observation, pose) for pose in candidates]
    except cv2.error:
        return None
    poses = [(pose, error) for pose, error in refined if pose.t[2] > 0 and np.isfinite(error)]
    if not poses:
        return None
    best = min(error for _, error in poses)
    if best > _LARGEST_ERROR * camera.width:
        return None
    rivals = [pose for pose, error in poses if error < 1.2 * best + 1e-9]
    if previous is None or len(rivals) == 1:
        return min(poses, key=lambda item: item[1])[0]
    return min(rivals, key=previous.angle_to_deg)


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

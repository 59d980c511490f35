"""A snapshot of a board whose pose another program has found, for display."""

from __future__ import annotations

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import corners_outside
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.matching import match
from venus3d.engine.guidance.prompts import GIVEN_REASON, ONLY_SHOWN, headline_and_prompt
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.target import Target, unpredicted_target


def pose_snapshot(
    board: Board,
    camera: Camera,
    pose: Pose | None,
    target: Pose | Target | None = None,
    before: Snapshot | None = None,
) -> Snapshot:
    """The board at a pose, and the remaining steps to a target.

    Args:
        pose: `T_camera_board`; None while the board is not seen.
        target: the pose to reach, if any.
        before: the previous snapshot: needed for hysteresis, and for the board's motion, without
            which no target is reached.
    """
    seen = Observation.nothing(camera.image_size)
    if pose is not None:
        ids = np.setdiff1d(np.arange(board.corner_count), corners_outside(pose, camera, board))
        corners = camera.project(pose.apply(board.points_of(ids)))
        seen = Observation(ids, corners, camera.image_size, board=board)
    aim = _target_at(target, camera, board, before)
    same = before is not None and before.target is aim
    compared = None
    if pose is not None and aim is not None:
        compared = match(
            camera,
            board,
            pose,
            aim.pose,
            observation=seen,
            before=None if before is None else before.observation,
            previous=before.match if before is not None and same else None,
        )
    headline, instruction = headline_and_prompt("guiding", compared, pose is not None)
    if pose is not None and aim is None:
        headline, instruction = ONLY_SHOWN
    return Snapshot(
        number=1 if before is None else before.number + 1,
        phase="guiding",
        board=board,
        camera=camera,
        observation=seen,
        pose=pose,
        target=aim,
        match=compared,
        calibration=None,
        convergence=None,
        history=(),
        headline=headline,
        instruction=instruction,
    )


def _target_at(
    target: Pose | Target | None, camera: Camera, board: Board, before: Snapshot | None
) -> Target | None:
    """The target; the previous snapshot's, if it has the same pose."""
    if target is None or isinstance(target, Target):
        return target
    if before is None or before.target is None:
        return unpredicted_target(1, target, camera, board, reason=GIVEN_REASON)
    old, unchanged = before.target, (before.camera, before.board) == (camera, board)
    if unchanged and np.array_equal(old.pose.matrix, target.matrix):
        return old
    return unpredicted_target(old.number + 1, target, camera, board, reason=GIVEN_REASON)

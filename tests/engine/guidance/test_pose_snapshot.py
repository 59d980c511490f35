"""Another program's pose as a snapshot: the steps that are left, and when the target is reached."""

from __future__ import annotations

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import pose_snapshot

TARGET = Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])


def test_the_steps_that_are_left(paper_camera: Camera, default_board: Board) -> None:
    pose = Pose.from_vector([25, -30, 0, 0.04, -0.02, 0.52])
    snapshot = pose_snapshot(default_board, paper_camera, pose, TARGET)
    assert snapshot.match is not None and snapshot.target is not None
    assert snapshot.target.pose is TARGET
    np.testing.assert_allclose(snapshot.match.remaining_deg, [0, 0, 20], atol=1e-9)
    assert snapshot.headline == "Step 4 of 4"
    assert snapshot.instruction.camera == "Rotate the board clockwise by 20°."
    assert snapshot.observation.count == default_board.corner_count


def test_a_target_is_reached_when_the_board_is_still(
    paper_camera: Camera, default_board: Board
) -> None:
    first = pose_snapshot(default_board, paper_camera, TARGET, TARGET)
    assert first.match is not None and not first.match.reached  # it may be passing by
    second = pose_snapshot(default_board, paper_camera, TARGET, TARGET, first)
    assert second.match is not None and second.match.reached
    assert (second.number, second.headline) == (2, "Hold still")


def test_a_target_stays_the_same_while_its_pose_does(
    paper_camera: Camera, default_board: Board
) -> None:
    first = pose_snapshot(default_board, paper_camera, Pose.identity().moved([0, 0, 1]), TARGET)
    again = Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])
    second = pose_snapshot(default_board, paper_camera, TARGET, again, first)
    assert first.target is not None and second.target is first.target
    other = pose_snapshot(default_board, paper_camera, TARGET, TARGET.moved([0, 0, 0.1]), second)
    assert other.target is not None and other.target.number == 2
    given = pose_snapshot(default_board, paper_camera, TARGET, first.target, other)
    assert given.target is first.target


def test_without_a_board_or_a_target(paper_camera: Camera, default_board: Board) -> None:
    unseen = pose_snapshot(default_board, paper_camera, None, TARGET)
    assert (unseen.headline, unseen.observation.count) == ("Board not seen", 0)
    aimless = pose_snapshot(default_board, paper_camera, TARGET)
    assert aimless.match is None and aimless.target is None
    assert aimless.instruction.holder == "The board as it is held now."
    partly = pose_snapshot(default_board, paper_camera, TARGET.moved([0.2, 0, 0]))
    assert 0 < partly.observation.count < default_board.corner_count

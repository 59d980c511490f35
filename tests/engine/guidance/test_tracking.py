"""Boards that look the same after a turn, read as what was seen before or nearest to the target."""

from __future__ import annotations

import numpy as np
import pytest

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.other_readings import renumbered, turned_pose
from venus3d.engine.geometry.board import Board, Kind
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.tracking import PoseTracker
from venus3d.engine.planning.target import unpredicted_target

CIRCLES = Board(kind="circles", columns=7, rows=5, square=0.02, marker=0.01)


def seen(camera: Camera, board: Board, pose: Pose) -> Observation:
    """All of the board under this pose, with a little noise."""
    ids = np.arange(board.corner_count, dtype=np.intp)
    noise = np.random.default_rng(0).normal(0, 0.02, (len(ids), 2))
    corners = camera.project(pose.apply(board.corners)) + noise
    return Observation(ids, corners, camera.image_size)


@pytest.mark.parametrize(
    ("kind", "columns", "rows", "expected"),
    [
        ("charuco", 8, 8, ()),
        ("aprilgrid", 6, 6, ()),
        ("circles", 7, 5, (2,)),
        ("circles", 5, 5, (1, 2, 3)),
        ("asymmetric-circles", 4, 6, (2,)),
        ("asymmetric-circles", 4, 5, ()),
        ("chessboard", 9, 6, ()),
        ("chessboard", 8, 6, (2,)),
        ("chessboard", 7, 7, (1, 2, 3)),
        ("chessboard", 8, 8, (2,)),
    ],
)
def test_boards_that_look_the_same_after_a_turn(
    paper_camera: Camera, kind: Kind, columns: int, rows: int, expected: tuple[int, ...]
) -> None:
    board = Board(kind=kind, columns=columns, rows=rows, dictionary="DICT_5X5_100")
    if kind == "asymmetric-circles" or kind == "circles":
        board = Board(kind=kind, columns=columns, rows=rows, square=0.02, marker=0.01)
    assert board.of_kind.quarter_turns(board) == expected
    # By its picture, which is what a camera sees.
    picture = board.texture(20)
    for quarters in (1, 2, 3):
        turned = np.rot90(picture, quarters)
        alike = turned.shape == picture.shape and np.mean(abs(turned / 1.0 - picture)) < 8
        assert alike == (quarters in expected), quarters
    pose = Pose.from_vector([10, 20, 30, 0.01, 0, 0.6])
    for quarters in expected:
        other = renumbered(board, seen(paper_camera, board, pose), quarters)
        where = turned_pose(pose, quarters).apply(board.points_of(other.ids))
        np.testing.assert_allclose(paper_camera.project(where), other.corners, atol=0.1)


def tracked(camera: Camera, poses: list[Pose | None], target: Pose) -> PoseTracker:
    """A tracker of `CIRCLES` that was shown these poses, with a reading each; None: nothing."""
    tracker = PoseTracker(CIRCLES, camera.image_size, Settings())
    aim = unpredicted_target(
        1, target, camera, CIRCLES, reason="", method="global", cost="projection-variance"
    )
    for pose in poses:
        nothing = Observation.nothing(camera.image_size)
        tracker.observe(nothing if pose is None else seen(camera, CIRCLES, pose), camera, aim)
    return tracker


def test_what_comes_into_view_is_read_nearest_to_its_target(paper_camera: Camera) -> None:
    """A simulated hand turned such a board half round and half back, out of sight, without end."""
    target = Pose.from_vector([20, 0, -70, 0, 0, 0.5])
    before, upside_down = Pose.from_vector([20, 0, 71, 0, 0, 0.5]), turned_pose(target, 2)
    tracker = tracked(paper_camera, [before, None, upside_down, upside_down], target)
    assert tracker.pose is not None and tracker.pose.angle_to_deg(target) < 1
    assert tracker.match is not None and tracker.match.reached
    assert tracker.observation.ids.tolist() == sorted(tracker.observation.ids.tolist())


def test_what_stays_in_view_is_not_turned_round(paper_camera: Camera) -> None:
    target = Pose.from_vector([20, 0, 40, 0, 0, 0.5])
    turns = [Pose.from_vector([20, 0, 40 + angle, 0, 0, 0.5]) for angle in (60, 85, 110, 130)]
    tracker = tracked(paper_camera, [*turns], target)
    assert tracker.pose is not None and tracker.pose.angle_to_deg(turns[-1]) < 1
    # The detector has lost it and begins anew with the other reading.
    tracker = tracked(paper_camera, [*turns, turned_pose(turns[-1], 2)], target)
    assert tracker.pose is not None and tracker.pose.angle_to_deg(turns[-1]) < 1
    # At its target it is whatever the reading is.
    tracker = tracked(paper_camera, [*turns, turned_pose(target, 2)], target)
    assert tracker.pose is not None and tracker.pose.angle_to_deg(target) < 1

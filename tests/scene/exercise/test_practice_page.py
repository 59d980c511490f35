"""Dragging the board, and pictures in turns."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.scene.pages.exercise.board_drag import dragged_pose
from venus3d.scene.pages.exercise.practice_page import fitting
from venus3d.scene.web.tabs import PictureTurns


def test_the_grabbed_point_stays_under_the_pointer_in_the_projection(paper_camera: Camera) -> None:
    """Checked with OpenCV's projection: the pointer goes 60 px right and 25 px down."""
    pose = Pose.from_vector([20, -30, 10, 0.05, 0.02, 0.6])
    on_board = np.array([0.07, -0.04, 0.0])
    grabbed = pose.apply(on_board)
    shift = np.array([60 / paper_camera.fx, 25 / paper_camera.fy, 0]) * grabbed[2]
    after = dragged_pose(pose, "move", shift, (0, 0))
    before_px, after_px = (
        cv2.projectPoints(on_board[None], p.rvec, p.t, paper_camera.K, None)[0].ravel()
        for p in (pose, after)
    )
    assert after_px - before_px == pytest.approx([60, 25], abs=1e-6)
    assert np.allclose(after.R, pose.R)


def test_gestures_turn_and_push_as_they_say() -> None:
    pose = Pose.from_vector([0, 0, 0, 0.1, 0, 0.5])
    top, right = np.array([0, -0.1, 0]), np.array([0.1, 0, 0])
    down = dragged_pose(pose, "tilt", (0, 0, 0), (0, 0.1))
    assert down.apply(top)[2] < pose.apply(top)[2], "dragged down: the top edge comes nearer"
    aside = dragged_pose(pose, "tilt", (0, 0, 0), (0.1, 0))
    assert aside.apply(right)[2] > pose.apply(right)[2], "to the right: the right edge goes away"
    turned = dragged_pose(pose, "rotate", (0, 0, 0), (0.1, 0))
    assert turned.apply(right)[1] > pose.apply(right)[1], "clockwise"
    assert dragged_pose(pose, "depth", (0, 0, 0), (0, -0.2)).t[2] > 0.5


def test_pictures_come_in_turns_and_the_newest_wins() -> None:
    drawn: list[str] = []
    turns = PictureTurns()
    asked = (("a2", 1), ("b1", 2), ("a3", 1), ("c1", 3), ("b2", 2))
    for name, who in asked:
        turns.ask(who, "seen", lambda name=name: drawn.append(name))
    turns.ask(3, "target", lambda: drawn.append("c target"))
    turns.forget(3)
    order: list[int] = []
    while (turn := turns.take()) is not None:
        order.append(turn[0])
        turn[1]()
    assert (drawn, order) == (["a3", "b2"], [1, 2])


def test_a_class_shares_the_pictures_evenly() -> None:
    """All of five move all the time, and there is time for three pictures a round."""
    turns, had = PictureTurns(), dict.fromkeys(range(5), 0)
    for _ in range(50):
        for who in had:
            turns.ask(who, "seen", lambda: None)
        for _ in range(3):
            turn = turns.take()
            assert turn is not None
            had[turn[0]] += 1
    assert set(had.values()) == {30}


def test_pictures_fit() -> None:
    assert fitting((1280, 720), (480, 270)) == (480, 270)
    assert fitting((640, 480), (480, 270)) == (360, 270)

"""Dragging the board, and pictures in turns."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.scene.pages.exercise.board_drag import Pointer, dragged_pose
from venus3d.scene.pages.exercise.practice_page import fitting
from venus3d.scene.web.tabs import PictureTurns

EYE = np.zeros(3)


def on_view(point: Array, pixels: tuple[float, float], camera: Camera) -> Pointer:
    """The pointer seen from the camera, after it has gone from this point by so many pixels."""
    shift = np.array([pixels[0] / camera.fx, pixels[1] / camera.fy, 0]) * point[2]
    across = (pixels[0] / camera.width, pixels[1] / camera.height)
    return Pointer(EYE, point, point + shift, across)


def pixels_of(point: Array, pose: Pose, camera: Camera) -> Array:
    """Where OpenCV sees a point of the board, without distortion."""
    seen = cv2.projectPoints(point[None], pose.rvec, pose.t, camera.K, None)[0]
    return np.asarray(seen, dtype=np.float64).ravel()


def test_the_grabbed_point_stays_under_the_pointer_in_the_projection(paper_camera: Camera) -> None:
    """Checked with OpenCV's projection: the pointer goes 60 px right and 25 px down."""
    pose = Pose.from_vector([20, -30, 10, 0.05, 0.02, 0.6])
    on_board = np.array([0.07, -0.04, 0.0])
    pointer = on_view(pose.apply(on_board), (60, 25), paper_camera)
    after = dragged_pose(pose, "move", pointer)
    before_px, after_px = (pixels_of(on_board, p, paper_camera) for p in (pose, after))
    assert after_px - before_px == pytest.approx([60, 25], abs=1e-6)
    assert np.allclose(after.R, pose.R)


@pytest.mark.parametrize("turn_deg", [35.0, -80.0, 150.0])
def test_a_rotated_board_follows_the_pointer_round_its_centre(
    paper_camera: Camera, turn_deg: float
) -> None:
    """An upright board is grabbed at a corner; the pointer goes round the centre's pixel."""
    pose = Pose.from_vector([0, 0, 20, 0.08, -0.03, 0.5])
    corner = np.array([0.1, 0.06, 0.0])
    centre = pixels_of(np.zeros(3), pose, paper_camera)
    before = pixels_of(corner, pose, paper_camera) - centre
    turn = np.radians(turn_deg)
    turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    focal = np.array([paper_camera.fx, paper_camera.fy])
    way = focal * (turned @ (before / focal)) - before
    pointer = on_view(pose.apply(corner), (way[0], way[1]), paper_camera)
    after = dragged_pose(pose, "rotate", pointer)
    assert pixels_of(corner, after, paper_camera) == pytest.approx(centre + before + way, abs=0.01)
    assert np.allclose(after.t, pose.t)


def test_it_follows_the_pointer_from_any_side() -> None:
    """Seen from aside and behind: the pointer's ray goes through the grabbed point's new place."""
    pose = Pose.from_vector([0, 0, 0, 0.05, 0.0, 0.6])
    corner = np.array([0.1, 0.06, 0.0])
    for eye in (np.array([-0.6, -0.5, -0.4]), np.array([0.5, -0.3, 1.6])):
        start = pose.apply(corner)
        goal = pose.turned("z", 40).apply(corner)
        forward = (pose.t - eye) / np.linalg.norm(pose.t - eye)
        end = eye + (goal - eye) * (forward @ (start - eye)) / (forward @ (goal - eye))
        after = dragged_pose(pose, "rotate", Pointer(eye, start, end, (0.2, 0.1)))
        assert after.angle_to_deg(pose.turned("z", 40)) < 1e-6


def test_gestures_turn_and_push_as_they_say() -> None:
    pose = Pose.from_vector([0, 0, 0, 0.1, 0, 0.5])
    top, right = np.array([0, -0.1, 0]), np.array([0.1, 0, 0])

    def after(gesture: Any, across: tuple[float, float]) -> Pose:
        return dragged_pose(pose, gesture, Pointer(EYE, pose.t, pose.t, across))

    assert after("tilt", (0, 0.1)).apply(top)[2] < pose.apply(top)[2], "down: the top edge nearer"
    aside = after("tilt", (0.1, 0))
    assert aside.apply(right)[2] > pose.apply(right)[2], "to the right: the right edge goes away"
    assert after("depth", (0, -0.2)).t[2] > 0.5
    # From its edge, the plane of the turn has no point under the pointer.
    edge_on = Pointer(np.array([1.0, 0, 0.5]), pose.t, pose.t, (0.1, 0))
    turned = dragged_pose(pose, "rotate", edge_on)
    assert turned.apply(right)[1] > pose.apply(right)[1], "to the right: clockwise"


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

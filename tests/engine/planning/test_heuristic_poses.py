"""Poses made by rule: the printed angles, the distortion map, the windows, the repairs."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.planning.heuristic_poses import (
    HeuristicState,
    Window,
    bisection_angle_deg,
    distortion_map,
    distortion_window,
    paper_angle_deg,
    paper_pose,
    rojtberg_pose,
    weakest_parameter,
    window_pose,
)
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, brought_within
from venus3d.sources.sim_cameras import SIM_CAMERAS


def test_eq_11_as_printed_and_where_it_degenerates() -> None:
    angles = [paper_angle_deg(i) for i in range(1, 40)]
    assert angles[:6] == [-70, 70, 0, 35, 17.5, 26.25]
    for i in range(2, 39):
        assert angles[i] == (angles[i - 1] + angles[i - 2]) / 2
    assert angles[-1] == pytest.approx(70 / 3)


def test_the_bisection_goes_breadth_first() -> None:
    angles = [bisection_angle_deg(i) for i in range(1, 15)]
    assert angles[:6] == [-35, 35, -52.5, -17.5, 17.5, 52.5]
    assert len(set(angles)) == 14 and 0 not in angles
    # Each level halves the largest gap of the level before.
    assert np.allclose(np.diff(np.sort([bisection_angle_deg(i) for i in range(7, 15)])), 17.5)


def test_eq_10_turns_about_the_axis_of_the_parameter(
    paper_camera: Camera, default_board: Board
) -> None:
    """With limits wide enough the printed pose comes out to the letter."""
    wide = Limits(max_tilt_deg=80, max_depth_ratio=9, min_square_px=1, nearest=0.05)
    state = HeuristicState()
    for expected in (-70, 70, 0, 35):
        made = paper_pose(Space(default_board, paper_camera, wide), "fx", state)
        np.testing.assert_allclose(made.vector[:5], [0, expected, 22.5, 0, 0], atol=1e-12)
        assert made.note == "" and wide.accepts(paper_camera, default_board, made.vector)[0]
        nearer = made.vector * [1, 1, 1, 1, 1, 0.96]
        assert not wide.accepts(paper_camera, default_board, nearer)[0], "as near as it goes"
        state = made.state
    # u0 shares alpha's sequence; beta has its own.
    assert paper_pose(Space(default_board, paper_camera, wide), "cx", state).vector[1] == 17.5
    assert paper_pose(Space(default_board, paper_camera, wide), "fy", state).vector[0] == -70


def test_a_pose_beyond_the_limits_is_brought_back_and_it_is_said(
    paper_camera: Camera, default_board: Board
) -> None:
    limits = Limits()
    made = paper_pose(Space(default_board, paper_camera, limits), "fy", HeuristicState())
    assert limits.accepts(paper_camera, default_board, made.vector)[0]
    assert -55.01 < made.vector[0] < -50 and made.vector[2] == 22.5
    assert "tilted by 70°" in made.note and "beyond 55°" in made.note
    assert "turned about X by −5" in made.note and "instead of −70°" in made.note


def test_bringing_back_changes_nothing_that_is_fine_and_little_else(
    paper_camera: Camera, default_board: Board
) -> None:
    limits = Limits()
    fine = np.array([20.0, 10, 5, 0, 0, 0.5])
    same, note = brought_within(default_board, paper_camera, limits, fine)
    np.testing.assert_array_equal(same, fine)
    assert note == ""
    close = np.array([20.0, 10, 5, 0, 0, 0.22])  # reaches out of the picture
    back, note = brought_within(default_board, paper_camera, limits, close)
    assert limits.accepts(paper_camera, default_board, back)[0] and "held at" in note
    assert back[5] < 0.36
    hopeless = Limits(min_square_px=500)
    kept, note = brought_within(default_board, paper_camera, hopeless, fine)
    np.testing.assert_array_equal(kept, fine)
    assert "square" in note


def test_the_distortion_map_by_opencv(paper_camera: Camera) -> None:
    cells = distortion_map(paper_camera)
    assert cells.shape == (36, 64)
    column, row = 60, 3
    pixel = np.array([(column + 0.5) * 20 - 0.5, (row + 0.5) * 20 - 0.5])
    ideal = (pixel - paper_camera.K[:2, 2]) / paper_camera.K[[0, 1], [0, 1]]
    moved, _ = cv2.projectPoints(
        np.array([[*ideal, 1.0]]), np.zeros(3), np.zeros(3), paper_camera.K, paper_camera.distortion
    )
    assert cells[row, column] == pytest.approx(np.linalg.norm(moved.ravel() - pixel), rel=1e-9)


def test_the_window_is_the_strongest_by_exhaustion_and_each_is_new(
    paper_camera: Camera, default_board: Board
) -> None:
    first, again = distortion_window(default_board, paper_camera)
    assert not again and first.width >= 0.29 * 1280
    assert first.width / first.height == pytest.approx(1.5, rel=0.05)
    cells = distortion_map(paper_camera)
    across, down = round(first.width / 20), round(first.height / 20)
    sums = {
        (x, y): cells[y : y + down, x : x + across].sum()
        for x in range(64 - across + 1)
        for y in range(36 - down + 1)
    }
    assert max(sums, key=sums.__getitem__) == (round(first.x / 20), round(first.y / 20))

    used: tuple[Window, ...] = ()
    for _ in range(30):
        window, again = distortion_window(default_board, paper_camera, used)
        if again:
            break
        assert window not in used
        used = (*used, window)
    assert again and len(used) >= 6, "everything is shown once, then it begins anew"


def test_without_known_distortion_the_border_comes_first(default_board: Board) -> None:
    window, _ = distortion_window(default_board, Camera.guess((1280, 720)))
    assert window.x in (0.0, pytest.approx(1280 - window.width))
    assert window.y in (0.0, pytest.approx(720 - window.height))


def test_the_board_fills_its_window_parallel_to_the_image(
    paper_camera: Camera, default_board: Board
) -> None:
    window = Window(500, 200, 384, 256)
    pose = window_pose(default_board, paper_camera, window)
    np.testing.assert_array_equal(pose.R, np.eye(3))
    pixels, _ = cv2.projectPoints(
        default_board.outline, pose.rvec, pose.t, paper_camera.K, np.zeros(5)
    )
    low, high = pixels.reshape(-1, 2).min(0), pixels.reshape(-1, 2).max(0)
    np.testing.assert_allclose((low + high) / 2, [691.5, 327.5], atol=0.5)
    np.testing.assert_allclose(high - low, [384, 256], rtol=0.01)


def test_rojtbergs_poses(paper_camera: Camera, default_board: Board) -> None:
    limits = Limits()
    first = rojtberg_pose(Space(default_board, paper_camera, limits), "fy", HeuristicState())
    np.testing.assert_array_equal(first.vector[:5], 0)
    assert first.vector[5] < 0.3, "frontal and filling the image"
    signs: list[float] = []
    state = first.state
    for _ in range(4):
        made = rojtberg_pose(Space(default_board, paper_camera, limits), "cy", state)
        assert made.vector[1] == 0 and made.vector[2] == 22.5
        assert abs(made.vector[0]) > 10
        signs.append(float(np.sign(made.vector[4])))
        state = made.state
    assert signs == [1, -1, 1, -1]
    window = rojtberg_pose(Space(default_board, paper_camera, limits), "k1", state)
    np.testing.assert_array_equal(window.vector[:3], 0)
    assert len(window.state.windows) == 1 and window.state.count("cy") == 4


def test_the_weakest_parameter_is_the_largest_variance_over_value(paper_camera: Camera) -> None:
    sigma = np.array([5, 5, 4, 4, 0.01, 0.05, 1e-4, 1e-4, 0.2])
    covariance = np.diag(sigma**2)
    assert weakest_parameter(paper_camera, covariance) == "k3"
    assert weakest_parameter(paper_camera, covariance, ["k3"]) == "cy"  # 16 / 355
    assert weakest_parameter(paper_camera, covariance, ["k3", "cy"]) == "k1"  # 1e-4 / 0.0031


def test_a_parameter_that_its_view_did_not_help_is_passed_over() -> None:
    state = HeuristicState().observed(np.ones(9)).after("k3")
    assert state.observed(np.ones(9)).settled == (), "a skipped target says nothing"
    assert state.observed(np.full(9, 0.8)).settled == ()
    assert state.observed(np.full(9, 1.1)).settled == (), "a sigma that grew has not settled"
    assert state.observed(np.full(9, 0.95)).settled == ("k3",)


def test_windows_of_a_fisheye_are_filled_from_the_side(default_board: Board) -> None:
    """By OpenCV's fisheye model. At the picture's edge no board parallel to it is seen."""
    camera = SIM_CAMERAS["fisheye"]
    bent = distortion_map(camera)
    u, v = 40 * 1280 / 64 + 10 - 0.5, 8 * 720 / 36 + 10 - 0.5
    at = np.array([u - camera.cx, v - camera.cy]) / [camera.fx, camera.fy]
    angle = np.linalg.norm(at)
    ray = np.array([*(np.sin(angle) * at / angle), np.cos(angle)]).reshape(1, 1, 3)
    zero = np.zeros(3)
    seen, _ = cv2.fisheye.projectPoints(ray, zero, zero, camera.K, camera.distortion)
    assert bent[8, 40] == pytest.approx(np.linalg.norm(seen.ravel() - [u, v]), rel=1e-6)
    for x in (20.0, 450.0, 860.0):
        window = Window(x, 240.0, 384.0, 256.0)
        pose = window_pose(default_board, camera, window)
        edges = [[-default_board.width / 2, 0, 0], [default_board.width / 2, 0, 0]]
        left, right = camera.project(pose.apply(np.array(edges)))
        assert left[0] == pytest.approx(x - 0.5, abs=40) and right[0] - left[0] == pytest.approx(
            384, rel=0.12
        )
        assert pose.R[:, 2] @ pose.t == pytest.approx(np.linalg.norm(pose.t))

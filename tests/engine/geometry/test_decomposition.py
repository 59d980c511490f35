"""The four steps (eq. 15), their words checked on where the board's edges really go."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import corners_outside, decompose, home_pose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import step_prompt

CAMERA = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
BOARD = Board()
ANGLE = st.floats(-70, 70)
VECTOR = st.tuples(
    ANGLE, ANGLE, ANGLE, st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(0.3, 1)
)


@given(VECTOR)
def test_equation_15_letter_by_letter(p: tuple[float, ...]) -> None:
    xr, yr, zr, xt, yt, zt = p
    steps = decompose(Pose.from_vector(p), CAMERA, BOARD)
    printed = (
        [0, 0, 0, xt, yt, zt],
        [xr, 0, 0, xt, yt, zt],
        [xr, yr, 0, xt, yt, zt],
        [xr, yr, zr, xt, yt, zt],
    )
    for step, vector in zip(steps, printed, strict=True):
        np.testing.assert_allclose(step.after.matrix, Pose.from_vector(vector).matrix, atol=1e-9)
    np.testing.assert_allclose([s.angle_deg for s in steps], [0, xr, yr, zr], atol=1e-6)
    np.testing.assert_allclose(steps[0].translation, [xt, yt, zt - 0.5], atol=1e-12)
    assert [s.number for s in steps] == [1, 2, 3, 4]
    assert [(s.kind, s.axis) for s in steps] == [
        ("move", None),
        ("turn", "x"),
        ("turn", "y"),
        ("turn", "z"),
    ]


@given(VECTOR, VECTOR)
def test_from_any_pose_each_step_moves_one_degree_of_freedom(
    p: tuple[float, ...], q: tuple[float, ...]
) -> None:
    start, target = Pose.from_vector(p), Pose.from_vector(q)
    steps = decompose(target, CAMERA, BOARD, start)
    assert steps[0].before is start
    assert steps[3].after is target
    np.testing.assert_allclose(steps[0].after.R, start.R)
    np.testing.assert_allclose(steps[0].after.t, target.t, atol=1e-12)
    product = start.R
    for before, step in itertools.pairwise(steps):
        assert step.before is before.after
        np.testing.assert_allclose(step.after.t, target.t, atol=1e-12)
        axis = np.eye(3)["xyz".index(step.axis or "")]
        product = Rotation.from_rotvec(np.radians(step.angle_deg) * axis).as_matrix() @ product
        # In gimbal lock the vector keeps half of the digits only.
        np.testing.assert_allclose(step.after.R, product, atol=1e-6)
    np.testing.assert_allclose(product, target.R, atol=1e-6)


def test_home_is_the_frontal_upright_board() -> None:
    np.testing.assert_array_equal(home_pose(0.7).vector(), [0, 0, 0, 0, 0, 0.7])
    steps = decompose(home_pose(), CAMERA, BOARD)
    assert all(step.is_idle and step.is_visible for step in steps)


EDGES = {
    "top": np.array([0, -BOARD.height / 2, 0]),
    "bottom": np.array([0, BOARD.height / 2, 0]),
    "left": np.array([-BOARD.width / 2, 0, 0]),
    "right": np.array([BOARD.width / 2, 0, 0]),
}


@pytest.mark.parametrize("angle", [-30.0, 30.0])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_the_edge_that_is_named_comes_closer(axis: str, angle: float) -> None:
    p = [0.0, 0, 0, 0, 0, 0.5]
    p["xy".index(axis)] = angle
    target = Pose.from_vector(p)
    step = decompose(target, CAMERA, BOARD)["xy".index(axis) + 1]
    named = next(edge for edge in EDGES if f"the {edge} edge" in step_prompt(step).camera)
    assert target.apply(EDGES[named])[2] < home_pose().apply(EDGES[named])[2]
    assert "30°" in step_prompt(step).camera and "30°" in step_prompt(step).holder
    if axis == "x":
        assert step_prompt(step).holder == step_prompt(step).camera, (
            "up and down are the same for both"
        )
    else:
        other = {"left": "right", "right": "left"}[named]
        assert f"on your {other}" in step_prompt(step).holder


@pytest.mark.parametrize("angle", [-20.0, 20.0])
def test_clockwise_is_clockwise_in_the_picture(angle: float) -> None:
    target = Pose.from_vector([0, 0, angle, 0, 0, 0.5])
    words = step_prompt(decompose(target, CAMERA, BOARD)[3])
    top = CAMERA.project(target.apply(EDGES["top"])) - CAMERA.project(target.t)
    # The picture's y points down: the top edge goes to the right when it turns clockwise.
    is_clockwise = top[0] > 0
    assert ("counter-clockwise" not in words.camera) == is_clockwise
    assert ("counter-clockwise" in words.holder) == is_clockwise


@pytest.mark.parametrize(
    ("move", "camera", "holder"),
    [
        ([0.1, 0, 0], "to the right", "to your left"),
        ([-0.1, 0, 0], "to the left", "to your right"),
        ([0, 0.1, 0], "down", "down"),
        ([0, -0.1, 0], "up", "up"),
        ([0, 0, 0.1], "away from the camera", "away from the camera"),
        ([0, 0, -0.1], "towards the camera", "towards the camera"),
    ],
)
def test_words_for_a_move_name_where_the_picture_of_the_board_goes(
    move: list[float], camera: str, holder: str
) -> None:
    step = decompose(home_pose().moved(move), CAMERA, BOARD)[0]
    assert step_prompt(step).camera == f"Move the board 100 mm {camera}."
    assert step_prompt(step).holder == f"Move the board 100 mm {holder}."
    before, after = CAMERA.project(step.before.t), CAMERA.project(step.after.t)
    wanted = {"right": (0, 1), "left": (0, -1), "down": (1, 1), "up": (1, -1)}
    for word, (coordinate, sign) in wanted.items():
        if word in camera:
            assert sign * (after - before)[coordinate] > 0


@given(VECTOR)
@settings(max_examples=50)
def test_visibility_names_the_corners_that_leave_the_picture(p: tuple[float, ...]) -> None:
    for step in decompose(Pose.from_vector(p), CAMERA, BOARD):
        outside = {
            corner_id
            for corner_id in range(BOARD.corner_count)
            if not _is_seen(step.after, corner_id)
        }
        assert set(step.corners_outside) == outside
        assert step.is_visible == (not outside)


def test_a_board_behind_the_camera_is_not_seen() -> None:
    assert len(corners_outside(home_pose(-0.5), CAMERA, BOARD)) == 40


def _is_seen(pose: Pose, corner_id: int) -> bool:
    u, v = CAMERA.project(pose.apply(BOARD.points_of([corner_id])))[0]
    return bool(-0.5 <= u < 1279.5 and -0.5 <= v < 719.5)

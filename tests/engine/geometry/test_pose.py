"""Poses against scipy and viser.transforms, on purpose also near 90 degrees about Y."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from viser import transforms as viser_tf

from venus3d.engine.errors import PoseError
from venus3d.engine.geometry.pose import Pose, interpolate, rotations_of, turn

ANGLE = st.floats(-180, 180)
NEAR_LOCK = st.one_of(
    st.floats(-89.9, 89.9),
    st.sampled_from([90.0, -90.0]),
    st.builds(lambda s, e: s * (90 - e), st.sampled_from([-1, 1]), st.floats(1e-6, 0.05)),
)
LENGTH = st.floats(-2, 2)
VECTOR = st.tuples(ANGLE, NEAR_LOCK, ANGLE, LENGTH, LENGTH, LENGTH)


@given(VECTOR)
def test_vector_becomes_the_turns_about_fixed_axes_x_first(p: tuple[float, ...]) -> None:
    x, y, z = (viser_tf.SO3.exp(np.radians(a) * e) for a, e in zip(p[:3], np.eye(3), strict=True))
    pose = Pose.from_vector(p)
    np.testing.assert_allclose(pose.R, (z @ y @ x).as_matrix(), atol=1e-12)
    np.testing.assert_array_equal(pose.t, p[3:])
    np.testing.assert_allclose(rotations_of([p])[0], pose.R, atol=1e-15)


@given(VECTOR)
def test_own_axes_are_the_same_turns_in_the_other_order(p: tuple[float, ...]) -> None:
    x, y, z = (viser_tf.SO3.exp(np.radians(a) * e) for a, e in zip(p[:3], np.eye(3), strict=True))
    np.testing.assert_allclose(
        Pose.from_vector(p, axes="own").R, (x @ y @ z).as_matrix(), atol=1e-12
    )


@given(VECTOR, st.sampled_from(["fixed", "own"]))
def test_vector_describes_the_pose_even_in_gimbal_lock(p: tuple[float, ...], axes: str) -> None:
    pose = Pose.from_vector(p, axes=axes)  # type: ignore[arg-type]
    again = Pose.from_vector(pose.vector(axes), axes=axes)  # type: ignore[arg-type]
    # Within 1e-7 rad (6e-6 degrees) scipy takes it for locked, and two turns are off by that.
    assert pose.angle_to_deg(again) < 1.3e-5
    np.testing.assert_allclose(again.t, pose.t)


@given(st.tuples(st.floats(-179, 179), st.floats(-89, 89), st.floats(-179, 179)))
def test_vector_comes_back_away_from_the_lock(angles: tuple[float, float, float]) -> None:
    pose = Pose.from_vector([*angles, 0.1, 0.2, 0.3])
    np.testing.assert_allclose(pose.vector()[:3], angles, atol=1e-7)
    assert not pose.is_gimbal_locked
    assert pose.angle_y_deg == pytest.approx(angles[1], abs=1e-7)


@pytest.mark.parametrize("y", [90.0, -90.0])
def test_gimbal_lock_is_said(y: float) -> None:
    pose = Pose.from_vector([20, y, 30, 0, 0, 1])
    assert pose.is_gimbal_locked
    assert pose.vector()[2] == 0


@given(VECTOR, VECTOR, st.tuples(LENGTH, LENGTH, LENGTH))
def test_composition_and_inverse_are_those_of_se3(
    p: tuple[float, ...], q: tuple[float, ...], point: tuple[float, ...]
) -> None:
    a, b = Pose.from_vector(p), Pose.from_vector(q)
    A, B = viser_tf.SE3.from_matrix(a.matrix), viser_tf.SE3.from_matrix(b.matrix)
    np.testing.assert_allclose((a @ b).matrix, (A @ B).as_matrix(), atol=1e-12)
    np.testing.assert_allclose(a.inverse().matrix, A.inverse().as_matrix(), atol=1e-12)
    np.testing.assert_allclose(a.apply(point), A @ np.array(point), atol=1e-12)
    np.testing.assert_allclose((a.inverse() @ a).matrix, np.eye(4), atol=1e-12)


@given(VECTOR)
def test_every_representation_comes_back(p: tuple[float, ...]) -> None:
    pose = Pose.from_vector(p)
    for again in (
        Pose.from_rvec_tvec(pose.rvec, pose.t),
        Pose.from_wxyz(pose.wxyz, pose.t),
        Pose.from_matrix(pose.matrix),
    ):
        np.testing.assert_allclose(again.matrix, pose.matrix, atol=1e-9)
    np.testing.assert_allclose(cv2.Rodrigues(pose.rvec)[0], pose.R, atol=1e-7)
    np.testing.assert_allclose(viser_tf.SO3(wxyz=pose.wxyz).as_matrix(), pose.R, atol=1e-12)
    assert pose.wxyz[0] >= 0


@given(VECTOR, st.sampled_from("xyz"), ANGLE)
def test_a_turn_is_about_the_cameras_axis_through_the_boards_centre(
    p: tuple[float, ...], axis: str, angle: float
) -> None:
    pose = Pose.from_vector(p)
    turned = pose.turned(axis, angle)  # type: ignore[arg-type]
    expected = Rotation.from_rotvec(np.radians(angle) * np.eye(3)["xyz".index(axis)]).as_matrix()
    np.testing.assert_allclose(turned.R, expected @ pose.R, atol=1e-12)
    np.testing.assert_array_equal(turned.t, pose.t)


@given(VECTOR, VECTOR, st.floats(0, 1))
@settings(max_examples=50)
def test_interpolation_goes_the_shortest_way_at_constant_speed(
    p: tuple[float, ...], q: tuple[float, ...], fraction: float
) -> None:
    a, b = Pose.from_vector(p), Pose.from_vector(q)
    whole = a.angle_to_deg(b)
    if whole > 179.9:
        return  # two shortest ways
    between = interpolate(a, b, fraction)
    assert a.angle_to_deg(between) == pytest.approx(fraction * whole, abs=1e-5)
    assert between.angle_to_deg(b) == pytest.approx((1 - fraction) * whole, abs=1e-5)
    np.testing.assert_allclose(between.t, (1 - fraction) * a.t + fraction * b.t, atol=1e-12)


def test_signs_are_right_handed() -> None:
    np.testing.assert_allclose(turn("x", 90) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(turn("y", 90) @ [0, 0, 1], [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(turn("z", 90) @ [1, 0, 0], [0, 1, 0], atol=1e-15)


@pytest.mark.parametrize("p", [[1, 2, 3], [0, 0, 0, 0, 0, float("nan")], [[0] * 6]])
def test_numbers_that_are_no_pose(p: list[float]) -> None:
    with pytest.raises(PoseError, match="six finite numbers"):
        Pose.from_vector(p)


def test_matrices_that_are_no_pose() -> None:
    with pytest.raises(PoseError, match="4 x 4"):
        Pose.from_matrix(np.eye(3))
    with pytest.raises(PoseError, match="mirrors"):
        Pose.from_matrix(np.diag([1, 1, -1, 1]))

"""The same rotation in other notations, by scipy, viser's transforms, OpenCV, and by running the
lines of Python that are given for them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
import viser.transforms as vtf
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.notations import (
    FRAMES,
    ROTATION_NOTATIONS,
    AxesName,
    pose_in,
    pose_notation,
    rotation_notations,
)
from venus3d.engine.geometry.pose import Array, Pose

LOCKED = 2e-7
"""Radians: nearer to gimbal lock than 1e-7, scipy's Euler angles are those of the lock itself."""


def rotations() -> list[Array]:
    """200 rotations: any, hardly any, nearly half turns, and in or near gimbal lock."""
    rng = np.random.default_rng(0)
    axes = rng.normal(size=(110, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    angles = [*rng.uniform(0, np.pi, 50), *10.0 ** rng.uniform(-9, -3, 29), 0.0]
    angles += [*(np.pi - 10.0 ** rng.uniform(-9, -3, 29)), np.pi]
    about = Rotation.from_rotvec(axes * np.array(angles)[:, None])
    swing = 90 - 10.0 ** rng.uniform(-10, 0, 88)
    y = np.concatenate([swing, [90.0, -90.0]]) * rng.choice([-1, 1], 90)
    x, z = rng.uniform(-180, 180, (2, 90))
    locked = Rotation.from_euler("xyz", np.stack([x, y, z], 1), degrees=True)
    return [*np.asarray(about.as_matrix()), *np.asarray(locked.as_matrix())]


def run(line: str) -> Array:
    names: dict[str, Array] = {}
    assert "\n" not in line
    exec(line, names)  # what somebody does who pastes it
    return names["T" if "T = " in line else "R"]


def angle_between(one: Array, other: Array) -> float:
    return float(Rotation.from_matrix(one @ other.T).magnitude())


def test_each_line_of_python_makes_the_same_rotation() -> None:
    made = rotations()
    assert len(made) == 200
    for R in made:
        written = rotation_notations(R)
        assert tuple(written) == ROTATION_NOTATIONS
        for name, notation in written.items():
            bar = LOCKED if name.startswith("euler") else 1e-11
            assert angle_between(run(notation.python), R) < bar, name


def test_the_numbers_are_those_of_scipy_and_viser() -> None:
    for R in rotations():
        written = {name: notation.values for name, notation in rotation_notations(R).items()}
        np.testing.assert_array_equal(written["matrix"], R)
        w = written["quaternion-wxyz"]
        assert w[0] >= 0 and np.linalg.norm(w) == pytest.approx(1)
        np.testing.assert_array_equal(written["quaternion-xyzw"], [*w[1:], w[0]])
        np.testing.assert_allclose(vtf.SO3(w).as_matrix(), R, atol=1e-12)
        rvec = written["rotation-vector"]
        assert np.linalg.norm(rvec) <= np.pi + 1e-12
        np.testing.assert_allclose(cv2.Rodrigues(rvec)[0], R, atol=1e-9)
        np.testing.assert_allclose(vtf.SO3.exp(rvec).as_matrix(), R, atol=1e-9)
        for name, order in (("euler-fixed", "xyz"), ("euler-own", "XYZ")):
            again = Rotation.from_euler(order, written[name], degrees=True).as_matrix()
            assert angle_between(np.asarray(again), R) < LOCKED
        roll, pitch, yaw = np.radians(written["euler-fixed"])
        rpy = vtf.SO3.from_rpy_radians(roll, pitch, yaw).as_matrix()
        assert angle_between(rpy, R) < LOCKED


@pytest.mark.parametrize("frame", FRAMES)
def test_a_pose_in_other_axes_is_the_same_pose(frame: AxesName, rng: np.random.Generator) -> None:
    """The axes are written down here again, in words' order: what is right, down and ahead."""
    right, down, ahead = {
        "opencv": ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
        "opengl": ([1, 0, 0], [0, -1, 0], [0, 0, -1]),
        "ros-optical": ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
        "ros-body": ([0, -1, 0], [0, 0, -1], [1, 0, 0]),
    }[frame]
    rename = np.stack([right, down, ahead], 1).astype(float)
    assert np.linalg.det(rename) == pytest.approx(1), "no mirror"
    for R in rotations():
        pose = Pose(R, rng.normal(size=3))
        other = pose_in(frame, pose)
        point = rng.normal(size=3)
        np.testing.assert_allclose(other.apply(rename @ point), rename @ pose.apply(point))
        angle = Rotation.from_matrix(R).magnitude()
        assert Rotation.from_matrix(other.R).magnitude() == pytest.approx(angle, abs=1e-7)
        T = pose_notation(frame, pose)
        np.testing.assert_allclose(
            T.values, vtf.SE3.from_matrix(other.matrix).as_matrix(), atol=1e-12
        )
        np.testing.assert_allclose(run(T.python), T.values, atol=1e-12)


def test_a_turn_keeps_its_axis_under_its_new_name() -> None:
    """To the right edge's side: +20 degrees about OpenCV's y, which points down."""
    swing = Pose(np.eye(3), np.zeros(3)).turned("y", 20)
    np.testing.assert_allclose(pose_in("opengl", swing).vector()[:3], [0, -20, 0], atol=1e-9)
    np.testing.assert_allclose(pose_in("ros-body", swing).vector()[:3], [0, 0, -20], atol=1e-9)
    np.testing.assert_allclose(pose_in("ros-optical", swing).vector()[:3], [0, 20, 0], atol=1e-9)
    ahead = Pose(np.eye(3), np.array([0.1, 0.2, 0.5]))
    np.testing.assert_allclose(pose_in("ros-body", ahead).t, [0.5, -0.1, -0.2])
    np.testing.assert_allclose(pose_in("opengl", ahead).t, [0.1, -0.2, -0.5])

"""Turns about fixed and own axes in any order, against scipy; steps in gimbal lock."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.errors import PoseError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose, decompose_vector, home_pose
from venus3d.engine.geometry.pose import Axes, Pose
from venus3d.engine.geometry.rotation_orders import ORDERS, is_near_gimbal_lock, turns


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("axes", ["fixed", "own"])
def test_the_result_is_scipys(order: str, axes: Axes, rng: np.random.Generator) -> None:
    """scipy: small letters are fixed axes, capitals the body's own."""
    for _ in range(20):
        angles = rng.uniform(-180, 180, 3)
        name = order if axes == "fixed" else order.upper()
        picked = angles[["xyz".index(letter) for letter in order]]
        wanted = Rotation.from_euler(name, picked, degrees=True).as_matrix()
        made = turns(home_pose(), angles, order=order, axes=axes)
        np.testing.assert_allclose(made[2].after.R, wanted, atol=1e-12)
        tilted = Pose.from_vector([20, -30, 40, 0.1, 0, 0.6])
        moved = turns(tilted, angles, order=order, axes=axes)
        np.testing.assert_allclose(moved[2].after.R, wanted @ tilted.R, atol=1e-12)
        np.testing.assert_array_equal(moved[2].after.t, tilted.t)


def test_own_axes_are_the_turned_boards_and_the_way_is_one_turn(rng: np.random.Generator) -> None:
    for turn in turns(home_pose(), rng.uniform(-90, 90, 3), axes="own"):
        np.testing.assert_allclose(turn.direction, turn.before.R[:, "xyz".index(turn.axis)])
        half = turn.pose_at(0.5)
        assert half.angle_to_deg(turn.before) == pytest.approx(abs(turn.angle_deg) / 2)
        assert half.angle_to_deg(turn.after) == pytest.approx(abs(turn.angle_deg) / 2)


def test_an_order_that_is_none_is_told() -> None:
    with pytest.raises(PoseError, match="xyz, xzy"):
        turns(home_pose(), [1, 2, 3], order="xxy")


def test_steps_keep_their_numbers_in_gimbal_lock(
    paper_camera: Camera, default_board: Board
) -> None:
    """`decompose` gives X all of the turn there; on sliders that would look like a mistake."""
    locked = [30.0, 90.0, 20.0, 0.02, 0.0, 0.5]
    steps = decompose_vector(locked, paper_camera, default_board)
    assert [step.angle_deg for step in steps] == [0.0, 30.0, 90.0, 20.0]
    wanted = Rotation.from_euler("xyz", locked[:3], degrees=True).as_matrix()
    np.testing.assert_allclose(steps[3].before.turned("z", 20).R, wanted, atol=1e-12)
    same = Pose.from_vector([10.0, 90.0, 0.0, 0.02, 0.0, 0.5])
    assert steps[3].after.angle_to_deg(same) < 1e-6, "X and Z turn alike"
    free = [30.0, 60.0, 20.0, 0.02, 0.0, 0.5]
    for one, other in zip(
        decompose_vector(free, paper_camera, default_board),
        decompose(Pose.from_vector(free), paper_camera, default_board),
        strict=True,
    ):
        assert one.angle_deg == pytest.approx(other.angle_deg)
        np.testing.assert_allclose(one.after.R, other.after.R, atol=1e-12)
    assert is_near_gimbal_lock(88) and is_near_gimbal_lock(-90) and not is_near_gimbal_lock(70)

"""Poses brought onto the limits; the limits themselves are tested against OpenCV elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose, angles_of, rotations_of
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, onto_limits, random_pose


def test_what_is_brought_inside_is_inside_and_near_where_it_was(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    space = Space(default_board, paper_camera, limits)
    valid = np.array([random_pose(space, rng) for _ in range(200)])
    unit = space.to_unit(valid) + 0.1 * rng.standard_normal(valid.shape)
    wanted = space.from_unit(unit)
    before = limits.accepts(paper_camera, default_board, wanted)
    moved, good = onto_limits(limits, paper_camera, default_board, wanted)
    np.testing.assert_array_equal(good, limits.accepts(paper_camera, default_board, moved))
    np.testing.assert_array_equal(moved[before], wanted[before])
    assert before.mean() < 0.55 and good.mean() > 0.75
    more = onto_limits(limits, paper_camera, default_board, wanted, steps=6)[1]
    assert more.mean() > 0.97
    assert np.median(np.abs(space.to_unit(moved[good & ~before]) - unit[good & ~before])) < 0.03


def test_a_pose_outside_comes_to_lie_on_the_limit_it_broke(
    paper_camera: Camera, default_board: Board
) -> None:
    limits = Limits()
    for vector, figure, limit in (
        ([65.0, 0, 0, 0, 0, 0.5], lambda p: np.degrees(np.arccos(rotations_of(p)[0, 2, 2])), 55),
        ([0.0, 0, 0, 0, 0, 1.5], lambda p: p[0, 5], 1.2),
        ([0.0, 0, 80, 0, 0, 0.6], lambda p: p[0, 2], 70),
    ):
        moved, good = onto_limits(limits, paper_camera, default_board, np.array([vector]))
        assert good[0]
        assert figure(moved) == pytest.approx(limit, rel=0.02)


def test_impossible_poses_do_no_harm(paper_camera: Camera, default_board: Board) -> None:
    wild = np.array(
        [
            [0, 0, 0, 0, 0, 0],
            [0, 0, 0, 0, 0, -0.5],
            [180, 0, 0, 0, 0, 0.5],
            [0, 0, 0, 9, 0, 0.3],
            [400, -300, 90, 1, 1, 1e-9],
        ],
        dtype=float,
    )
    moved, good = onto_limits(Limits(), paper_camera, default_board, wild)
    np.testing.assert_array_equal(good, Limits().accepts(paper_camera, default_board, moved))


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_poses_that_no_step_brings_inside_are_not_compared_with_skipped_ones(
    paper_camera: Camera, default_board: Board
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    skipped = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    space = Space(default_board, paper_camera, limits, (skipped,))
    poses = np.array([skipped.vector(), [20.0, 0, 0, 0, 0, 0.5], [0.0, 0, 0, 0, 0, 1e200]])
    assert space.bring_inside(poses)[1].tolist() == [False, True, False]


def test_rotations_and_angles_are_scipys(rng: np.random.Generator) -> None:
    vectors = np.column_stack([rng.uniform(-89, 89, (500, 3)), np.ones((500, 3))])
    R = rotations_of(vectors)
    expected = Rotation.from_euler("xyz", vectors[:, :3], degrees=True).as_matrix()
    np.testing.assert_allclose(R, expected, atol=1e-14)
    np.testing.assert_allclose(angles_of(R), vectors[:, :3], atol=1e-9)

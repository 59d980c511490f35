"""Targets of each level, and path lengths, against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.exercise import (
    LEAST_SHIFT,
    LEAST_TURN_DEG,
    LEVELS,
    Attempt,
    choose_free,
    detour,
    practice_target,
    start_pose,
    with_free_only,
)
from venus3d.engine.planning.limits import Limits

ALL = (True,) * 6
angles = st.floats(-60, 60)
shifts = st.floats(-0.3, 0.3)
vectors = st.tuples(angles, angles, angles, shifts, shifts, st.floats(0.2, 1.2))


@pytest.mark.parametrize("level", LEVELS)
def test_targets_are_within_the_limits_and_change_as_many_numbers_as_the_level(
    paper_camera: Camera, default_board: Board, level: int
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    start = start_pose(paper_camera, default_board, limits)
    for number in range(25):
        rng = np.random.default_rng([3, level, number])
        target, free = practice_target(paper_camera, default_board, limits, start, level, rng)
        assert limits.accepts(paper_camera, default_board, target.vector())[0]
        assert sum(free) == level
        angles_deg = Rotation.from_matrix(target.R).as_euler("xyz", degrees=True)
        change = np.abs(np.concatenate([angles_deg, target.t - start.t]))
        least = np.array([LEAST_TURN_DEG] * 3 + [LEAST_SHIFT * default_board.width] * 3)
        assert ((change >= least - 1e-9) == np.array(free)).all()
        assert (change[~np.array(free)] < 1e-9).all()


def test_a_seed_repeats_a_target_and_another_one_does_not(
    paper_camera: Camera, default_board: Board
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    start = start_pose(paper_camera, default_board, limits)
    poses = [
        practice_target(
            paper_camera, default_board, limits, start, 6, np.random.default_rng([seed, 6, 1])
        )[0]
        for seed in (1, 1, 2)
    ]
    assert np.array_equal(poses[0].matrix, poses[1].matrix)
    assert not np.allclose(poses[0].matrix, poses[2].matrix)


def test_every_number_comes_up_on_the_first_level() -> None:
    rng = np.random.default_rng(0)
    assert {choose_free(1, rng) for _ in range(200)} == {
        tuple(i == k for i in range(6)) for k in range(6)
    }


def test_a_large_board_starts_where_the_camera_sees_all_of_it(paper_camera: Camera) -> None:
    board = Board(columns=9, rows=6, square=0.1, marker=0.075)
    limits = Limits.for_board(board, paper_camera)
    start = start_pose(paper_camera, board, limits)
    assert limits.accepts(paper_camera, board, start.vector())[0] and start.t[2] > 1
    impossible = Limits(nearest=0.2, farthest=0.21)
    with pytest.raises(VenusError, match="--board"):
        start_pose(paper_camera, board, impossible)


@given(vectors, vectors, st.integers(1, 30))
def test_the_shortest_way_is_scipys_geodesic_and_the_straight_line(
    one: tuple[float, ...], other: tuple[float, ...], pieces: int
) -> None:
    """Walked in any number of pieces along scipy's Slerp, the path is as long as the shortest."""
    start, target = Pose.from_vector(one), Pose.from_vector(other)
    attempt = Attempt.at(start, target, ALL)
    turns = Rotation.from_matrix(np.stack([start.R, target.R]))
    angle_deg = np.degrees((turns[1] * turns[0].inv()).magnitude())
    assert attempt.shortest_deg == pytest.approx(angle_deg, abs=1e-4)
    assert attempt.shortest_mm == pytest.approx(1000 * np.linalg.norm(target.t - start.t))
    slerp = Slerp([0, 1], turns)
    for i, at in enumerate(np.linspace(0, 1, pieces + 1)[1:]):
        place = start.t + at * (target.t - start.t)
        attempt = attempt.moved(Pose(slerp(at).as_matrix(), place), float(i))
    # Pieces shorter than the rounding of a matrix are not counted.
    assert attempt.path_deg == pytest.approx(angle_deg, abs=pieces * 2e-4)
    assert attempt.path_mm == pytest.approx(attempt.shortest_mm, abs=1e-3)


@given(vectors, st.lists(vectors, min_size=1, max_size=8))
def test_no_way_is_shorter_than_the_shortest(
    start: tuple[float, ...], stops: list[tuple[float, ...]]
) -> None:
    poses = [Pose.from_vector(stop) for stop in stops]
    attempt = Attempt.at(Pose.from_vector(start), poses[-1], ALL)
    for i, pose in enumerate(poses):
        attempt = attempt.moved(pose, float(i))
    assert attempt.path_deg >= attempt.shortest_deg - 1e-3 * len(stops)
    assert attempt.path_mm >= attempt.shortest_mm - 1e-3


@settings(max_examples=50)
@given(vectors, st.lists(st.booleans(), min_size=6, max_size=6))
def test_numbers_that_are_locked_stay(vector: tuple[float, ...], free: list[bool]) -> None:
    start = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    kept = with_free_only(Pose.from_vector(vector), start, tuple(free))
    got = np.append(Rotation.from_matrix(kept.R).as_euler("xyz", degrees=True), kept.t)
    assert got == pytest.approx(np.where(free, vector, start.vector()), abs=1e-6)


def test_the_clock_runs_from_the_first_move() -> None:
    start = Pose.from_vector([0, 0, 0, 0, 0, 0.5])
    attempt = Attempt.at(start, start.moved([0.1, 0, 0]), ALL)
    assert attempt.taken_s(100) == attempt.still_s(100) == 0
    assert attempt.moved(start, 5.0) is attempt, "not moved at all"
    attempt = attempt.moved(start.moved([0.05, 0, 0]), 7.0).moved(start, 9.0)
    assert (attempt.taken_s(10), attempt.still_s(10)) == (3, 1)
    assert attempt.path_mm == pytest.approx(100)


def test_a_number_that_is_typed_is_not_walked_by_way_of_its_digits() -> None:
    """4, 45, 450, most of a second each: only where it stands in the end counts."""
    start = Pose.from_vector([0, 0, 0, 0, 0, 0.55])
    attempt = Attempt.at(start, Pose.from_vector([0, 0, 0, 0, 0, 0.4]), ALL)
    for now, z in ((1.0, 0.15), (1.8, 0.155), (2.6, 0.45)):
        attempt = attempt.moved(Pose.from_vector([0, 0, 0, 0, 0, z]), now, jump=True)
    assert attempt.path_mm == pytest.approx(100)
    assert attempt.began_s == 1.0
    # After a rest a jump is another leg; a drag counts all of its way.
    attempt = attempt.moved(Pose.from_vector([0, 0, 0, 0, 0, 0.5]), 4.0, jump=True)
    assert attempt.path_mm == pytest.approx(150)
    for now, z in ((4.1, 0.4), (4.2, 0.5)):
        attempt = attempt.moved(Pose.from_vector([0, 0, 0, 0, 0, z]), now)
    assert attempt.path_mm == pytest.approx(350)


def test_the_detour_is_the_worse_of_shift_and_turn() -> None:
    assert detour(150, 100, 20, 20) == pytest.approx(1.5)
    assert detour(4, 0.0, 60, 20) == pytest.approx(3), "only a turn"
    assert np.isnan(detour(4, 0.0, 1, 0.0))

"""The searches, on costs whose minimum is known and on the real one."""

from __future__ import annotations

import numpy as np
import pytest

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.costs import make_cost
from venus3d.engine.errors import VenusError
from venus3d.engine.information import prior_information, view_information
from venus3d.engine.limits import Limits
from venus3d.engine.pose import Array, Pose, rotations_of
from venus3d.engine.search import Move, anneal, search_globally
from venus3d.engine.space import Space, random_pose

GOAL = np.array([20.0, -30, 10, 0.05, -0.02, 0.5])
SCALE = np.array([20.0, 20, 20, 0.05, 0.05, 0.1])


def bowl(vectors: Array) -> Array:
    return np.sum(((vectors - GOAL) / SCALE) ** 2, axis=1)


@pytest.fixture
def space(paper_camera: Camera, default_board: Board) -> Space:
    return Space(default_board, paper_camera, Limits())


def test_unit_cube_and_vectors(space: Space, rng: np.random.Generator) -> None:
    unit = rng.random((50, 6))
    vectors = space.from_unit(unit)
    np.testing.assert_allclose(space.to_unit(vectors), unit, atol=1e-12)
    # The centre's place in the picture, by the pinhole itself.
    pinhole = space.camera.without_distortion()
    np.testing.assert_allclose(
        (pinhole.project(vectors[:, 3:]) + 0.5) / [1280, 720], unit[:, 3:5], atol=1e-12
    )


def test_the_whole_space_is_searched_to_the_minimum(space: Space) -> None:
    for seed in range(3):
        found = search_globally(space, bowl, np.random.default_rng(seed))
        assert found.cost < 0.05 and not found.stopped
        assert space.accepts(found.vector)[0]
        assert 3500 <= found.evaluated < 3500 + 64


def test_on_the_real_cost_no_local_descent_and_no_sample_is_much_better(
    space: Space, rng: np.random.Generator
) -> None:
    camera, board = space.camera, space.board
    views = np.array([[45.0, 0, 0, 0, 0, 0.4], [-30, 20, 0, 0, 0, 0.35], [20, -40, 0, 0, 0, 0.4]])
    information = view_information(camera, board.corners, rotations_of(views), views[:, 3:]).sum(
        axis=0
    ) + prior_information(camera)
    cost = make_cost("projection-variance", board=board, camera=camera, information=information)
    costs = [search_globally(space, cost, np.random.default_rng(s)).cost for s in range(4)]
    assert max(costs) < 1.6 * min(costs), "the seeds agree about what is good"
    sampled = np.array([random_pose(space, rng) for _ in range(400)])
    assert max(costs) < cost(sampled).min()


def test_the_searches_repeat_with_their_seed(space: Space) -> None:
    for search in (
        lambda rng: search_globally(space, bowl, rng, budget=300),
        lambda rng: anneal(space, bowl, [0, 0, 0, 0, 0, 0.5], rng),
    ):
        one, two = search(np.random.default_rng(5)), search(np.random.default_rng(5))
        np.testing.assert_array_equal(one.vector, two.vector)
        assert not np.array_equal(one.vector, search(np.random.default_rng(6)).vector)


def test_algorithm_1_has_its_numbers(space: Space) -> None:
    """Seven temperatures from 1 down to 0.1 at r = 0.7, ten neighbours each, one element each."""
    moves: list[Move] = []
    start = np.array([0.0, 0, 0, 0, 0, 0.5])
    found = anneal(space, bowl, start, np.random.default_rng(1), on_move=moves.append)
    assert found.evaluated == 71 and len(moves) == 70
    now = start
    for move in moves:
        assert np.count_nonzero(move.vector != now) == 1
        assert space.accepts(move.vector)[0]
        if move.accepted:
            now = move.vector
    np.testing.assert_array_equal(found.vector, now), "as printed: the last pose taken"


def test_eq_12_by_its_statistics(space: Space) -> None:
    """A rise of 0.5 at T = 1 is taken with probability exp(-0.5) = 0.607; a fall always."""
    taken: list[bool] = []
    for seed in range(40):
        costs = iter([1.0, 1.5, 1.0])  # the start, a neighbour that costs more, one that costs less
        moves: list[Move] = []
        anneal(
            space,
            lambda vectors, costs=costs: np.full(len(vectors), next(costs)),
            [0, 0, 0, 0, 0, 0.5],
            np.random.default_rng(seed),
            end_temperature=0.99,
            tries=2,
            on_move=moves.append,
        )
        taken.append(moves[0].accepted)
        if moves[0].accepted:
            assert moves[1].accepted
    p = np.exp(-0.5)
    assert abs(np.mean(taken) - p) < 3 * np.sqrt(p * (1 - p) / 40)


def test_keep_best_returns_the_best_pose_met(space: Space) -> None:
    for seed in range(5):
        moves: list[Move] = []
        best = anneal(
            space,
            bowl,
            [0, 0, 0, 0, 0, 0.5],
            np.random.default_rng(seed),
            keep_best=True,
            on_move=moves.append,
        )
        last = anneal(space, bowl, [0, 0, 0, 0, 0, 0.5], np.random.default_rng(seed))
        met = min([float(bowl(np.array([[0, 0, 0, 0, 0, 0.5]]))[0]), *(m.cost for m in moves)])
        assert best.cost == met <= last.cost
        assert bowl(best.vector[None])[0] == best.cost


def test_a_stop_returns_the_best_so_far(space: Space) -> None:
    calls: list[int] = []

    def soon() -> bool:
        calls.append(1)
        return len(calls) > 3

    moves: list[Move] = []
    found = search_globally(space, bowl, np.random.default_rng(0), stop=soon, on_move=moves.append)
    assert found.stopped and found.evaluated < 800
    assert found.cost == moves[-1].best_cost == bowl(found.vector[None])[0]
    at_once = anneal(space, bowl, GOAL, np.random.default_rng(0), stop=lambda: True)
    assert at_once.stopped and at_once.evaluated == 1
    np.testing.assert_array_equal(at_once.vector, GOAL)


def test_moves_are_reported_with_a_falling_best(space: Space) -> None:
    moves: list[Move] = []
    found = search_globally(space, bowl, np.random.default_rng(0), on_move=moves.append)
    costs = [move.best_cost for move in moves]
    assert len(moves) > 10 and costs == sorted(costs, reverse=True)
    assert moves[-1].evaluated == found.evaluated and costs[-1] == found.cost


def test_skipped_poses_stay_away(space: Space, rng: np.random.Generator) -> None:
    skipped = Pose.from_vector(GOAL)
    around = Space(space.board, space.camera, space.limits, (skipped,))
    found = search_globally(around, bowl, rng)
    there = Pose.from_vector(found.vector)
    assert there.angle_to_deg(skipped) >= 15 or there.distance_to(skipped) >= 0.1 * np.linalg.norm(
        skipped.t
    )
    assert found.cost < 2, "but no farther than needed"


def test_limits_that_leave_nothing_are_told(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    none = Space(default_board, paper_camera, Limits(min_square_px=400))
    for search in (random_pose, lambda s, r: search_globally(s, bowl, r)):
        with pytest.raises(VenusError, match="fits the limits"):
            search(none, rng)

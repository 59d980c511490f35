"""Searches for the pose with the smallest cost: all strategies behind one function.

annealing                Algorithm 1 of the paper, from a given pose
global                   ours: the whole pose space within the limits (`global_search`)
dual-annealing           scipy's, a benchmark
differential-evolution   scipy's, a benchmark (the paper's outlook names evolutionary search)

All take a random generator, return the best pose so far when stopped, and report their steps.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import differential_evolution, dual_annealing

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.costs import CostFunction
from venus3d.engine.planning.global_search import search_globally
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, SearchRun, Stop
from venus3d.engine.planning.settings import STRATEGIES, Strategy

BUDGET: dict[Strategy, int] = {
    "annealing": 70,
    "global": 3050,
    "dual-annealing": 5000,
    "differential-evolution": 5000,
}
"""Default number of poses to evaluate."""
_ROUNDS = 7  # temperatures of the annealing, from 1 to 0.1 with a factor of 0.7
_TRIES = 50  # draws for one neighbour within the space
# scipy renames `seed` to `rng`; all versions accept the old name, but not all stubs.
_dual_annealing: Any = dual_annealing
_differential_evolution: Any = differential_evolution
_BOUNDS = [(0.0, 1.0)] * 6
_OUTSIDE = 20.0  # in units of the logarithm: above any pose of the space


def search(
    strategy: Strategy,
    space: Space,
    cost: CostFunction,
    rng: np.random.Generator,
    *,
    start: ArrayLike | None = None,
    budget: int | None = None,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
    keep_best: bool = False,
) -> SearchResult:
    """The cheapest pose of the space that the strategy finds.

    Args:
        cost: of pose vectors (N, 6), never negative; see `make_cost`.
        start: (6,) a pose of the space where the annealing begins; the others need none.
        budget: approximate number of poses to evaluate; None for the strategy's default (`BUDGET`).
        stop: polled; once True the best pose so far is returned.
        on_step: called with every pose evaluated, or with the best of every batch.
        keep_best: the annealing returns the best pose it met, not the last one as printed.

    Raises `VenusError` for an unknown strategy, an annealing without a start, a budget below one,
    and limits that leave no pose.
    """
    if strategy not in STRATEGIES:
        raise VenusError(f"There is no strategy {strategy!r}; use one of {', '.join(STRATEGIES)}.")
    count = BUDGET[strategy] if budget is None else budget
    if count < 1:
        raise VenusError(f"A search that looks at {count} poses finds none; allow at least one.")
    watch: dict[str, Any] = {"stop": stop, "on_step": on_step}
    if strategy == "annealing":
        if start is None:
            raise VenusError("The strategy annealing begins at a pose; give it a start.")
        tries = -(-count // _ROUNDS)
        return anneal(space, cost, start, rng, tries=tries, keep_best=keep_best, **watch)
    if strategy == "global":
        return search_globally(space, cost, rng, budget=count, **watch)
    return _scipys(strategy, SearchRun(space, stop, on_step), cost, rng, count)


def neighbour_sigma(board: Board) -> Array:
    """(6,) standard deviations of a neighbour in `anneal`; the paper gives none.

    10 degrees for an angle and a tenth of the board's width for each direction. The seventy steps
    are nearly a random walk (T is large compared with the changes in cost), so wider ones mostly
    leave the good start pose.
    """
    return np.array([10.0] * 3 + [0.1 * board.width] * 3)


def anneal(
    space: Space,
    cost: CostFunction,
    start: ArrayLike,
    rng: np.random.Generator,
    *,
    end_temperature: float = 0.1,
    tries: int = 10,
    keep_best: bool = False,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> SearchResult:
    """Algorithm 1: simulated annealing from `start` (6,), a pose of the space.

    A neighbour changes one random element by a Gaussian (`neighbour_sigma`) and is redrawn while
    outside the space. A cheaper one is always accepted, another with probability exp(-dE / T),
    eq. (12). By default T falls from 1 to 0.1 in seven rounds of ten neighbours.

    As printed, the last accepted pose is returned; with `keep_best`, the best one met.
    """
    run, sigma = SearchRun(space, stop, on_step), neighbour_sigma(space.board)
    now = np.asarray(start, dtype=np.float64).copy()
    now_cost = float(cost(now[None])[0])
    run.add(now[None], np.array([now_cost]))
    temperature, stopped = 1.0, False
    while temperature > end_temperature and not stopped:
        for _ in range(tries):
            stopped = run.is_stopped()
            if stopped:
                break
            candidate = _neighbour(space, now, sigma, rng)
            if candidate is None:
                continue
            value = float(cost(candidate[None])[0])
            rise = value - now_cost
            accepted = rise < 0 or bool(rng.random() < np.exp(-rise / temperature))
            if accepted:
                now, now_cost = candidate, value
            run.add(candidate[None], np.array([value]))
            run.report(candidate[None], np.array([value]), accepted)
        temperature *= 0.7
    found = run.found()
    return found if keep_best or stopped else replace(found, vector=now, cost=now_cost)


def _neighbour(space: Space, vector: Array, sigma: Array, rng: np.random.Generator) -> Array | None:
    for _ in range(_TRIES):
        element = int(rng.integers(6))
        candidate = vector.copy()
        candidate[element] += sigma[element] * rng.standard_normal()
        if space.accepts(candidate)[0]:
            return candidate
    return None


class _Ended(Exception):  # noqa: N818 (no error: the way out of scipy's loops)
    """The budget is used up, or a stop was requested."""


def _scipys(
    strategy: Strategy, run: SearchRun, cost: CostFunction, rng: np.random.Generator, budget: int
) -> SearchResult:
    """scipy's global optimisers on the same space and cost, for `budget` points.

    Both work in the unit cube of `Space.from_unit` on the logarithm of the cost, which removes its
    scale. A point outside the space costs more than any pose, increasing with how far it breaks the
    limits, so that the slope leads back inside.
    """
    space, left = run.space, budget
    # Start with a valid pose: the search may be stopped before it finds one.
    first = random_pose(space, rng)[None]
    scale = cost(first)
    run.add(first, scale)

    def log_costs(unit: Array) -> Array:
        """(N,) for points (N, 6) of the unit cube."""
        nonlocal left
        if run.is_stopped() or left <= 0:
            raise _Ended
        left -= len(unit)
        vectors = space.from_unit(unit)
        excess = space.excess(vectors)
        values = _OUTSIDE + excess
        inside = np.flatnonzero(excess == 0)
        if len(inside):
            costs = cost(vectors[inside])
            values[inside] = np.log(costs / scale)
            run.report(vectors[inside], costs, run.add(vectors[inside], costs))
        return values

    def of_one(unit: Array) -> float:
        return float(log_costs(unit[None])[0])

    def of_columns(unit: Array) -> Array:
        return log_costs(unit.T)

    with suppress(_Ended):
        if strategy == "dual-annealing":
            _dual_annealing(of_one, _BOUNDS, maxiter=10**9, seed=rng)
        else:  # 60 points at a time, from a Sobol sequence, without final polishing
            _differential_evolution(
                of_columns,
                _BOUNDS,
                popsize=10,
                maxiter=10**9,
                tol=0.0,
                init="sobol",
                polish=False,
                updating="deferred",
                vectorized=True,
                seed=rng,
            )
    return run.found()

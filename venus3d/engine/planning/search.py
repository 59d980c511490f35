"""Searches for the pose with the smallest cost: all strategies behind one function.

annealing                Algorithm 1 of the paper, from a given pose
global                   ours: the whole pose space within the limits
dual-annealing           scipy's, a benchmark
differential-evolution   scipy's, a benchmark (the paper's outlook names evolutionary search)

All take a random generator, return the best pose so far when stopped, and report their steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.errors import VenusError
from venus3d.engine.planning.annealing import ROUNDS, anneal, neighbour_sigma
from venus3d.engine.planning.costs import CostFunction
from venus3d.engine.planning.global_search import search_globally
from venus3d.engine.planning.method import STRATEGIES, Strategy
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.scipy_searches import (
    differential_evolution_search,
    dual_annealing_search,
)
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, SearchStep, Stop

__all__ = [
    "BUDGET",
    "OnSearchStep",
    "SearchResult",
    "SearchStep",
    "Stop",
    "anneal",
    "neighbour_sigma",
    "search",
    "search_globally",
]

BUDGET: dict[Strategy, int] = {
    "annealing": 70,
    "global": 3050,
    "dual-annealing": 5000,
    "differential-evolution": 5000,
}
"""Default number of poses to evaluate."""


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
    if strategy == "annealing":
        if start is None:
            raise VenusError("The strategy annealing begins at a pose; give it a start.")
        return anneal(
            space,
            cost,
            start,
            rng,
            tries=-(-count // ROUNDS),
            keep_best=keep_best,
            stop=stop,
            on_step=on_step,
        )
    if strategy == "global":
        return search_globally(space, cost, rng, budget=count, stop=stop, on_step=on_step)
    run = {
        "dual-annealing": dual_annealing_search,
        "differential-evolution": differential_evolution_search,
    }[strategy]
    return run(space, cost, rng, budget=count, stop=stop, on_step=on_step)

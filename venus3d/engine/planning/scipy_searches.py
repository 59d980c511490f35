"""scipy's global optimisers on the same space and cost, as benchmarks of our own search.

Both work in the unit cube of `Space.from_unit` on the logarithm of the cost, which removes its
scale. A point outside the space costs more than any pose, increasing with how far it breaks the
limits, so that the slope leads back inside.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
from scipy.optimize import differential_evolution, dual_annealing

from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.costs import CostFunction
from venus3d.engine.planning.elites import Elites
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, SearchStep, Stop

# scipy renames `seed` to `rng`; all versions accept the old name, but not all stubs.
_dual_annealing: Any = dual_annealing
_differential_evolution: Any = differential_evolution
_BOUNDS = [(0.0, 1.0)] * 6
_OUTSIDE = 20.0  # in units of the logarithm: above any pose of the space


class _Ended(Exception):  # noqa: N818 (no error: the way out of scipy's loops)
    """The budget is used up, or a stop was requested."""


def dual_annealing_search(
    space: Space,
    cost: CostFunction,
    rng: np.random.Generator,
    *,
    budget: int = 5000,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> SearchResult:
    """`scipy.optimize.dual_annealing` with its defaults, for `budget` points."""
    objective = _Objective(space, cost, rng, budget, stop, on_step)
    with suppress(_Ended):
        _dual_annealing(objective.of_one, _BOUNDS, maxiter=10**9, seed=rng)
    return objective.found()


def differential_evolution_search(
    space: Space,
    cost: CostFunction,
    rng: np.random.Generator,
    *,
    budget: int = 5000,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> SearchResult:
    """`scipy.optimize.differential_evolution`, 60 points at a time, for `budget` points.
    From a Sobol sequence and without final polishing, otherwise with its defaults."""
    objective = _Objective(space, cost, rng, budget, stop, on_step)
    with suppress(_Ended):
        _differential_evolution(
            objective.of_columns,
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
    return objective.found()


class _Objective:
    """Logarithms of the costs of points of the unit cube; records all of them."""

    def __init__(
        self,
        space: Space,
        cost: CostFunction,
        rng: np.random.Generator,
        budget: int,
        stop: Stop | None,
        on_step: OnSearchStep | None,
    ) -> None:
        self._space, self._cost, self._left = space, cost, budget
        self._stop, self._on_step, self._stopped = stop, on_step, False
        self._elites = Elites(space)
        # Start with a valid pose: the search may be stopped before it finds one.
        first = random_pose(space, rng)[None]
        self._elites.add(first, cost(first))

    def __call__(self, unit: Array) -> Array:
        """(N,) for points (N, 6). Ends the search by `_Ended`."""
        self._stopped = self._stop is not None and self._stop()
        if self._stopped or self._left <= 0:
            raise _Ended
        self._left -= len(unit)
        vectors = self._space.from_unit(unit)
        excess = self._space.excess(vectors)
        values = _OUTSIDE + excess
        inside = np.flatnonzero(excess == 0)
        if len(inside):
            costs = self._cost(vectors[inside])
            values[inside] = np.log(costs / self._elites.first_cost)
            self._report(vectors[inside], costs)
        return values

    def _report(self, vectors: Array, costs: Array) -> None:
        before = self._elites.best_cost
        self._elites.add(vectors, costs)
        if self._on_step is not None:
            i, elites = int(np.argmin(costs)), self._elites
            better = bool(costs[i] < before)
            cost = float(costs[i])
            self._on_step(
                SearchStep(
                    vectors[i], cost, better, elites.best, elites.best_cost, elites.evaluated
                )
            )

    def of_one(self, unit: Array) -> float:
        return float(self(unit[None])[0])

    def of_columns(self, unit: Array) -> Array:
        return self(unit.T)

    def found(self) -> SearchResult:
        return self._elites.found(self._stopped)

"""Search of the whole space of poses within the limits, in a few tenths of a second.

Well-spread samples, then differential evolution in batches. The best poses lie on the limits (as
near, as tilted, as far into a corner of the image as allowed), where a free neighbour is mostly
outside. So poses that break a limit are moved onto it (`onto_limits`), and steps are differences of
good poses, which run along their common limits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.costs import CostFunction, rough_of
from venus3d.engine.planning.elites import Elites
from venus3d.engine.planning.pose_space import Space, nothing_fits
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, SearchStep, Stop

Numbers = NDArray[np.intp]
_SAMPLES = 0.15  # share of the budget for the first samples of the whole space
_PARENTS = (48, 16)  # at the start and at the end
_ELITE = 0.1  # share of the parents towards which the others move
_STRIDE = 1.0  # median length of a step, in differences
_CROSSOVER = 0.9  # share of the coordinates that a step changes
_MIRRORED = 0.07  # share of the children that are mirrored
# A board left of the centre in a mirrored image: the angles about Y and Z change sign as well.
_MIRRORS = np.array([[0, 1, 1, 1, 0, 0], [1, 0, 1, 0, 1, 0], [1, 1, 0, 1, 1, 0]], dtype=bool)
_PART = 448  # candidates between two checks of `stop`


def search_globally(
    space: Space,
    cost: CostFunction,
    rng: np.random.Generator,
    *,
    budget: int = 3050,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> SearchResult:
    """The cheapest pose of the space; all randomness comes from `rng`.

    A seventh of the budget goes into a Sobol sequence over the unit cube of `Space`, randomly
    shifted. The best 48 become parents. A child is `u + F (b - u + p - q)`: parent u, one of the
    best tenth b, two other parents p and q, F scattered about 1 (differential evolution,
    current-to-pbest/1: Zhang and Sanderson 2009), a tenth of the coordinates kept. The best child
    that is cheaper replaces its parent, and the worst parents drop out until 16 are left.

    Args:
        cost: of pose vectors (N, 6). Its faster approximation (`rough_of`) ranks, if there is one;
            only the returned poses are given their exact cost.
        budget: approximate number of costs to compute.
        stop, on_step: see `search`.

    Raises `VenusError` if no pose fits the limits.
    """
    run = _Run(space, cost, stop, on_step)
    parents, costs = run.samples(budget, rng)
    # In a space of few poses most children are invalid, so the rounds are limited.
    for _ in range(10 + 4 * budget // _PART):
        if run.elites.evaluated >= budget or run.stopped():
            break
        spent = run.elites.evaluated / budget
        count = round(_PARENTS[0] + (_PARENTS[1] - _PARENTS[0]) * spent)
        order = np.argsort(costs, kind="stable")[:count]
        parents, costs = parents[order], costs[order]
        children, of = _children(parents, min(_PART, budget - run.elites.evaluated), rng)
        found, values, kept = run.look_at(children)
        _replace(parents, costs, found, values, of[kept])
    return run.found()


class _Run:
    """A search in progress."""

    def __init__(
        self,
        space: Space,
        cost: CostFunction,
        stop: Stop | None,
        on_step: OnSearchStep | None,
    ) -> None:
        self.elites = Elites(space)
        self._space, self._cost, self._rough = space, cost, rough_of(cost)
        self._stop, self._on_step, self._stopped = stop, on_step, False

    def stopped(self) -> bool:
        self._stopped = self._stopped or (self._stop is not None and self._stop())
        return self._stopped

    def samples(self, budget: int, rng: np.random.Generator) -> tuple[Array, Array]:
        """Points (N, 6) of the unit cube spread over the space, and their costs (N,)."""
        sequence, shift = qmc.Sobol(6, scramble=False), rng.random(6)
        wanted = max(1, round(_SAMPLES * budget))
        size = min(512, 2 ** int(np.ceil(np.log2(2 * wanted))))  # Sobol needs powers of two
        points: list[Array] = []
        costs: list[Array] = []
        for _ in range(2**15 // size):
            unit, values, _ = self.look_at((np.asarray(sequence.random(size)) + shift) % 1.0)
            points.append(unit)
            costs.append(values)
            if self.elites.evaluated >= wanted or (self.elites.evaluated and self.stopped()):
                break
        if not self.elites.evaluated:
            raise nothing_fits(self._space)
        return np.concatenate(points), np.concatenate(costs)

    def look_at(self, unit: Array) -> tuple[Array, Array, Numbers]:
        """Points (N, 6) brought into the space: those (K, 6) for which it worked, their costs (K,)
        and numbers (K,)."""
        vectors, good = self._space.bring_inside(self._space.from_unit(unit))
        kept = np.flatnonzero(good)
        if not kept.size:
            return unit[:0], np.zeros(0), kept
        vectors = vectors[kept]
        costs = self._rough(vectors)
        self.elites.add(vectors, costs)
        self._report(vectors, costs)
        return self._space.to_unit(vectors), costs, kept

    def _report(self, vectors: Array, costs: Array) -> None:
        """Report a batch's best pose, as accepted if it is the best of all."""
        if self._on_step is None:
            return
        i, elites = int(np.argmin(costs)), self.elites
        cost = float(costs[i])
        self._on_step(
            SearchStep(
                vectors[i],
                cost,
                cost <= elites.best_cost,
                elites.best,
                elites.best_cost,
                elites.evaluated,
                vectors,
                costs,
            )
        )

    def found(self) -> SearchResult:
        found = self.elites.found(self._stopped)
        if self._rough is self._cost:
            return found
        costs = self._cost(found.elites)
        order = np.argsort(costs, kind="stable")
        elites, costs = found.elites[order], costs[order]
        return SearchResult(
            elites[0], float(costs[0]), found.evaluated, self._stopped, elites, costs
        )


def _children(parents: Array, count: int, rng: np.random.Generator) -> tuple[Array, Numbers]:
    """Children (K, 6) of parents (N, 6), cheapest first, and their parents (K,); K about count."""
    n = len(parents)
    of = np.repeat(np.arange(n), -(-count // n))
    size = len(of)
    stride = np.clip(_STRIDE + 0.1 * rng.standard_cauchy((size, 1)), 0.05, 1.5)
    best = parents[rng.integers(max(1, round(_ELITE * n)), size=size)]
    one, other = parents[rng.integers(n, size=(2, size))]
    step = stride * (best - parents[of] + one - other)
    step *= rng.random((size, 6)) < _CROSSOVER
    children = parents[of] + step
    mirrored = rng.random(size) < _MIRRORED
    flip = _MIRRORS[rng.integers(len(_MIRRORS), size=size)] & mirrored[:, None]
    return np.where(flip, 1 - children, children), of


def _replace(parents: Array, costs: Array, found: Array, values: Array, of: Numbers) -> None:
    """Replace each parent by its cheapest child if that is cheaper, in place."""
    order = np.lexsort((values, of))
    first = order[np.unique(of[order], return_index=True)[1]]
    better = first[values[first] < costs[of[first]]]
    parents[of[better]], costs[of[better]] = found[better], values[better]

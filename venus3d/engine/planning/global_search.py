"""Search of the whole space of poses within the limits, in a few tenths of a second.

Well-spread samples, then differential evolution in batches. The best poses lie on the limits (as
near, as tilted, as far into a corner of the image as allowed), where a free neighbour is mostly
outside. So poses that break a limit are moved onto it (`onto_limits`), and steps are differences of
good poses, which run along their common limits.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.costs import CostFunction, rough_of
from venus3d.engine.planning.pose_space import Space, nothing_fits
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, SearchRun, Stop
from venus3d.engine.planning.sobol import sobol

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
    run, rough = SearchRun(space, stop, on_step), rough_of(cost)
    parents, costs = _samples(run, rough, budget, rng)
    # In a space of few poses most children are invalid, so the rounds are limited.
    for _ in range(10 + 4 * budget // _PART):
        if run.evaluated >= budget or run.is_stopped():
            break
        spent = run.evaluated / budget
        count = round(_PARENTS[0] + (_PARENTS[1] - _PARENTS[0]) * spent)
        order = np.argsort(costs, kind="stable")[:count]
        parents, costs = parents[order], costs[order]
        children, of = _children(parents, min(_PART, budget - run.evaluated), rng)
        found, values, kept = _look_at(run, rough, children)
        _replace(parents, costs, found, values, of[kept])
    result = run.found()
    if rough is cost:
        return result
    costs = cost(result.elites)
    order = np.argsort(costs, kind="stable")
    elites, costs = result.elites[order], costs[order]
    return replace(result, vector=elites[0], cost=float(costs[0]), elites=elites, elite_costs=costs)


def _samples(
    run: SearchRun, cost: CostFunction, budget: int, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Points (N, 6) of the unit cube spread over the space, and their costs (N,)."""
    shift = rng.random(6)
    wanted = max(1, round(_SAMPLES * budget))
    size = min(512, 2 ** int(np.ceil(np.log2(2 * wanted))))  # Sobol needs powers of two
    points: list[Array] = []
    costs: list[Array] = []
    for first in range(0, 2**15, size):
        unit, values, _ = _look_at(run, cost, (sobol(first, size) + shift) % 1.0)
        points.append(unit)
        costs.append(values)
        if run.evaluated >= wanted or (run.evaluated and run.is_stopped()):
            break
    if not run.evaluated:
        raise nothing_fits(run.space)
    return np.concatenate(points), np.concatenate(costs)


def _look_at(run: SearchRun, cost: CostFunction, unit: Array) -> tuple[Array, Array, Numbers]:
    """Points (N, 6) brought into the space: those (K, 6) for which it worked, their costs (K,) and
    numbers (K,)."""
    vectors, good = run.space.bring_inside(run.space.from_unit(unit))
    kept = np.flatnonzero(good)
    if not kept.size:
        return unit[:0], np.zeros(0), kept
    vectors = vectors[kept]
    costs = cost(vectors)
    run.report(vectors, costs, run.add(vectors, costs), batch=True)
    return run.space.to_unit(vectors), costs, kept


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

"""Our own search: the whole space of poses within the limits, in the time of a blink.

The paper's annealing is in `annealing`, scipy's optimisers as yardsticks in `yardsticks`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import qmc

from venus3d.engine.costs import CostFunction
from venus3d.engine.moves import Found, Move, Stop, Watch
from venus3d.engine.pool import Pool
from venus3d.engine.pose import Array
from venus3d.engine.space import Space, nothing_fits


def search_globally(
    space: Space,
    cost: CostFunction,
    rng: np.random.Generator,
    *,
    budget: int = 3500,
    samples: int = 500,
    neighbours: int = 256,
    parents: int = 32,
    sigma: float = 0.12,
    shrink: float = 0.8,
    stop: Stop | None = None,
    on_move: Watch | None = None,
) -> Found:
    """The whole space: well-spread samples, then ever closer neighbours of the best ones.

    `samples` poses of the space come from a Sobol sequence, shifted at random. Then each of the
    `rounds` looks at up to `neighbours` Gaussian neighbours of the `parents` best poses met, in the
    coordinates of `Space.from_unit`: moving away keeps the place in the picture. The standard
    deviation starts at `sigma` (of the unit cube: 17 degrees, an eighth of the picture) and shrinks
    by `shrink` each round. A population, so that a good corner of the space is not lost to a better
    one found first.

    Raises `VenusError` if no pose fits the limits.
    """
    kept = Pool(space)
    rounds = max(0, -(-(budget - samples) // neighbours))
    vectors = _samples(space, min(samples, budget), rng)
    costs = _costs_in_parts(cost, vectors, stop)
    evaluated = costs.size
    kept.add(vectors[:evaluated], costs)
    pool, costs = _cheapest(space.to_unit(vectors[:evaluated]), costs, parents)
    _report(on_move, space, pool, costs, pool[0], float(costs[0]), evaluated)
    stopped = False
    for _ in range(rounds):
        stopped = stop is not None and stop()
        if stopped:
            break
        # About half of the neighbours leave the space; twice as many are drawn as are looked at.
        around = np.repeat(pool, -(-2 * neighbours // len(pool)), axis=0)
        around = around + sigma * rng.standard_normal(around.shape)
        sigma *= shrink
        around = around[space.accepts(space.from_unit(around))]
        around = around[rng.permutation(len(around))[:neighbours]]
        if not len(around):
            continue
        values = cost(space.from_unit(around))
        evaluated += len(around)
        kept.add(space.from_unit(around), values)
        shown, shown_cost = around[int(np.argmin(values))], float(values.min())
        pool, costs = _cheapest(
            np.concatenate([pool, around]), np.concatenate([costs, values]), parents
        )
        _report(on_move, space, pool, costs, shown, shown_cost, evaluated)
    return kept.found(stopped)


def _cheapest(pool: Array, costs: Array, count: int) -> tuple[Array, Array]:
    order = np.argsort(costs, kind="stable")[:count]
    return pool[order], costs[order]


def _report(
    on_move: Watch | None,
    space: Space,
    pool: Array,
    costs: Array,
    shown: Array,
    shown_cost: float,
    evaluated: int,
) -> None:
    """Tell of a round's best pose; it counts as accepted if it is the best of all."""
    if on_move is None:
        return
    vector, best = space.from_unit(np.stack([shown, pool[0]]))
    best_cost = float(costs[0])
    on_move(Move(vector, shown_cost, shown_cost <= best_cost, best, best_cost, evaluated))


def _samples(space: Space, count: int, rng: np.random.Generator) -> Array:
    """Up to `count` poses (N, 6) of the space, well spread."""
    sequence = qmc.Sobol(6, scramble=False)
    shift = rng.random(6)
    found: list[Array] = []
    for _ in range(32):
        vectors = space.from_unit((np.asarray(sequence.random(1024)) + shift) % 1.0)
        found.append(vectors[space.accepts(vectors)])
        if sum(map(len, found)) >= count:
            break
    pool = np.concatenate(found)[:count]
    if not len(pool):
        raise nothing_fits(space)
    return pool


def _costs_in_parts(cost: CostFunction, vectors: Array, stop: Stop | None) -> Array:
    """Costs of the vectors, (N,), or of as many as there was time for; at least one part."""
    parts: Sequence[Array] = np.array_split(vectors, -(-len(vectors) // 128))
    costs: list[Array] = []
    for part in parts:
        costs.append(cost(part))
        if stop is not None and stop():
            break
    return np.concatenate(costs)

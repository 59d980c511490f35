"""Looking for the pose with the smallest cost: Algorithm 1 of the paper, and the whole pose space.

All searches take a random generator, stop when asked to with the best pose so far, and report
their moves so that they can be watched. What a pose costs is `costs`' business, which poses are
allowed `space`'s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import qmc

from venus3d.engine.board import Board
from venus3d.engine.costs import CostFunction
from venus3d.engine.pose import Array
from venus3d.engine.space import Space, nothing_fits

Stop = Callable[[], bool]
_TRIES = 50  # draws for one neighbour within the space


@dataclass(frozen=True, eq=False)
class Move:
    """One step of a search, for somebody who watches."""

    vector: Array
    """(6,) the pose looked at."""
    cost: float
    accepted: bool
    """Whether the search went on from it."""
    best_vector: Array
    """(6,) the cheapest pose so far."""
    best_cost: float
    evaluated: int
    """Costs computed so far."""


@dataclass(frozen=True, eq=False)
class Found:
    """What a search ended with."""

    vector: Array
    """(6,) pose vector."""
    cost: float
    evaluated: int
    """Costs computed."""
    stopped: bool
    """Whether it was stopped before its end."""
    pool: Array = field(default_factory=lambda: np.empty((0, 6)))
    """(K, 6) the good poses met, cheapest first, the best included; empty if none were kept."""
    pool_costs: Array = field(default_factory=lambda: np.empty(0))
    """(K,) their costs."""


Watch = Callable[[Move], None]


def neighbour_sigma(board: Board) -> Array:
    """(6,) standard deviations of a neighbour in `anneal`; the paper gives none.

    10 degrees for an angle and a tenth of the board's width for each direction. The seventy steps
    are nearly a random walk (T is large against the steps of the cost), so wider ones mostly carry
    the pose away from the good start that it was given.
    """
    w = board.width
    return np.array([10.0, 10.0, 10.0, 0.1 * w, 0.1 * w, 0.1 * w])


def anneal(
    space: Space,
    cost: CostFunction,
    start: ArrayLike,
    rng: np.random.Generator,
    *,
    temperature: float = 1.0,
    end_temperature: float = 0.1,
    cooling: float = 0.7,
    tries: int = 10,
    sigma: ArrayLike | None = None,
    keep_best: bool = False,
    stop: Stop | None = None,
    on_move: Watch | None = None,
) -> Found:
    """Algorithm 1: simulated annealing from `start` (6,), a pose of the space.

    A neighbour changes one element, drawn at random, by a Gaussian around its present value
    (`neighbour_sigma`); one outside the space is drawn again. A cheaper neighbour is always taken,
    another with probability exp(-dE / T), eq. (12). With the defaults T falls from 1 to 0.1 in
    seven rounds of ten neighbours.

    As printed the pose returned is the last one taken. `keep_best` returns the best one met.
    """
    spread = neighbour_sigma(space.board) if sigma is None else np.asarray(sigma, np.float64)
    now = np.asarray(start, dtype=np.float64).copy()
    now_cost = float(cost(now[None])[0])
    best, best_cost, evaluated = now, now_cost, 1
    stopped = False
    while temperature > end_temperature and not stopped:
        for _ in range(tries):
            stopped = stop is not None and stop()
            if stopped:
                break
            candidate = _neighbour(space, now, spread, rng)
            if candidate is None:
                continue
            value = float(cost(candidate[None])[0])
            evaluated += 1
            rise = value - now_cost
            accepted = rise < 0 or bool(rng.random() < np.exp(-rise / temperature))
            if accepted:
                now, now_cost = candidate, value
            if value < best_cost:
                best, best_cost = candidate, value
            if on_move is not None:
                on_move(Move(candidate, value, accepted, best, best_cost, evaluated))
        temperature *= cooling
    if keep_best or stopped:
        return Found(best, best_cost, evaluated, stopped)
    return Found(now, now_cost, evaluated, stopped)


def search_globally(
    space: Space,
    cost: CostFunction,
    rng: np.random.Generator,
    *,
    samples: int = 500,
    rounds: int = 12,
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
    vectors = _samples(space, samples, rng)
    costs = _costs_in_parts(cost, vectors, stop)
    evaluated = costs.size
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
        shown, shown_cost = around[int(np.argmin(values))], float(values.min())
        pool, costs = _cheapest(
            np.concatenate([pool, around]), np.concatenate([costs, values]), parents
        )
        _report(on_move, space, pool, costs, shown, shown_cost, evaluated)
    return Found(space.from_unit(pool[:1])[0], float(costs[0]), evaluated, stopped)


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


def _neighbour(space: Space, vector: Array, sigma: Array, rng: np.random.Generator) -> Array | None:
    for _ in range(_TRIES):
        element = int(rng.integers(6))
        candidate = vector.copy()
        candidate[element] += sigma[element] * rng.standard_normal()
        if space.accepts(candidate)[0]:
            return candidate
    return None

"""Algorithm 1 of the paper: simulated annealing from a given pose, as printed."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.costs import CostFunction
from venus3d.engine.planning.elites import Elites
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, SearchStep, Stop

ROUNDS = 7
"""Number of temperatures from 1 to 0.1 with a factor of 0.7."""
_TRIES = 50  # draws for one neighbour within the space


def neighbour_sigma(board: Board) -> Array:
    """(6,) standard deviations of a neighbour in `anneal`; the paper gives none.

    10 degrees for an angle and a tenth of the board's width for each direction. The seventy steps
    are nearly a random walk (T is large compared with the changes in cost), so wider ones mostly
    leave the good start pose.
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
    on_step: OnSearchStep | None = None,
) -> SearchResult:
    """Algorithm 1: simulated annealing from `start` (6,), a pose of the space.

    A neighbour changes one random element by a Gaussian (`neighbour_sigma`) and is redrawn while
    outside the space. A cheaper one is always accepted, another with probability exp(-dE / T),
    eq. (12). By default T falls from 1 to 0.1 in seven rounds of ten neighbours.

    As printed, the last accepted pose is returned; with `keep_best`, the best one met.
    """
    spread = neighbour_sigma(space.board) if sigma is None else np.asarray(sigma, np.float64)
    now = np.asarray(start, dtype=np.float64).copy()
    now_cost = float(cost(now[None])[0])
    elites = Elites(space)
    elites.add(now[None], np.array([now_cost]))
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
            elites.add(candidate[None], np.array([value]))
            rise = value - now_cost
            accepted = rise < 0 or bool(rng.random() < np.exp(-rise / temperature))
            if accepted:
                now, now_cost = candidate, value
            if on_step is not None:
                on_step(
                    SearchStep(
                        candidate, value, accepted, elites.best, elites.best_cost, elites.evaluated
                    )
                )
        temperature *= cooling
    found = elites.found(stopped)
    if keep_best or stopped:
        return found
    return SearchResult(now, now_cost, found.evaluated, stopped, found.elites, found.elite_costs)


def _neighbour(space: Space, vector: Array, sigma: Array, rng: np.random.Generator) -> Array | None:
    for _ in range(_TRIES):
        element = int(rng.integers(6))
        candidate = vector.copy()
        candidate[element] += sigma[element] * rng.standard_normal()
        if space.accepts(candidate)[0]:
            return candidate
    return None

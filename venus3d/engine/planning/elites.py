"""The good poses of a search: the best of each neighbourhood, not copies of one."""

from __future__ import annotations

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.search_trace import SearchResult

KEPT = 48
"""Number of neighbourhoods whose best poses are returned."""
NEAR = 0.05
"""Poses within this largest difference in the unit cube are neighbours: 7 degrees about an axis, a
twentieth of the image, a tenth of the distance."""
_BASE = 1000  # exceeds the number of cells along an axis
_LOOKED_AT = 8 * KEPT


class Elites:
    """Collects the poses whose costs were computed. Used within one search."""

    def __init__(self, space: Space) -> None:
        self._space = space
        self._vectors: list[Array] = []
        self._costs: list[Array] = []
        self.evaluated = 0
        """Costs computed so far."""
        self.best = np.full(6, np.nan)
        """(6,) the cheapest pose so far."""
        self.best_cost = float("inf")
        self.first_cost = float("nan")
        """Cost of the first pose added."""

    def add(self, vectors: Array, costs: Array) -> None:
        """Poses (N, 6) of the space with their costs (N,)."""
        if not self._costs:
            self.first_cost = float(costs[0])
        self._vectors.append(vectors)
        self._costs.append(costs)
        self.evaluated += len(costs)
        cheapest = int(np.argmin(costs))
        if costs[cheapest] < self.best_cost:
            self.best, self.best_cost = vectors[cheapest], float(costs[cheapest])

    def found(self, stopped: bool) -> SearchResult:
        """The search's result: its best pose, and the best of each neighbourhood."""
        vectors, costs = np.concatenate(self._vectors), np.concatenate(self._costs)
        order = np.argsort(costs, kind="stable")
        unit = self._space.to_unit(vectors[order])
        # Reduce to the best of each grid cell first, which removes most quickly.
        cells = np.floor(unit / NEAR).astype(np.int64) @ _BASE ** np.arange(6)
        best = np.sort(np.unique(cells, return_index=True)[1])[:_LOOKED_AT]
        chosen = order[best[_apart(unit[best])]]
        return SearchResult(
            self.best, self.best_cost, self.evaluated, stopped, vectors[chosen], costs[chosen]
        )


def _apart(unit: Array) -> list[int]:
    """Indices of the points (N, 6), cheapest first, that are the best of their neighbourhoods."""
    kept: list[int] = []
    left = np.arange(len(unit))
    while len(kept) < KEPT and left.size:
        first = int(left[0])
        kept.append(first)
        left = left[np.abs(unit[left] - unit[first]).max(axis=1) > NEAR]
    return kept

"""A search in progress, the steps that it reports, and its result. The searches are in `search`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.pose_space import Space

KEPT = 48
"""Number of neighbourhoods whose best poses are returned."""
NEAR = 0.05
"""Poses within this largest difference in the unit cube are neighbours: 7 degrees about an axis, a
twentieth of the image, a tenth of the distance."""
_BASE = 1000  # exceeds the number of cells along an axis
_LOOKED_AT = 8 * KEPT

Stop = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class SearchStep:
    """One step of a search, for observers."""

    vector: Array
    """(6,) the pose evaluated."""
    cost: float
    accepted: bool
    """Whether the search continued from it."""
    best_vector: Array
    """(6,) the cheapest pose so far."""
    best_cost: float
    evaluated: int
    """Costs computed so far."""
    candidates: Array = field(default_factory=lambda: np.empty((0, 6)))
    """(N, 6) all poses of the batch of which this is the best; empty for a single pose."""
    candidate_costs: Array = field(default_factory=lambda: np.empty(0))
    """(N,) their costs."""


@dataclass(frozen=True, eq=False)
class SearchTrace:
    """The recorded steps of a whole search."""

    steps: tuple[SearchStep, ...]
    """In order; only the first ones if there were very many."""
    end: Array
    """(6,) the resulting pose."""

    @property
    def is_batched(self) -> bool:
        """Whether each step stands for a batch of poses."""
        return any(len(step.candidates) > 0 for step in self.steps)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The result of a search."""

    vector: Array
    """(6,) pose vector."""
    cost: float
    evaluated: int
    """Costs computed."""
    stopped: bool
    """Whether it was stopped early."""
    elites: Array = field(default_factory=lambda: np.empty((0, 6)))
    """(K, 6) the good poses found, cheapest first, including the best; empty if none were kept."""
    elite_costs: Array = field(default_factory=lambda: np.empty(0))
    """(K,) their costs."""


OnSearchStep = Callable[[SearchStep], None]


class SearchRecorder:
    """Records the steps of a search, without copying them. Used within one search."""

    AT_MOST = 6000
    """Poses kept, to limit the memory: a third of a megabyte."""

    def __init__(self, watch: OnSearchStep | None = None) -> None:
        """`watch` is called with every step as well."""
        self._watch, self._steps, self._poses = watch, list[SearchStep](), 0

    def __call__(self, step: SearchStep) -> None:
        poses = max(1, len(step.candidates))
        if self._poses + poses <= self.AT_MOST:
            self._steps.append(step)
            self._poses += poses
        if self._watch is not None:
            self._watch(step)

    def trace(self, end: Array) -> SearchTrace | None:
        """The search that ended with the pose vector `end` (6,); None if there was no step."""
        return SearchTrace(tuple(self._steps), end) if self._steps else None


class SearchRun:
    """Counts, keeps and reports the poses whose costs a search has computed."""

    def __init__(self, space: Space, stop: Stop | None, on_step: OnSearchStep | None) -> None:
        self.space = space
        self._stop, self._on_step, self._stopped = stop, on_step, False
        self._vectors: list[Array] = []
        self._costs: list[Array] = []
        self.evaluated = 0
        self._best, self._best_cost = np.full(6, np.nan), float("inf")

    def is_stopped(self) -> bool:
        """Whether the search shall end, or was stopped before."""
        self._stopped = self._stopped or (self._stop is not None and self._stop())
        return self._stopped

    def add(self, vectors: Array, costs: Array) -> bool:
        """Poses (N, 6) of the space with their costs (N,); whether one is the cheapest so far."""
        self._vectors.append(vectors)
        self._costs.append(costs)
        self.evaluated += len(costs)
        cheapest = int(np.argmin(costs))
        better = bool(costs[cheapest] < self._best_cost)
        if better:
            self._best, self._best_cost = vectors[cheapest], float(costs[cheapest])
        return better

    def report(self, vectors: Array, costs: Array, accepted: bool, *, batch: bool = False) -> None:
        """Report the best of the poses just added; with all of them, if they are a `batch`."""
        if self._on_step is None:
            return
        i = int(np.argmin(costs))
        all_of_them = (vectors, costs) if batch else ()
        so_far = self._best, self._best_cost, self.evaluated
        self._on_step(SearchStep(vectors[i], float(costs[i]), accepted, *so_far, *all_of_them))

    def found(self) -> SearchResult:
        """The search's result: its best pose, and the best of each neighbourhood."""
        vectors, costs = np.concatenate(self._vectors), np.concatenate(self._costs)
        order = np.argsort(costs, kind="stable")
        unit = self.space.to_unit(vectors[order])
        # Reduce to the best of each grid cell first, which removes most quickly.
        cells = np.floor(unit / NEAR).astype(np.int64) @ _BASE ** np.arange(6)
        best = np.sort(np.unique(cells, return_index=True)[1])[:_LOOKED_AT]
        chosen = order[best[_apart(unit[best])]]
        best_of_all = self._best, self._best_cost, self.evaluated, self._stopped
        return SearchResult(*best_of_all, vectors[chosen], costs[chosen])


def _apart(unit: Array) -> list[int]:
    """Indices of the points (N, 6), cheapest first, that are the best of their neighbourhoods."""
    kept: list[int] = []
    left = np.arange(len(unit))
    while len(kept) < KEPT and left.size:
        first = int(left[0])
        kept.append(first)
        left = left[np.abs(unit[left] - unit[first]).max(axis=1) > NEAR]
    return kept

"""The steps that a search reports and its result. The searches are in `search`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.geometry.pose import Array

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

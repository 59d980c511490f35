"""What a search reports while it runs and what it ends with. The searches are in `search`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.geometry.pose import Array

Stop = Callable[[], bool]


@dataclass(frozen=True, eq=False)
class SearchStep:
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
    candidates: Array = field(default_factory=lambda: np.empty((0, 6)))
    """(N, 6) all poses of the batch that this is the best of; empty if it was looked at alone."""
    candidate_costs: Array = field(default_factory=lambda: np.empty(0))
    """(N,) their costs."""


@dataclass(frozen=True, eq=False)
class SearchTrace:
    """A whole search as it went, to be watched afterwards."""

    steps: tuple[SearchStep, ...]
    """In order; the first ones only, if there were very many."""
    end: Array
    """(6,) the pose that the search ended with."""

    @property
    def is_batched(self) -> bool:
        """Whether each step stands for a batch of poses."""
        return any(len(step.candidates) > 0 for step in self.steps)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """What a search ended with."""

    vector: Array
    """(6,) pose vector."""
    cost: float
    evaluated: int
    """Costs computed."""
    stopped: bool
    """Whether it was stopped before its end."""
    elites: Array = field(default_factory=lambda: np.empty((0, 6)))
    """(K, 6) the good poses met, cheapest first, the best included; empty if none were kept."""
    elite_costs: Array = field(default_factory=lambda: np.empty(0))
    """(K,) their costs."""


OnSearchStep = Callable[[SearchStep], None]


class SearchRecorder:
    """Keeps the steps of a search. Used within one search; a step is kept as it is, not copied."""

    AT_MOST = 6000
    """Poses kept, so that no search fills the memory: a third of a megabyte."""

    def __init__(self, watch: OnSearchStep | None = None) -> None:
        """`watch` is called with every step as well."""
        self._watch, self._steps, self._poses = watch, list[SearchStep](), 0

    def __call__(self, step: SearchStep) -> None:
        """Take in one step."""
        poses = max(1, len(step.candidates))
        if self._poses + poses <= self.AT_MOST:
            self._steps.append(step)
            self._poses += poses
        if self._watch is not None:
            self._watch(step)

    def trace(self, end: Array) -> SearchTrace | None:
        """The search that ended with the pose vector `end` (6,); None if there was no step."""
        return SearchTrace(tuple(self._steps), end) if self._steps else None

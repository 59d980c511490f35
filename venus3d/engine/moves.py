"""What a search reports while it runs and what it ends with. The searches are in `search`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.pose import Array

Stop = Callable[[], bool]


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

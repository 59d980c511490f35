"""How the next pose is found: a method with the cost and the search that belong to it.

What makes sense together is decided here, so that a mistake is told before anything starts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from venus3d.engine.errors import VenusError

Method = Literal["random", "pose-selection", "venus", "global"]
METHODS: tuple[Method, ...] = get_args(Method)
Cost = Literal["projection-variance", "max-ere", "trace", "log-det", "sum-iod", "max-iod", "rms"]
COSTS: tuple[Cost, ...] = get_args(Cost)
Strategy = Literal["annealing", "global", "dual-annealing", "differential-evolution"]
STRATEGIES: tuple[Strategy, ...] = get_args(Strategy)
Start = Literal["generated", "random"]
DEFAULT_COST: dict[Method, Cost] = {
    "random": "projection-variance",
    "pose-selection": "projection-variance",
    "venus": "sum-iod",
    "global": "projection-variance",
}
"""A method's own cost. "random" and "pose-selection" search nothing: it only names what is told."""
DEFAULT_STRATEGY: dict[Method, Strategy] = {"venus": "annealing", "global": "global"}
"""A method's own search."""


@dataclass(frozen=True)
class SearchMethod:
    """How the next pose is found: a method with all that belongs to it. Made by `search_method`."""

    method: Method
    cost: Cost
    strategy: Strategy | None
    """None for the methods that search nothing."""
    start: Start = "generated"
    keep_best: bool = False


def search_method(
    method: Method,
    cost: Cost | None = None,
    strategy: Strategy | None = None,
    *,
    start: Start = "generated",
    keep_best: bool = False,
) -> SearchMethod:
    """The method with its own cost and search where none are named.

    Raises `VenusError` for names that do not exist and for combinations that make no sense.
    """
    for kind, name, names in (
        ("method", method, METHODS),
        ("cost", cost, COSTS),
        ("search", strategy, STRATEGIES),
    ):
        if name is not None and name not in names:
            raise VenusError(f"There is no {kind} {name!r}; use one of {', '.join(names)}.")
    if method not in DEFAULT_STRATEGY:
        # A cost is harmless where it is the default, a misunderstanding elsewhere.
        unused = strategy or (None if cost == DEFAULT_COST[method] else cost)
        if unused is not None:
            raise VenusError(
                f"The method {method} does not search, so the {'search' if strategy else 'cost'} "
                f"{unused} has no use there; leave it out or use the method venus or global."
            )
        return SearchMethod(method, DEFAULT_COST[method], None)
    how = strategy or DEFAULT_STRATEGY[method]
    if cost == "rms" and how != "annealing":
        raise VenusError(
            "The cost rms calibrates anew for every pose and is too slow for the "
            f"{'method global' if method == 'global' else f'search {how}'}; use it with the "
            "method venus and its own search, or use projection-variance."
        )
    return SearchMethod(method, cost or DEFAULT_COST[method], how, start, keep_best)

"""Names of methods, costs and searches, and each method's default cost and search."""

from __future__ import annotations

from typing import Literal, get_args

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
""""random" and "pose-selection" search nothing: theirs names the figure shown."""
DEFAULT_STRATEGY: dict[Method, Strategy] = {"venus": "annealing", "global": "global"}
"""A method's default search."""

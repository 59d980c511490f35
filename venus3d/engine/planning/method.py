"""The names of methods, costs and searches, and which cost and search a method has of its own."""

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
"""A method's own cost. "random" and "pose-selection" search nothing: it names the figure shown."""
DEFAULT_STRATEGY: dict[Method, Strategy] = {"venus": "annealing", "global": "global"}
"""A method's own search."""

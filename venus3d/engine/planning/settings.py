"""Settings for finding the next pose: method, cost, search, noise model, limits.
Invalid combinations are refused when the settings are made."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Literal, get_args

from venus3d.engine.calibration.corner_noise import RENDERED, NoiseModel
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.planning.limits import Limits

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


@dataclass(frozen=True)
class PlanningSettings:
    """Settings for finding the next pose.
    Raises `VenusError` for unknown names and invalid combinations."""

    method: Method = "global"
    cost: Cost | None = None
    """None: the method's default."""
    strategy: Strategy | None = None
    """How the method searches; None: the method's default."""
    start: Start = "generated"
    """Method venus: start at the rule's pose or at a random one."""
    noise: NoiseModel | None = RENDERED
    """How noise and found corners depend on a pose when planning; None: they do not."""
    limits: Mapping[str, float] = field(default_factory=dict[str, float])
    """Fields of `Limits` set by hand; the others suit the board and the camera."""
    keep_best: bool = False
    """Method venus: return the best pose that the annealing met, not the last one."""

    def __post_init__(self) -> None:
        known = [field.name for field in fields(Limits)]
        if not isinstance(self.limits, Mapping) or not set(self.limits) <= set(known):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise VenusError(
                'Give the limits as a dictionary of fields of Limits, such as {"nearest": 0.35}; '
                f"they are {', '.join(known)}."
            )
        for kind, name, names in (
            ("method", self.method, METHODS),
            ("cost", self.cost, COSTS),
            ("search", self.strategy, STRATEGIES),
        ):
            if name is not None and name not in names:
                raise VenusError(f"There is no {kind} {name!r}; use one of {', '.join(names)}.")
        if self.method not in DEFAULT_STRATEGY:
            # A redundant default cost is harmless; any other is a misunderstanding.
            own = self.cost == DEFAULT_COST[self.method]
            unused = self.strategy or (None if own else self.cost)
            if unused is not None:
                raise VenusError(
                    f"The method {self.method} does not search, so the "
                    f"{'search' if self.strategy else 'cost'} {unused} has no use there; leave it "
                    "out or use the method venus or global."
                )
        elif self.cost == "rms" and self.search_strategy != "annealing":
            slow = "method global" if self.method == "global" else f"search {self.strategy}"
            raise VenusError(
                f"The cost rms calibrates anew for every pose and is too slow for the {slow}; use "
                "it with the method venus and its own search, or use projection-variance."
            )

    @property
    def search_cost(self) -> Cost:
        """The cost used: `cost`, or the method's default."""
        return self.cost or DEFAULT_COST[self.method]

    @property
    def search_strategy(self) -> Strategy | None:
        """The search used: `strategy`, or the method's default; None: no search."""
        return self.strategy or DEFAULT_STRATEGY.get(self.method)

    def limits_for(self, board: Board, camera: Camera) -> Limits:
        """The limits for the board and the camera, with those set by hand."""
        return replace(Limits.for_board(board, camera), **self.limits)

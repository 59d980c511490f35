"""How a session is run: everything a person or a study may choose, with what suits most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from venus3d.engine.calibration.corner_noise import RENDERED, NoiseModel
from venus3d.engine.guidance.convergence import Rule
from venus3d.engine.guidance.matching import Tolerance
from venus3d.engine.planning.method import (
    Cost,
    Method,
    SearchMethod,
    Start,
    Strategy,
    search_method,
)


@dataclass(frozen=True)
class Settings:
    """How a session is run."""

    method: Method = "global"
    cost: Cost | None = None
    """None: the method's own."""
    strategy: Strategy | None = None
    """How the method searches; None: its own way."""
    start: Start = "generated"
    """Method venus: where its search begins, at the rule's pose or at a random one."""
    noise: NoiseModel | None = RENDERED
    """How noise and found corners depend on a pose, when planning; None: they do not."""
    wanted_uncertainty_px: float | None = 0.3
    """The forecast counts the views until the mean projection error is as small; None: none."""
    limits: Mapping[str, float] = field(default_factory=dict[str, float])
    """`Limits`' fields that are set by hand; the rest suit the board and the camera."""
    keep_best: bool = False
    """Method venus: return the best pose that the annealing met, not the one it ends on."""
    seed: int = 0
    max_views: int = 20
    auto_capture: bool = True
    """Capture when the target is reached and held; otherwise only on command."""
    hold_frames: int = 3
    """For how many observations in a row the target must be reached."""
    useful_drop: float | None = None
    """Recordings cannot follow a target: a view that lowers the expected projection error by this
    share is captured wherever it is. None: only the target counts."""
    overlap_needed: float = 0.85
    still_px: float = 2.0
    tolerance: Tolerance = field(default_factory=Tolerance)
    epsilon: float = 0.1
    rule: Rule = "repaired"

    @property
    def way(self) -> SearchMethod:
        """How the next pose is found. Raises `VenusError` for what does not go together."""
        return search_method(
            self.method, self.cost, self.strategy, start=self.start, keep_best=self.keep_best
        )

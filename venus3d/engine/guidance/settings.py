"""Settings of a session: the choices of a user or a study, with defaults that suit most."""

from __future__ import annotations

from dataclasses import dataclass, field

from venus3d.engine.guidance.convergence import Rule
from venus3d.engine.guidance.matching import Tolerance
from venus3d.engine.planning.settings import PlanningSettings


@dataclass(frozen=True)
class Settings(PlanningSettings):
    """Settings of a session: how it plans, when it captures and when it ends."""

    wanted_uncertainty_px: float | None = 0.3
    """Projection uncertainty up to which the forecast counts views; None: no forecast."""
    lens: str = "auto"
    """Name of a lens model; "auto": the simplest that predicts the views as well as any."""
    seed: int = 0
    max_views: int = 20
    auto_capture: bool = True
    """Capture when the target is reached and held; otherwise only on request."""
    hold_frames: int = 3
    """Consecutive observations in which the target must be reached."""
    useful_drop: float | None = None
    """For recordings, which cannot follow a target: a view that lowers the projection uncertainty
    by this share is captured wherever it is. None: only the target counts."""
    overlap_needed: float = 0.85
    still_px: float = 2.0
    tolerance: Tolerance = field(default_factory=Tolerance)
    epsilon: float = 0.1
    rule: Rule = "repaired"

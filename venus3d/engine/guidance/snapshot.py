"""The state of a guided calibration after one observation, as frozen values.

Nothing in here computes; the session fills it, the scene and the storage read it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation, View
from venus3d.engine.calibration.result import Calibration
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.convergence import Convergence, Progress
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.phase import Phase
from venus3d.engine.guidance.prompts import Prompt
from venus3d.engine.planning.forecast import Forecast
from venus3d.engine.planning.method import Cost, Method
from venus3d.engine.planning.search_trace import SearchTrace
from venus3d.engine.planning.target import Target
from venus3d.engine.planning.uncertainty import ProjectionUncertainty


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Everything about one moment of a guided calibration."""

    number: int
    """Counts every observation."""
    phase: Phase
    board: Board
    camera: Camera
    """The best camera known: a guess, the start-up estimate, or the calibration's."""
    observation: Observation
    pose: Pose | None
    """The board as it is estimated now; None while it is not seen."""
    target: Target | None
    match: Match | None
    calibration: Calibration | None
    convergence: Convergence | None
    history: tuple[Progress, ...]
    headline: str
    """Two or three words for the state: "Hold still", "Captured", "Step 3 of 4"."""
    instruction: Prompt
    """The one sentence that says what to do now."""
    warnings: tuple[str, ...] = field(default=())
    diagnoses: tuple[Diagnosis, ...] = field(default=())
    """What makes this calibration less trustworthy than its numbers; worst first."""
    forecast: Forecast | None = None
    """None while nothing can be said."""
    method: Method = "global"
    """How the next poses are found."""
    cost: Cost = "projection-variance"
    """What the search for them makes small."""
    uncertainty: ProjectionUncertainty | None = None
    """Of the present calibration; None while it does not estimate all nine parameters."""
    search_trace: SearchTrace | None = None
    """How the present target was searched; None if it was not."""

    @property
    def views(self) -> tuple[View, ...]:
        """The captured views."""
        return () if self.calibration is None else self.calibration.views

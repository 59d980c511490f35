"""The state of a guided calibration after one observation, as frozen values.
The session fills it; scene and storage read it."""

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
    """A guided calibration at one moment."""

    number: int
    """Counts every observation."""
    phase: Phase
    board: Board
    camera: Camera
    """The best camera known: a guess, the start-up estimate, or the calibration's."""
    observation: Observation
    pose: Pose | None
    """The board's current estimated pose; None while it is not seen."""
    target: Target | None
    match: Match | None
    calibration: Calibration | None
    convergence: Convergence | None
    history: tuple[Progress, ...]
    headline: str
    """Two or three words for the state: "Hold still", "Captured", "Step 3 of 4"."""
    instruction: Prompt
    """The one instruction to follow now."""
    warnings: tuple[str, ...] = field(default=())
    diagnoses: tuple[Diagnosis, ...] = field(default=())
    """Reasons why the calibration is less trustworthy than its numbers; worst first."""
    forecast: Forecast | None = None
    """None while unknown."""
    method: Method = "global"
    """How the next poses are found."""
    cost: Cost = "projection-variance"
    """The cost that their search minimises."""
    uncertainty: ProjectionUncertainty | None = None
    """Of the current calibration; None while not all nine parameters are estimated."""
    search_trace: SearchTrace | None = None
    """The search of the current target; None if there was none."""

    @property
    def views(self) -> tuple[View, ...]:
        """The captured views."""
        return () if self.calibration is None else self.calibration.views

"""View models of the exercise pages, and the requests a person can make; no computation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.exercise import Attempt
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.storage.exercise import ExerciseRow

Help = Literal["steps", "axes", "outline", "none"]
"""steps: one degree of freedom at a time (the paper). axes: the board's and the target's axes
(Rojtberg 2018). outline: the target's filled silhouette (AprilCal). none: only a picture taken at
the target; for practice."""
PRACTICE_HELPS: tuple[Help, ...] = get_args(Help)
TRIAL_HELPS: tuple[Help, ...] = PRACTICE_HELPS[:3]
Stage = Literal["ready", "aim", "hold", "reached", "over"]
"""ready: no target yet. aim: bring the board there. hold: it is there and must stay. reached: it
stayed; the next target waits for a request. over: no more targets."""
ViewSide = Literal["outside", "through"]
"""Whether the scene is seen from outside or through the camera."""
Mover = Literal["keys", "gizmo", "sliders", "picture"]
"""What moved a board; picture: the board was dragged itself, in either view."""
Action = Literal["next", "give_up", "start_over", "view", "surroundings", "theme", "autopilot"]
"""Requests without a value."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ExerciseView:
    """View model common to both pages."""

    camera: Camera
    board: Board
    pose: Pose | None
    """The board's pose; None while it is not seen."""
    target: Pose | None
    match: Match | None
    """None without a board or a target."""
    stage: Stage
    help: Help
    dark: bool
    seconds: float
    """Clock of this pose (practice) or of this help (trial)."""
    rows: tuple[ExerciseRow, ...]
    """All poses finished since the exercise was opened."""
    written: str
    """The file they are written to."""
    note: str
    """A remark beside the text."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PracticeViewModel(ExerciseView):
    """One trainee's view model."""

    pose: Pose
    target: Pose
    match: Match
    attempt: Attempt
    """The board's moves so far, and which numbers may change."""
    level: int
    auto_level: bool
    """Whether the next level follows automatically."""
    side: ViewSide
    surroundings: bool
    """Whether the floor and the figure who holds the board are drawn."""
    last_mover: Mover | None


@dataclass(frozen=True, eq=False, kw_only=True)
class TrialViewModel(ExerciseView):
    """One participant's view model."""

    participant: str
    order: tuple[Help, ...]
    """The helps in this participant's order, including those finished earlier."""
    place: int
    """1 ...: position in `order` of the help shown, or next."""
    number: int
    """1 ... `poses`: number of the current pose."""
    poses: int
    step: int
    """1 ... 4: the board's current step, or its last one when it was seen."""
    autopilot: bool
    """Whether the simulated hand moves the board."""
    snapshot: Snapshot
    """The same as a guided calibration would show it."""

    @property
    def is_running(self) -> bool:
        """Whether a pose is being asked for."""
        return self.stage in ("aim", "hold")


@dataclass(frozen=True, eq=False)
class MoveBoard:
    """The board was moved to this pose."""

    pose: Pose
    by: Mover
    grabbed: Pose | None = None
    """Its pose when it was grabbed, if it is being dragged."""


@dataclass(frozen=True)
class Nudge:
    """Change one of the pose's six numbers a little."""

    number: int
    """0 ... 5: xr, yr, zr, xt, yt, zt."""
    sign: int


@dataclass(frozen=True)
class ChooseLevel:
    """Go to this level."""

    level: int


@dataclass(frozen=True)
class ChooseHelp:
    """Practise with this help; None: the next one."""

    help: Help | None


@dataclass(frozen=True)
class SetAutoLevel:
    """Whether the next level follows automatically."""

    on: bool


@dataclass(frozen=True)
class Rename:
    """Set the trainee's name."""

    name: str


@dataclass(frozen=True)
class Press:
    """A button without a value, or its key."""

    action: Action


Request = MoveBoard | Nudge | ChooseLevel | ChooseHelp | SetAutoLevel | Rename | Press

"""What the page of an exercise shows at one time, and what a person can ask for on it.

Nothing in here computes: an `Exercise` fills the view models and carries out the requests.
"""

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
"""steps: one degree of freedom at a time (the paper). axes: the board's axes and the target's
(Rojtberg 2018). outline: the target's filled silhouette (AprilCal). none: nothing but a picture
taken at the target; for practice only."""
PRACTICE_HELPS: tuple[Help, ...] = get_args(Help)
TRIAL_HELPS: tuple[Help, ...] = PRACTICE_HELPS[:3]
Stage = Literal["ready", "aim", "hold", "reached", "over"]
"""ready: no target is shown yet. aim: bring the board there. hold: it is there and must stay.
reached: it stayed, and the next target waits to be asked for. over: there are no more targets."""
ViewSide = Literal["outside", "through"]
"""The scene is seen from outside, or through the camera."""
Mover = Literal["keys", "gizmo", "sliders", "picture"]
"""What a board was moved with; picture: dragged by itself, in whichever view."""
Action = Literal["next", "give_up", "start_over", "view", "theme", "autopilot"]
"""What a button or a key without a value asks for."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ExerciseView:
    """What the pages of both exercises show."""

    camera: Camera
    board: Board
    pose: Pose | None
    """Of the board now; None while it is not seen."""
    target: Pose | None
    match: Match | None
    """None without a board or a target."""
    stage: Stage
    help: Help
    dark: bool
    seconds: float
    """On the clock of this pose (practice) or of this help (trial)."""
    rows: tuple[ExerciseRow, ...]
    """All poses that were done with since the exercise was opened."""
    written: str
    """The file that they are in."""
    note: str
    """What is said beside."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PracticeViewModel(ExerciseView):
    """Where one trainee stands."""

    pose: Pose
    target: Pose
    match: Match
    attempt: Attempt
    """How the board has been moved so far, and which numbers may be moved."""
    level: int
    auto_level: bool
    """Whether the next level comes by itself."""
    side: ViewSide
    last_mover: Mover | None


@dataclass(frozen=True, eq=False, kw_only=True)
class TrialViewModel(ExerciseView):
    """Where one participant's trial stands."""

    participant: str
    order: tuple[Help, ...]
    """The helps in this participant's order; those done in an earlier run among them."""
    place: int
    """1 ...: which of `order` is shown, or comes next."""
    number: int
    """1 ... `poses`: which pose is asked for."""
    poses: int
    step: int
    """1 ... 4: which of the four steps the board is on, or was when it was seen last."""
    autopilot: bool
    """Whether the simulated hand has the board."""
    snapshot: Snapshot
    """The same as a guided calibration would show it."""

    @property
    def is_running(self) -> bool:
        """Whether a pose is asked for."""
        return self.stage in ("aim", "hold")


@dataclass(frozen=True, eq=False)
class MoveBoard:
    """The board was brought to this pose."""

    pose: Pose
    by: Mover


@dataclass(frozen=True)
class Nudge:
    """One of the six numbers of the pose a little up or down."""

    number: int
    """0 ... 5: xr, yr, zr, xt, yt, zt."""
    sign: int


@dataclass(frozen=True)
class ChooseLevel:
    """Go to this level."""

    level: int


@dataclass(frozen=True)
class ChooseHelp:
    """Practise with this help; None: with the next one."""

    help: Help | None


@dataclass(frozen=True)
class SetAutoLevel:
    """Whether the next level comes by itself."""

    on: bool


@dataclass(frozen=True)
class Rename:
    """The trainee's name."""

    name: str


@dataclass(frozen=True)
class Press:
    """A button without a value, or its key."""

    action: Action


Request = MoveBoard | Nudge | ChooseLevel | ChooseHelp | SetAutoLevel | Rename | Press

"""What a practice page shows of one moment, and what a trainee can ask of it.

Nothing in here computes; the app fills a moment and obeys the wishes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.exercise import Free, Score
from venus3d.engine.guidance.matching import Match

PracticeHelp = Literal["steps", "axes", "outline", "none"]
"""steps: one degree of freedom at a time, in words and arrows. axes: the board's axes and the
target's. outline: the target's silhouette. none: nothing but a picture taken at the target."""
PRACTICE_HELPS: tuple[PracticeHelp, ...] = ("steps", "axes", "outline", "none")
Stage = Literal["aim", "hold", "reached"]
"""aim: bring the board there. hold: it is there and must stay. reached: it stayed."""
Look = Literal["outside", "through"]
Mover = Literal["keys", "gizmo", "sliders", "picture"]
"""What a board was moved with; picture: dragged by itself, in whichever view."""


@dataclass(frozen=True, eq=False)
class PracticeMoment:
    """Where one trainee stands."""

    camera: Camera
    board: Board
    pose: Pose
    target: Pose
    free: Free
    match: Match
    stage: Stage
    level: int
    help: PracticeHelp
    climb: bool
    """Whether the next level comes by itself."""
    look: Look
    dark: bool
    seconds: float
    """Since the first move."""
    path_mm: float
    shortest_mm: float
    path_deg: float
    shortest_deg: float
    scores: tuple[Score, ...]
    """All poses of this trainee since the page was opened."""
    note: str = ""
    written: str = ""
    """The file that the scores are in."""
    last_mover: Mover | None = None


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

    help: PracticeHelp | None


@dataclass(frozen=True)
class Climb:
    """Whether the next level comes by itself."""

    on: bool


@dataclass(frozen=True)
class Rename:
    """The trainee's name."""

    name: str


@dataclass(frozen=True)
class Press:
    """A button without a value."""

    what: Literal["next", "give_up", "again", "look", "light"]


Wish = MoveBoard | Nudge | ChooseLevel | ChooseHelp | Climb | Rename | Press

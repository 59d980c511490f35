"""Intents: what a person asks for in the browser, by button, key or command. Each updates the
page's state (`ViewState.after`) and is queued for the guidance loop, which carries out those for
the session or the source."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import Literal

from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.settings import Cost, Method
from venus3d.sources.camera_settings import SettingName


class PageAction(Enum):
    """Intents without a value."""

    CAPTURE = auto()
    """Capture the current view, matched or not."""
    SKIP_TARGET = auto()
    """Ask for another target."""
    UNDO_VIEW = auto()
    """Remove the last captured view."""
    FINISH = auto()
    """Ask whether to end the calibration; once asked, end it."""
    END_NOW = auto()
    """End the calibration and keep the result."""
    GO_ON = auto()
    """Do not end it, or go on after the end, with all views."""
    NEW_SESSION = auto()
    """Begin a new calibration; the result of this one stays in its files."""


@dataclass(frozen=True)
class DropView:
    """Exclude one captured view from the calibration."""

    number: int
    """The view's number, as in `View.number`."""


@dataclass(frozen=True)
class ChangeMethod:
    """Change how the next poses are found."""

    method: Method
    cost: Cost | None = None
    """None: the method's default."""


@dataclass(frozen=True)
class ChooseAlternative:
    """Choose one of the nearly equal targets."""

    index: int
    """Into the target's `alternatives`."""
    target: int
    """Number of their target, which may have changed meanwhile; 0: none was offered."""


@dataclass(frozen=True)
class Straighten:
    """Show this much of the live picture without lens distortion, once the calibration is over."""

    share: float
    """0 ... 1: of the picture's width, from the left."""


Option = Literal[
    "playing",
    "follow",
    "strip",
    "all_steps",
    "surroundings",
    "dark",
    "paused",
    "autopilot",
    "camera_words",
    "built",
    "straight",
    "explain",
]
"""What can be switched, as in `ViewState`."""


@dataclass(frozen=True)
class Toggle:
    """Toggle an option; `Viewer.state` has its new value."""

    option: Option


@dataclass(frozen=True)
class TurnStep:
    """Show another step."""

    by: int
    """1: the next one, -1: the one before."""


@dataclass(frozen=True, eq=False)
class DragBoard:
    """The simulated board was dragged in the scene."""

    pose: Pose
    """`T_camera_board`."""


@dataclass(frozen=True)
class NudgeBoard:
    """Move the simulated board a little."""

    number: int
    """Index of the pose vector's number, 0 ... 5."""
    sign: int
    """1 or -1."""


@dataclass(frozen=True)
class SetCamera:
    """Set one of the camera's settings."""

    name: SettingName
    wanted: str
    """A number of the driver's, `auto` or `lock`."""


Intent = (
    PageAction
    | DropView
    | ChangeMethod
    | ChooseAlternative
    | Straighten
    | Toggle
    | TurnStep
    | DragBoard
    | NudgeBoard
    | SetCamera
)

"""What a person asks for in the browser, by button, key or command.

The page's state follows each of them (`ViewState.after`), then they are queued for the guidance
loop, which obeys those that are the session's or the source's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.method import Cost, Method


@dataclass(frozen=True)
class Capture:
    """Take the present view, matched or not."""


@dataclass(frozen=True)
class SkipTarget:
    """Ask for another target."""


@dataclass(frozen=True)
class UndoView:
    """Take back the last captured view."""


@dataclass(frozen=True)
class DropView:
    """Leave one captured view out of the calibration."""

    number: int
    """The view's number, as in `View.number`."""


@dataclass(frozen=True)
class ChangeMethod:
    """Find the next poses in another way."""

    method: Method
    cost: Cost | None = None
    """None: the method's own."""


@dataclass(frozen=True)
class ChooseAlternative:
    """Take another of the nearly equal targets."""

    index: int
    """Into the target's `alternatives`."""
    target: int
    """Number of the target that they belong to: meanwhile there may be another."""


@dataclass(frozen=True)
class Finish:
    """End the calibration and keep what is known."""


Option = Literal["playing", "follow", "strip", "dark", "paused", "autopilot"]
"""What can be switched, as in `ViewState`."""


@dataclass(frozen=True)
class Toggle:
    """Switch an option on or off; `Viewer.state` says which it is then."""

    option: Option


@dataclass(frozen=True)
class TurnStep:
    """Look at another step."""

    by: int
    """1: the next one, -1: the one before."""


@dataclass(frozen=True, eq=False)
class DragBoard:
    """The simulated board was dragged in the scene."""

    pose: Pose
    """`T_camera_board`."""


Intent = (
    Capture
    | SkipTarget
    | UndoView
    | DropView
    | ChangeMethod
    | ChooseAlternative
    | Finish
    | Toggle
    | TurnStep
    | DragBoard
)

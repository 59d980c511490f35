"""What a session tells whoever keeps it, and what it can go on from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.guidance.known_camera import KnownCamera
from venus3d.engine.guidance.views import CapturedView, Keeping
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.settings import Cost, Method


@dataclass(frozen=True, eq=False)
class SessionState:
    """All that the next target depends on, beside the settings that do not change."""

    board: Board
    views: tuple[CapturedView, ...]
    next_view: int
    """Number of the next view."""
    next_target: int
    history: tuple[Progress, ...]
    """The calibrations before the last view."""
    heuristic_state: HeuristicState
    skipped: tuple[Pose, ...]
    start: Camera
    """The start-up's estimate."""
    keep_going: bool
    run: int
    method: Method
    cost: Cost | None
    known: KnownCamera | None = None
    """The camera that it began with, if one was known."""


class Recorder(Protocol):
    """Keeps a session while it goes on, in the order in which it is called. Called on the session's
    thread, which does not wait for a disk."""

    def captured(self, view: CapturedView) -> Keeping:
        """Begin to keep a view, with its image; the session counts it once it is kept."""
        ...

    def changed(self, state: SessionState) -> None:
        """The views or what is planned with them have changed. Must not raise."""
        ...


class _Kept:
    def done(self) -> bool:
        return True

    def result(self) -> None:
        pass


class NoRecorder:
    """Keeps nothing."""

    def captured(self, view: CapturedView) -> Keeping:
        """Nothing is left to do."""
        return _Kept()

    def changed(self, state: SessionState) -> None:
        """Nothing."""

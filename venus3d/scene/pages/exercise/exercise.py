"""An exercise as a plain state machine: bring a board to a target under a help, hold it, be timed.

    ready --next--> aim <--> hold --held--> reached --next--> aim ...       practice
    ready --next--> aim <--> hold --held--> aim ... ready (next help) ... over    trial

Knows no page and no file; times are handed in. `Practice` and `Trial` say which target comes next,
when a pose is held, and what is written of it. Used by one thread.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Generic, TypeVar

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.scene.pages.exercise.view_model import ExerciseView, Press, Request, Stage
from venus3d.storage.exercise import GIVEN_UP, REACHED, ExerciseRow, Outcome

View = TypeVar("View", bound=ExerciseView)


class Exercise(ABC, Generic[View]):
    """One target after the other, for one person."""

    def __init__(
        self, camera: Camera, board: Board, written: str, record: Callable[[ExerciseRow], None]
    ) -> None:
        """
        Args:
            written: where the times are, for the screen.
            record: is given each pose as soon as it is done with.
        """
        self.camera, self.board = camera, board
        self._written, self._record = written, record
        self.stage: Stage = "ready"
        self.rows: list[ExerciseRow] = []
        """All poses that were done with."""
        self._now_s = 0.0
        self._dark = True

    def begin(self) -> bool:
        """Show the next target. False if none waits for that."""
        if self.stage not in ("ready", "reached"):
            return False
        self.stage = "aim"
        self._aim()
        return True

    def give_up(self) -> bool:
        """Leave the target that is shown for the next one. False if none is shown."""
        if self.stage not in ("aim", "hold"):
            return False
        self._finish(GIVEN_UP)
        return True

    def handle(self, request: Request) -> None:
        """Do what a person asked for."""
        match request:
            case Press("next"):
                self.begin()
            case Press("give_up"):
                self.give_up()
            case Press("theme"):
                self._dark = not self._dark
            case _:
                pass

    def tick(self, now_s: float) -> bool:
        """Let time pass, for those whose clock is not that of the frames; whether the view has
        changed by itself."""
        return False

    @abstractmethod
    def view(self) -> View:
        """What there is to be seen now."""

    @abstractmethod
    def _aim(self) -> None:
        """Take the next target; the stage is "aim"."""

    @abstractmethod
    def _row_of(self, outcome: Outcome) -> ExerciseRow:
        """How the present target went."""

    @abstractmethod
    def _stage_after(self, outcome: Outcome) -> Stage:
        """What follows it; "aim": the next target at once."""

    def _judge(self, *, there: bool, held: bool) -> None:
        """Whether the board is at the target, and whether it was for long enough."""
        if self.stage in ("aim", "hold"):
            self.stage = "hold" if there else "aim"
            if held:
                self._finish(REACHED)

    def _finish(self, outcome: Outcome) -> None:
        row = self._row_of(outcome)
        self._record(row)
        self.rows.append(row)
        self.stage = self._stage_after(outcome)
        if self.stage == "aim":
            self._aim()

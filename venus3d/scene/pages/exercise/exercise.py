"""State machine of an exercise: a person brings a board to a target with a help, and is timed.

    ready --next--> aim <--> hold --held--> reached --next--> aim ...       practice
    ready --next--> aim <--> hold --held--> aim ... ready (next help) ... over    trial

Independent of pages and files; times are passed in. `Practice` and `Trial` choose the targets,
decide when a pose is held, and write the rows. Used by one thread.
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
    """A sequence of targets for one person."""

    def __init__(
        self, camera: Camera, board: Board, written: str, record: Callable[[ExerciseRow], None]
    ) -> None:
        """
        Args:
            written: where the times are written, for display.
            record: called with each pose when it is finished.
        """
        self.camera, self.board = camera, board
        self._written, self._record = written, record
        self.stage: Stage = "ready"
        self.rows: list[ExerciseRow] = []
        """All finished poses."""
        self._now_s = 0.0
        self._dark = True
        self._view: View | None = None
        self._changed = True

    def begin(self) -> bool:
        """Show the next target. False if none is waiting."""
        self._changed = True
        if self.stage not in ("ready", "reached"):
            return False
        self.stage = "aim"
        self._aim()
        return True

    def give_up(self) -> bool:
        """Skip the current target. False if none is shown."""
        self._changed = True
        if self.stage not in ("aim", "hold"):
            return False
        self._finish(GIVEN_UP)
        return True

    def handle(self, request: Request) -> None:
        """Carry out a person's request."""
        self._changed = True
        match request:
            case Press("next"):
                self.begin()
            case Press("give_up"):
                self.give_up()
            case Press("theme"):
                self._dark = not self._dark
            case _:
                pass

    def tick(self, now_s: float) -> None:
        """Advance the clock, where it is not that of the frames."""

    def view(self) -> View:
        """What is to be shown now; the same object until something has changed."""
        if self._view is None or self._changed:
            self._view, self._changed = self._make_view(), False
        return self._view

    @property
    def last_view(self) -> View:
        """The view made last, for other threads."""
        return self._view or self.view()

    @abstractmethod
    def _make_view(self) -> View:
        """What is to be shown now."""

    @abstractmethod
    def _aim(self) -> None:
        """Take the next target; the stage is "aim"."""

    @abstractmethod
    def _row_of(self, outcome: Outcome) -> ExerciseRow:
        """The row of the current target."""

    @abstractmethod
    def _stage_after(self, outcome: Outcome) -> Stage:
        """The stage after this target; "aim": the next target at once."""

    def _judge(self, *, there: bool, held: bool) -> None:
        """Update the stage: is the board at the target, and was it held long enough?"""
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

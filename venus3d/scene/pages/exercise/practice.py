"""One trainee's practice: levels, a board moved on the page, and the path it takes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.amounts import signed, whole
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.exercise import (
    HOLD_S,
    LEVELS,
    NAMES,
    Attempt,
    Reach,
    practice_target,
    reach_of,
    start_pose,
    within_reach,
)
from venus3d.engine.guidance.matching import Match, match
from venus3d.engine.planning.limits import Limits
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.exercise import Exercise
from venus3d.scene.pages.exercise.view_model import (
    PRACTICE_HELPS,
    ChooseHelp,
    ChooseLevel,
    Help,
    MoveBoard,
    Mover,
    Nudge,
    PracticeViewModel,
    Press,
    Rename,
    Request,
    SetAutoLevel,
    Stage,
)
from venus3d.scene.web.board_keys import KeyMoves
from venus3d.storage.exercise import REACHED, ExerciseRow, Outcome, name_of, target_columns

REACHED_FOR_NEXT_LEVEL = 2
"""Poses to reach in a row for the next level."""
_UNITS = (1, 1, 1, 1000, 1000, 1000)  # degrees and millimetres


@dataclass(frozen=True, eq=False)
class PracticeSettings:
    """Settings common to all trainees of a server."""

    camera: Camera
    board: Board
    limits: Limits
    start: Pose
    reach: Reach
    seed: int
    written: str
    """The file with the times."""

    @staticmethod
    def of(camera: Camera, board: Board, seed: int, written: str) -> PracticeSettings:
        """Raises `VenusError` if this camera cannot read this board."""
        limits = Limits.for_board(board, camera)
        start = start_pose(camera, board, limits)
        reach = reach_of(camera, limits)
        return PracticeSettings(camera, board, limits, start, reach, seed, written)


class Practice(Exercise[PracticeViewModel]):
    """The practice of one tab."""

    def __init__(
        self,
        settings: PracticeSettings,
        number: int,
        record: Callable[[ExerciseRow], None] = lambda _: None,
        known: Sequence[ExerciseRow] = (),
    ) -> None:
        """A guest on the first level, with the steps as help and the board at the start.

        Args:
            number: of the guest.
            record: called with each pose when it is finished.
            known: the file's rows, so that a returning trainee continues where they stopped.
        """
        super().__init__(settings.camera, settings.board, settings.written, record)
        self._settings, self._known = settings, known
        self.name = self._guest = say.GUEST.format(number=number)
        self._level, self._help = 1, PRACTICE_HELPS[0]
        self._auto_level, self._through, self._surroundings = True, False, True
        self._in_a_row = 0
        self._numbers: dict[int, int] = dict.fromkeys(LEVELS, 0)
        self._note = ""
        self._keys = KeyMoves()
        self._ticked: tuple[str, int] = ("ready", 0)
        self.begin()

    # -- requests ----------------------------------------------------------------------------------

    def handle(self, request: Request) -> None:
        """Carry out the trainee's request."""
        super().handle(request)
        match request:
            case MoveBoard(pose, by, grabbed):
                self._move(pose, by)
                if grabbed is not None and self._attempt.pose is not grabbed and not self._note:
                    self._note = _change_told(grabbed, self._attempt.pose)
            case Nudge(number, sign):
                moved = self._keys.moved(self._attempt.pose, number, sign, self._now_s)
                self._move(moved, "keys")
            case ChooseLevel(level):
                self._go_to(level)
            case ChooseHelp(chosen):
                after = PRACTICE_HELPS[(PRACTICE_HELPS.index(self._help) + 1) % len(PRACTICE_HELPS)]
                self._help: Help = chosen or after
            case SetAutoLevel(on):
                self._auto_level = on
            case Rename(name):
                self._rename(name)
            case Press("view"):
                self._through = not self._through
            case Press("surroundings"):
                self._surroundings = not self._surroundings
            case Press("start_over"):
                self._move(self._attempt.start, "keys")
            case _:
                pass

    def tick(self, now_s: float) -> None:
        """Advance the clock; a pose that has been held is finished."""
        self._now_s = now_s
        self._compare()
        if self.stage == "hold" and self._attempt.still_s(now_s) >= HOLD_S:
            self._judge(there=True, held=True)
        seconds = 0 if self.stage == "reached" else int(self._attempt.taken_s(now_s))
        if (self.stage, seconds) != self._ticked:
            self._ticked, self._changed = (self.stage, seconds), True

    def _make_view(self) -> PracticeViewModel:
        attempt, match = self._attempt, self._compare()
        taken = self._taken_s if self.stage == "reached" else attempt.taken_s(self._now_s)
        return PracticeViewModel(
            camera=self.camera,
            board=self.board,
            pose=attempt.pose,
            target=attempt.target,
            attempt=attempt,
            match=match,
            stage=self.stage,
            level=self._level,
            help=self._help,
            auto_level=self._auto_level,
            side="through" if self._through else "outside",
            surroundings=self._surroundings,
            dark=self._dark,
            seconds=taken,
            rows=tuple(self.rows),
            note=self._note,
            written=self._written,
            last_mover=self._movers[-1] if self._movers else None,
        )

    # -- targets -----------------------------------------------------------------------------------

    def begin(self) -> bool:
        """Show the next target; the same for everybody at this point of the level."""
        if not super().begin():
            return False
        self._note = ""
        return True

    def _aim(self) -> None:
        settings, level = self._settings, self._level
        self._numbers[level] += 1
        generator = np.random.default_rng([settings.seed, level, self._numbers[level]])
        target, free = practice_target(
            settings.camera, settings.board, settings.limits, settings.start, level, generator
        )
        self._attempt = Attempt.at(settings.start, target, free)
        self._movers: list[Mover] = []
        self._taken_s = 0.0
        self._match: Match | None = None
        self._compare()

    def _go_to(self, level: int) -> None:
        if level == self._level and self.stage != "reached":
            return
        self._level, self._in_a_row, self._note = level, 0, ""
        self.stage = "aim"
        self._aim()

    def _rename(self, name: str) -> None:
        name = name_of(name)
        self.name = name or self._guest
        mine = [row for row in self._known if row.participant == name]
        if not name or not mine:
            return
        for row in mine:
            if row.level in self._numbers:
                self._numbers[row.level] = max(self._numbers[row.level], row.pose)
        if self._attempt.began_s is None:  # continue where this name stopped
            self._level = min(max(mine[-1].level, LEVELS[0]), LEVELS[-1])
            self._aim()

    # -- the board ---------------------------------------------------------------------------------

    def _compare(self) -> Match:
        """The board against the target; computed once for all moves since the last call, since
        nobody saw those in between."""
        settings, attempt = self._settings, self._attempt
        if self._match is None or self._compared is not attempt.pose:
            self._compared = attempt.pose
            self._match = match(
                settings.camera,
                settings.board,
                attempt.pose,
                attempt.target,
                previous=self._match,
            )
            self._judge(there=all(self._match.within), held=False)
        return self._match

    def _move(self, pose: Pose, by: Mover) -> None:
        if self.stage == "reached":
            return
        before = self._attempt
        # A half-typed number is a pose too, but not one on the path.
        within = within_reach(pose, self._settings.reach)
        self._attempt = before.moved(within, self._now_s, jump=by == "sliders")
        if by not in self._movers[-1:]:
            # Each mover once, the latest last.
            self._movers = [*(mover for mover in self._movers if mover != by), by]
        if self._attempt is not before:
            self._note = ""
        elif before.pose.distance_to(within) > 1e-4 or before.pose.angle_to_deg(within) > 0.1:
            self._note = say.STAYS

    # -- a finished pose ---------------------------------------------------------------------------

    def _row_of(self, outcome: Outcome) -> ExerciseRow:
        attempt, now_s, match = self._attempt, self._now_s, self._compare()
        # Holding still does not count as the trainee's time.
        held_s = attempt.still_s(now_s) if outcome == REACHED else 0.0
        self._taken_s = max(0.0, attempt.taken_s(now_s) - held_s)
        return ExerciseRow(
            participant=self.name,
            level=self._level,
            free=" ".join(name for name, on in zip(NAMES, attempt.free, strict=True) if on),
            pose=self._numbers[self._level],
            help=self._help,
            outcome=outcome,
            seconds=self._taken_s,
            moved_by=" ".join(self._movers),
            path_mm=attempt.path_mm,
            shortest_mm=attempt.shortest_mm,
            path_deg=attempt.path_deg,
            shortest_deg=attempt.shortest_deg,
            overlap=match.overlap,
            off_mm=1000 * attempt.pose.distance_to(attempt.target),
            off_deg=attempt.pose.angle_to_deg(attempt.target),
            seed=self._settings.seed,
            **target_columns(attempt.target),
        )

    def _stage_after(self, outcome: Outcome) -> Stage:
        reached = outcome == REACHED
        self._note = "" if reached else say.GIVEN_UP_NOTE
        self._in_a_row = self._in_a_row + 1 if reached else 0
        enough = self._in_a_row >= REACHED_FOR_NEXT_LEVEL
        if self._auto_level and enough and self._level < LEVELS[-1]:
            self._level, self._in_a_row = self._level + 1, 0
            self._note = say.LEVEL_UP.format(level=self._level, name=say.LEVEL_NAMES[self._level])
        return "reached" if reached else "aim"


def _change_told(before: Pose, after: Pose) -> str:
    """Which of the six numbers a drag has changed, and by how much; empty for nothing."""
    change = after.vector() - before.vector()
    change[:3] = (change[:3] + 180) % 360 - 180
    changes = ", ".join(
        text.format(amount=signed(amount))
        for text, amount in zip(say.CHANGES, change * _UNITS, strict=True)
        if whole(amount)
    )
    return say.DRAGGED.format(changes=changes) if changes else ""

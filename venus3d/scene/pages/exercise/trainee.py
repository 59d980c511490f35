"""One trainee's practice: targets, levels, what counts as reached. Knows no page and no file.

A plain state machine: wishes and the clock go in, a moment comes out. Used by one thread.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.exercise import (
    HOLD_S,
    LEVELS,
    NAMES,
    Attempt,
    Reach,
    Score,
    practice_target,
    reach_of,
    start_pose,
    within_reach,
)
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.matching import match as compared
from venus3d.engine.planning.limits import Limits
from venus3d.scene.pages.exercise.texts import CLIMBED, GIVEN_UP, GUEST, LEVEL_NAMES, STAYS
from venus3d.scene.pages.exercise.view_model import (
    PRACTICE_HELPS,
    ChooseHelp,
    ChooseLevel,
    Climb,
    MoveBoard,
    Mover,
    Nudge,
    PracticeHelp,
    PracticeMoment,
    Press,
    Rename,
    Stage,
    Wish,
)
from venus3d.storage.practice import PracticeRow
from venus3d.storage.rows import target_columns, time_column

REACHED_TO_CLIMB = 2
"""So many poses reached in a row lead to the next level."""
_NUDGE_DEG, _NUDGE_M = 1.0, 0.002
_REPEAT_S = 0.25  # a key that comes again so soon is held down
_FASTEST = 5.0
_LONGEST_NAME = 40


@dataclass(frozen=True, eq=False)
class Course:
    """What all trainees of a server have in common."""

    camera: Camera
    board: Board
    limits: Limits
    start: Pose
    reach: Reach
    seed: int
    written: str
    """The file with the times."""

    @staticmethod
    def of(camera: Camera, board: Board, seed: int, written: str) -> Course:
        """Raises `VenusError` if this camera cannot read this board."""
        limits = Limits.for_board(board, camera)
        start = start_pose(camera, board, limits)
        return Course(camera, board, limits, start, reach_of(camera, limits), seed, written)


class Trainee:
    """Whoever sits before one tab."""

    def __init__(self, course: Course, number: int) -> None:
        """A guest on the first level, helped by the steps; the board at the start."""
        self._course = course
        self.name = GUEST.format(number=number)
        self._guest = self.name
        self.new_rows: list[PracticeRow] = []
        """Poses that are done with and not yet written; whoever writes them empties this."""
        self._level, self._help = 1, PRACTICE_HELPS[0]
        self._climb, self._through, self._dark = True, False, True
        self._in_a_row = 0
        self._numbers: dict[int, int] = dict.fromkeys(LEVELS, 0)
        self._scores: list[Score] = []
        self._note = ""
        self._nudged: tuple[Nudge, float, int] | None = None
        self._begin()

    # -- what is asked of it ---------------------------------------------------------------------

    def obey(self, wish: Wish, now_s: float, known: Sequence[PracticeRow] = ()) -> None:
        """Do what the trainee asked for at this time; `known` rows tell who was here before."""
        match wish:
            case MoveBoard(pose, by):
                self._move(pose, by, now_s)
            case Nudge():
                self._nudge(wish, now_s)
            case ChooseLevel(level):
                self._go_to(level)
            case ChooseHelp(chosen):
                after = PRACTICE_HELPS[(PRACTICE_HELPS.index(self._help) + 1) % len(PRACTICE_HELPS)]
                self._help: PracticeHelp = chosen or after
            case Climb(on):
                self._climb = on
            case Rename(name):
                self._rename(name, known)
            case Press(what):
                self._press(what, now_s)

    def tick(self, now_s: float) -> bool:
        """Let time pass; whether the moment has changed by itself."""
        self._compare()
        if self._stage == "hold" and self._attempt.still_s(now_s) >= HOLD_S:
            self._finish(now_s, reached=True)
            return True
        seconds = int(self._attempt.taken_s(now_s))
        changed = self._stage != "reached" and seconds != self._seconds_shown
        self._seconds_shown = seconds
        return changed

    def moment(self, now_s: float) -> PracticeMoment:
        """What there is to be seen."""
        attempt, course = self._attempt, self._course
        match = self._compare()
        taken = self._taken_s if self._stage == "reached" else attempt.taken_s(now_s)
        return PracticeMoment(
            camera=course.camera,
            board=course.board,
            pose=attempt.pose,
            target=attempt.target,
            free=attempt.free,
            match=match,
            stage=self._stage,
            level=self._level,
            help=self._help,
            climb=self._climb,
            look="through" if self._through else "outside",
            dark=self._dark,
            seconds=taken,
            path_mm=attempt.path_mm,
            shortest_mm=attempt.shortest_mm,
            path_deg=attempt.path_deg,
            shortest_deg=attempt.shortest_deg,
            scores=tuple(self._scores),
            note=self._note,
            written=course.written,
            last_mover=self._movers[-1] if self._movers else None,
        )

    # -- how it is done --------------------------------------------------------------------------

    def _begin(self) -> None:
        """The next target of this level; the same one for everybody who gets so far."""
        course, level = self._course, self._level
        self._numbers[level] += 1
        generator = np.random.default_rng([course.seed, level, self._numbers[level]])
        target, free = practice_target(
            course.camera, course.board, course.limits, course.start, level, generator
        )
        self._attempt = Attempt.at(course.start, target, free)
        self._movers: list[Mover] = []
        self._stage: Stage = "aim"
        self._seconds_shown, self._taken_s = 0, 0.0
        self._match: Match | None = None
        self._compare()

    def _compare(self) -> Match:
        """How the board stands to the target. Once for all that was moved since the last time:
        nobody saw what was in between."""
        course, attempt = self._course, self._attempt
        if self._match is None or self._compared is not attempt.pose:
            self._compared = attempt.pose
            self._match = compared(
                course.camera, course.board, attempt.pose, attempt.target, previous=self._match
            )
            self._stage = "hold" if all(self._match.within) else "aim"
        return self._match

    def _move(self, pose: Pose, by: Mover, now_s: float) -> None:
        if self._stage == "reached":
            return
        before = self._attempt
        # Half of a number that is being typed is a pose as well, but not one on the way.
        within = within_reach(pose, self._course.reach)
        self._attempt = before.moved(within, now_s, jump=by == "sliders")
        if by not in self._movers[-1:]:
            # The one that moved last stands last, each once.
            self._movers = [*(mover for mover in self._movers if mover != by), by]
        if self._attempt is not before:
            self._note = ""
        elif before.pose.distance_to(within) > 1e-4 or before.pose.angle_to_deg(within) > 0.1:
            self._note = STAYS

    def _nudge(self, nudge: Nudge, now_s: float) -> None:
        run = 0
        if self._nudged is not None and self._nudged[0] == nudge:
            run = self._nudged[2] + 1 if now_s - self._nudged[1] < _REPEAT_S else 0
        self._nudged = (nudge, now_s, run)
        faster = min(_FASTEST, 1 + run / 5)
        vector = self._attempt.pose.vector()
        size = _NUDGE_DEG if nudge.number < 3 else _NUDGE_M
        vector[nudge.number] += nudge.sign * faster * size
        self._move(Pose.from_vector(vector), "keys", now_s)

    def _press(self, what: str, now_s: float) -> None:
        if what == "look":
            self._through = not self._through
        elif what == "light":
            self._dark = not self._dark
        elif what == "next" and self._stage == "reached":
            self._note = ""
            self._begin()
        elif what == "again" and self._stage != "reached":
            self._move(self._attempt.start, "keys", now_s)
        elif what == "give_up" and self._stage != "reached":
            self._finish(now_s, reached=False)
            self._note = GIVEN_UP
            self._begin()

    def _go_to(self, level: int) -> None:
        if level == self._level and self._stage != "reached":
            return
        self._level, self._in_a_row, self._note = level, 0, ""
        self._begin()

    def _rename(self, name: str, known: Sequence[PracticeRow]) -> None:
        # A spreadsheet would take a name that begins so for a formula.
        name = " ".join(name.split())[:_LONGEST_NAME].lstrip("=+-@ ")
        self.name = name or self._guest
        mine = [row for row in known if row.trainee == name]
        if not name or not mine:
            return
        for row in mine:
            if row.level in self._numbers:
                self._numbers[row.level] = max(self._numbers[row.level], row.pose)
        if self._attempt.began_s is None:  # nothing is lost: go on where this name left off
            self._level = min(max(mine[-1].level, LEVELS[0]), LEVELS[-1])
            self._begin()

    def _finish(self, now_s: float, *, reached: bool) -> None:
        attempt, number = self._attempt, self._numbers[self._level]
        # The second of holding still is not the trainee's time.
        self._taken_s = max(
            0.0, attempt.taken_s(now_s) - (attempt.still_s(now_s) if reached else 0)
        )
        score = Score(
            level=self._level,
            pose=number,
            help=self._help,
            reached=reached,
            seconds=self._taken_s,
            path_mm=attempt.path_mm,
            shortest_mm=attempt.shortest_mm,
            path_deg=attempt.path_deg,
            shortest_deg=attempt.shortest_deg,
        )
        self._scores.append(score)
        self.new_rows.append(self._row(score))
        self._stage = "reached"
        self._in_a_row = self._in_a_row + 1 if reached else 0
        if self._climb and self._in_a_row >= REACHED_TO_CLIMB and self._level < LEVELS[-1]:
            self._level, self._in_a_row = self._level + 1, 0
            self._note = CLIMBED.format(level=self._level, name=LEVEL_NAMES[self._level][4:])

    def _row(self, score: Score) -> PracticeRow:
        attempt, course = self._attempt, self._course
        names = zip(NAMES, attempt.free, strict=True)
        return PracticeRow(
            trainee=self.name,
            level=score.level,
            free=" ".join(name for name, on in names if on),
            pose=score.pose,
            help=score.help,
            outcome="reached" if score.reached else "given up",
            seconds=score.seconds,
            moved_by=" ".join(self._movers),
            path_mm=score.path_mm,
            shortest_mm=score.shortest_mm,
            path_deg=score.path_deg,
            shortest_deg=score.shortest_deg,
            off_mm=1000 * attempt.pose.distance_to(attempt.target),
            off_deg=attempt.pose.angle_to_deg(attempt.target),
            seed=course.seed,
            time=time_column(),
            **target_columns(attempt.target),
        )

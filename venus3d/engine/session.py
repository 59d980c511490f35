"""A guided calibration as a plain state machine: `observe(observation) -> Snapshot`.

    startup --capture--> captured --outcome--> guiding --capture--> captured ... --> converged
                                                                             `-----> finished

Live and replayed sessions run the same code. What takes time (calibrating, searching) is handed
out as a frozen `Work` in `pending`; whoever drives the session runs it, on any thread or on the
spot, and gives the result back with `apply`. Meanwhile observations go on being taken in.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera, planning_camera
from venus3d.engine.diagnosis import diagnose, worst_first
from venus3d.engine.errors import CalibrationError
from venus3d.engine.generation import GenerationState
from venus3d.engine.information import view_information
from venus3d.engine.localisation import locate
from venus3d.engine.matching import match, motion_px
from venus3d.engine.observation import Observation
from venus3d.engine.outlook import Outlook
from venus3d.engine.pose import Array, Pose
from venus3d.engine.saying import said, said_at_startup
from venus3d.engine.snapshot import (
    Calibration,
    Convergence,
    Cost,
    Diagnosis,
    Forecast,
    Match,
    Method,
    Phase,
    Progress,
    Snapshot,
    Target,
)
from venus3d.engine.startup import Startup
from venus3d.engine.way import way_of
from venus3d.engine.work import Outcome, Settings, Work, noise_of


@dataclass(frozen=True, eq=False)
class _Captured:
    """A view that was taken, and the target it was taken at; None if it was not at one."""

    number: int
    observation: Observation
    target: Target | None


class Session:
    """One guided calibration of one camera with one board. Used by one thread."""

    def __init__(
        self, board: Board, image_size: tuple[int, int], settings: Settings | None = None
    ) -> None:
        """A session for images of `image_size` (width, height)."""
        self.settings = settings or Settings()
        self._image_size = image_size
        self.board_diagnoses: tuple[Diagnosis, ...] = ()
        """What the detector says of the board it sees; set by whoever drives the session."""
        self._restart(board)

    def _restart(self, board: Board) -> None:
        self.board = board
        self.pending: Work | None = None
        """The work that waits to be run; `apply` its outcome."""
        self._startup = Startup(board, self._image_size)
        self._phase: Phase = "startup"
        self._captured: list[_Captured] = []
        self._next_view = 1
        self._next_target = 1
        self._target: Target | None = None
        self._calibration: Calibration | None = None
        self._information: Array = np.zeros((9, 9))
        self._convergence: Convergence | None = None
        self._history: tuple[Progress, ...] = ()
        self._generation = GenerationState()
        self._skipped: tuple[Pose, ...] = ()
        self._warnings: tuple[str, ...] = ()
        self._diagnoses: tuple[Diagnosis, ...] = ()
        self._forecast: Forecast | None = None
        self._before = self._observation = Observation.nothing(self._image_size)
        self._pose: Pose | None = None
        self._match: Match | None = None
        self._held = 0
        self._keep_going = False
        self._ending = False
        self._lost = ""
        self._number = 0

    # -- what happens ----------------------------------------------------------------------------

    def observe(self, observation: Observation) -> Snapshot:
        """Take in what was seen in one frame; captures by itself where the settings say so.

        Raises `CalibrationError` if the frame's size is not the session's.
        """
        if observation.image_size != self._image_size:
            raise CalibrationError(
                f"A frame of {observation.image_size[0]} x {observation.image_size[1]} px came "
                f"into a calibration of {self._image_size[0]} x {self._image_size[1]} px; "
                "calibrate each image size by itself."
            )
        self._number += 1
        self._before, self._observation = self._observation, observation
        if self._phase == "startup":
            self._startup.observe(observation)
            self._target = self._startup.aimed(
                self._target, self._next_target, self.settings.method, self.settings.cost
            )
        self._pose = locate(self.camera, self.board, observation, self._pose)
        self._match = self._matched(self._before)
        self._held = self._held + 1 if self._match is not None and self._match.reached else 0
        if self.settings.auto_capture and self._phase in ("startup", "guiding"):
            ready = self._phase == "guiding" or self._startup.determined
            held = ready and self._held >= self.settings.hold_frames
            if held or self._is_useful():
                self.capture()
        return self.snapshot()

    def capture(self) -> bool:
        """Take the present observation as a view. False if no board is seen, it is one already,
        or all is over.

        A view that does not show the focal length is taken as well when asked for: guidance then
        goes on with a guessed camera, and says so, until tilted views come.
        """
        taken = bool(self._captured) and self._captured[-1].observation is self._observation
        if self._pose is None or taken or self._phase == "finished" or self._ending:
            return False
        now = self._match
        there = now is not None and (now.reached or all(now.within))
        at = self._target if there and self._phase == "guiding" else None
        self._captured.append(_Captured(self._next_view, self._observation, at))
        self._next_view += 1
        self._keep_going = self._keep_going or self._phase == "converged"
        self._recalibrate()
        return True

    def skip(self) -> bool:
        """Give up the present target for another one elsewhere. False if there is none."""
        if self._target is None or self._phase != "guiding":
            return False
        self._skipped = (*self._skipped, self._target.pose)
        self._recalibrate()
        return True

    def choose(self, index: int) -> bool:
        """Take another of the target's alternatives. False if there is none of that number.

        The pose given up becomes the last alternative, so that `choose(0)` goes round them all.
        """
        old = self._target
        if old is None or self._phase != "guiding" or not 0 <= index < len(old.alternatives):
            return False
        others = [other for i, other in enumerate(old.alternatives) if i != index]
        others.append(replace(old, alternatives=()))
        self._target = replace(old.alternatives[index], alternatives=tuple(others))
        self._held = 0
        self._match = self._matched(None)
        return True

    def change(self, method: Method, cost: Cost | None = None) -> None:
        """Find the next poses in another way; a target that is shown is searched anew.

        The method's own search is used, and for `cost` None its own cost. Raises `VenusError` for a
        combination that makes no sense; the session is then as it was.
        """
        way_of(method, cost)
        same = (method, cost, None)
        if same == (self.settings.method, self.settings.cost, self.settings.strategy):
            return
        self.settings = replace(self.settings, method=method, cost=cost, strategy=None)
        if self._captured and self._phase in ("guiding", "captured") and not self._ending:
            self._recalibrate()

    def undo(self) -> bool:
        """Take the last captured view back. False if there is none."""
        return bool(self._captured) and self.drop(self._captured[-1].number)

    def drop(self, number: int) -> bool:
        """Take the view with this number back. False if there is none, or the user has ended it."""
        numbers = [view.number for view in self._captured]
        if number not in numbers or self._ending:
            return False
        index = numbers.index(number)
        del self._captured[index]
        # What was judged or promised with this view among the others does not hold any more.
        self._captured[index:] = [replace(view, target=None) for view in self._captured[index:]]
        self._history = tuple(p for p in self._history if p.views <= index)
        if self._captured:
            self._recalibrate()
        else:
            views_so_far = self._next_view
            self._restart(self.board)
            self._next_view = views_so_far
        return True

    def finish(self) -> None:
        """End the session; what was captured stays, and what is pending is still to be applied."""
        self._ending = True
        self._target = self._match = None
        if self.pending is None:
            self._phase = "finished"
            self._diagnose()

    def use_board(self, board: Board) -> None:
        """Go on with a board whose layout turned out differently; only before the first view."""
        if not self._captured and board != self.board:
            self._restart(board)

    def apply(self, outcome: Outcome) -> Snapshot:
        """Take the result of `pending` back; the result of an older work is ignored."""
        if outcome.work is not self.pending:
            return self.snapshot()
        self.pending = None
        self._calibration, self._information = outcome.calibration, outcome.information
        self._history, self._convergence = outcome.history, outcome.convergence
        self._forecast = outcome.forecast
        self._warnings = (*outcome.warnings, *([self._lost] if self._lost else []))
        self._lost, self._held = "", 0
        self._target = self._match = None
        if self._ending:
            self._phase = "finished"
        elif outcome.is_over:
            self._phase = "converged" if outcome.convergence.converged else "finished"
        else:
            self._phase = "guiding"
            if outcome.suggestion is not None:
                self._target, self._generation = outcome.suggestion.target, outcome.suggestion.state
                self._next_target = self._target.number + 1
        self._diagnose()
        self._pose = locate(self.camera, self.board, self._observation, self._pose)
        self._match = self._matched(None)
        return self.snapshot()

    def fail(self, work: Work, error: CalibrationError) -> Snapshot:
        """Take back that `work` could not be done: its last view is dropped and the cause said."""
        if work is self.pending:
            self.pending = None
            self._lost = f"The last view was not kept: {error}"
            self._captured.pop()
            if self._captured:
                self._recalibrate()
            else:
                lost = self._lost
                self._restart(self.board)
                self._warnings = (lost,)
        return self.snapshot()

    # -- what is known ---------------------------------------------------------------------------

    @property
    def camera(self) -> Camera:
        """The best camera known to see and to plan with; see `planning_camera`."""
        if self._calibration is None:
            return self._startup.camera
        return planning_camera(self._calibration.camera)

    @property
    def phase(self) -> Phase:
        """Where the session stands."""
        return self._phase

    def snapshot(self) -> Snapshot:
        """Everything about this moment."""
        headline, instruction = said(self._phase, self._match, seen=self._pose is not None)
        if self._phase == "startup" and not self._startup.determined and self._target is None:
            headline, instruction = said_at_startup(self._observation.count, self.board)
        return Snapshot(
            number=self._number,
            phase=self._phase,
            board=self.board,
            camera=self.camera,
            observation=self._observation,
            pose=self._pose,
            target=self._target,
            match=self._match,
            calibration=self._calibration,
            convergence=self._convergence,
            history=self._history,
            headline=headline,
            instruction=instruction,
            warnings=self._warnings,
            diagnoses=worst_first((*self.board_diagnoses, *self._diagnoses)),
            forecast=None if self._phase == "finished" else self._forecast,
        )

    # -- how it goes on --------------------------------------------------------------------------

    def _matched(self, before: Observation | None) -> Match | None:
        if self._pose is None or self._target is None:
            return None
        return match(
            self.camera,
            self.board,
            self._pose,
            self._target.pose,
            observation=self._observation,
            before=before,
            previous=self._match,
            overlap_needed=self.settings.overlap_needed,
            still_px=self.settings.still_px,
            tolerance=self.settings.tolerance,
        )

    def _is_useful(self) -> bool:
        """Whether this observation tells enough although it is not the target (see settings)."""
        drop = self.settings.useful_drop
        if drop is None or self._pose is None:
            return False
        if motion_px(self._before, self._observation) > self.settings.still_px:
            return False
        if self._calibration is None:
            return True  # the first view of a recording: there is nothing to compare it with
        now = Outlook.of(self.board, self.camera, self._information, noise_of(self._calibration))
        points = self.board.points_of(self._observation.ids)
        seen = view_information(now.camera, points, self._pose.R[None], self._pose.t[None])[0]
        return now.with_information(seen).error_px <= (1 - drop) * now.error_px

    def _diagnose(self) -> None:
        if self._calibration is not None:
            growing = self._phase not in ("converged", "finished")
            self._diagnoses = diagnose(self.board, self._calibration, growing=growing)

    def _recalibrate(self) -> None:
        numbers = tuple(view.number for view in self._captured)
        self.pending = Work(
            board=self.board,
            settings=self.settings,
            observations=tuple(view.observation for view in self._captured),
            numbers=numbers,
            history=tuple(p for p in self._history if p.views < len(numbers)),
            generation=self._generation,
            skipped=self._skipped,
            target_number=self._next_target if self._target is None else self._target.number + 1,
            start=self._startup.camera,
            keep_going=self._keep_going,
            last_target=self._captured[-1].target,
        )
        self._phase = "captured"
        self._held = 0

"""Decides when a view is captured and what follows, as a state machine: `observe -> Snapshot`.

    startup --capture--> captured --outcome--> guiding --capture--> captured ... --> converged
                                                  ^                          `-----> finished
                                                  `--resume-----------------------------'

Live and replayed sessions run the same code. Slow work (calibrating, searching) is handed out as
a frozen `Work` in `pending`. `run_pending` does it in place; to keep observing meanwhile, run it on
another thread and pass the outcome to `apply`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.camera_plausibility import WrongCamera
from venus3d.engine.calibration.checks import Diagnoses
from venus3d.engine.calibration.dark_rim import image_circle
from venus3d.engine.calibration.diagnosis import Diagnosis, joined
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.repeats import repeats
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import corners_outside
from venus3d.engine.geometry.lenses import lens_chosen
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.convergence import Convergence, Progress
from venus3d.engine.guidance.known_camera import KnownCamera, KnownStart
from venus3d.engine.guidance.loop import Calibrated, LoopFigures
from venus3d.engine.guidance.prompts import (
    CALCULATING,
    Phase,
    headline_and_prompt,
    refusal_headline_and_prompt,
    startup_headline_and_prompt,
)
from venus3d.engine.guidance.record import NoRecorder, Recorder, SessionState
from venus3d.engine.guidance.remaining import remaining_steps
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.guidance.startup import Startup
from venus3d.engine.guidance.tracking import PoseTracker, is_near
from venus3d.engine.guidance.views import CapturedView, CapturedViews
from venus3d.engine.guidance.work import Outcome, Work
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.settings import Cost, Method
from venus3d.engine.planning.target import Target
from venus3d.engine.sentences import Sentence, said_by

KNOWN_IS_ANOTHER = Sentence(
    "The board does not look as the known camera would see it: it is another camera, zoom or "
    "focus. The session goes on without it."
)
_NOT_KEPT = Sentence("The last view was not kept: {error}")


class Session:
    """One guided calibration of one camera with one board. Used by one thread."""

    def __init__(
        self,
        board: Board,
        image_size: tuple[int, int],
        settings: Settings | None = None,
        recorder: Recorder | None = None,
        known: KnownCamera | None = None,
    ) -> None:
        """A session for images of `image_size` (width, height), kept by `recorder`; it starts from
        the camera that is `known`, if any, which must be for such images.
        Raises `VenusError` for settings whose method, cost and search are incompatible."""
        self.settings = settings or Settings()
        self._recorder = recorder or NoRecorder()
        self._ending = False
        self._image_size = image_size
        self._board_diagnoses: tuple[Diagnosis, ...] = ()
        self._taken_back: Observation | None = None
        self._run, self._known = 1, known
        self._restart(board)

    def _restart(self, board: Board, captured: CapturedViews | None = None) -> None:
        self.board = board
        self.pending: Work | None = None
        """Work to be run; pass its outcome to `apply`."""
        self._startup = (
            Startup(board, self._image_size, lens_chosen(self.settings.lens))
            if self._known is None
            else KnownStart(board, self._known, self.settings)
        )
        self._phase: Phase = "finished" if self._ending else "startup"
        self._captured = captured or CapturedViews()
        self._next_target = 1
        self._target: Target | None = None
        self._convergence: Convergence | None = None
        self._history: tuple[Progress, ...] = ()
        self._heuristic_state = HeuristicState()
        self._skipped: tuple[Pose, ...] = ()
        self._warnings: tuple[str, ...] = ()
        self._diagnoses = Diagnoses()
        self._outcome: Outcome | None = None
        self._figures = LoopFigures()
        self._tracker = PoseTracker(board, self._image_size, self.settings)
        self._keep_going, self._lost, self._number = False, "", 0
        self._has_new_view = False
        self._wrong = WrongCamera(self.camera, board)

    # -- frames and commands -----------------------------------------------------------------------

    def observe(self, observation: Observation) -> Snapshot:
        """Process the observation of one frame; captures it if the settings ask for it.

        Until the first view is captured, the session adopts the board as detected.

        Raises `CalibrationError` if the frame's size is not the session's.
        """
        self.count_kept()
        if observation.board is not None:
            self._use_board(observation.board)
        self._board_diagnoses = observation.board_diagnoses
        self._figures.observe(observation)
        if self._phase == "startup":
            self._startup.observe(observation)
            self._target = self._startup.updated_target(
                self._target, self._next_target, self.settings.method, self.settings.cost
            )
        self._tracker.observe(
            observation, self.camera, self._target, self._captured.usual_sharpness
        )
        self._number += 1
        if self._phase == "startup" and self._known is not None:
            self._check_known()
        self._watch_taken_back()
        may_capture = (
            self.settings.auto_capture
            and self._taken_back is None
            and self._captured.may_keep(self._number)
        )
        if may_capture and self._phase in ("startup", "guiding"):
            best = self._tracker.best_held if self._is_held else None
            if best is not None or self._is_useful():
                self.capture(best)
        return self.snapshot()

    def _check_known(self) -> None:
        """Do without the known camera if the board looks as it cannot see it."""
        if self._wrong.look(self._tracker.observation, self._tracker.pose):
            self._known = None
            self._restart(self.board)
            self._lost = KNOWN_IS_ANOTHER
            self._warnings = (KNOWN_IS_ANOTHER,)

    def capture(self, chosen: Observation | None = None) -> bool:
        """Capture the current observation as a view, or one `chosen` from this hold at the target.
        False if there is none, or all is over. It counts once the recorder has kept it, see
        `count_kept`.

        A view that does not determine the focal length is accepted too: guidance then continues
        with a guessed camera, and says so, until tilted views come.
        """
        if self._captured.is_keeping:
            return True  # that one
        tracker = self._tracker
        over = self._phase == "finished" or self._ending
        seen = tracker.observation if chosen is None else chosen
        if tracker.pose is None or over or self._captured.has(seen):
            return False
        circle = None if seen.image is None else image_circle(seen.image)
        if circle is not None:
            seen = replace(seen, image_circle=circle)
        at_target = tracker.is_at_target and self._phase == "guiding"
        view = CapturedView(self._captured.next_number, seen, self._target if at_target else None)
        self._keep_going = self._keep_going or self._phase == "converged"
        self._captured.keep(view, self._recorder.captured(view))
        self.count_kept()
        return self._captured.is_keeping or not self._captured.not_kept

    def count_kept(self, *, wait: bool = False) -> None:
        """Count the captured view that the recorder has kept by now; `wait` for it. One that cannot
        be kept is not captured, and the snapshot's warnings say why."""
        if self._captured.add_kept(self._number, wait=wait):
            self._taken_back = None
            self._recalibrate(captured=True)

    def take_new_view(self) -> CapturedView | None:
        """The last captured view with its image, returned once; None if there is no new one."""
        return self._captured.take_new()

    def skip_target(self) -> bool:
        """Replace the current target by one elsewhere. False if there is none."""
        self.count_kept(wait=True)
        if self._target is None or self._phase != "guiding":
            return False
        self._skipped = (*self._skipped, self._target.pose)
        self._recalibrate()
        return True

    def choose_alternative(self, index: int) -> bool:
        """Switch to one of the target's alternatives. False if there is no such one.
        The rejected pose goes last, so that `choose_alternative(0)` cycles through them all."""
        self.count_kept(wait=True)
        old = self._target
        if old is None or self._phase != "guiding" or not 0 <= index < len(old.alternatives):
            return False
        others = [other for i, other in enumerate(old.alternatives) if i != index]
        others.append(replace(old, alternatives=()))
        self._target = replace(old.alternatives[index], alternatives=tuple(others))
        self._tracker.set_target(self.camera, self._target)
        return True

    def change_method(self, method: Method, cost: Cost | None = None) -> None:
        """Change how the next poses are found; the current target is searched again.

        The method's own search is used and, if `cost` is None, its own cost. Raises `VenusError`
        for an invalid combination and leaves the session unchanged.
        """
        self.count_kept(wait=True)
        old, new = self.settings, replace(self.settings, method=method, cost=cost, strategy=None)
        used = [(s.method, s.search_cost, s.search_strategy) for s in (old, new)]
        if used[0] == used[1]:
            return
        self.settings = new
        if self._captured.views and self._phase in ("guiding", "captured") and not self._ending:
            self._recalibrate()

    def undo_view(self) -> bool:
        """Discard the last captured view. False if there is none, or the user ended it.
        Its pose is captured by itself only after the board has left it."""
        self.count_kept(wait=True)
        last = self._captured.views[-1] if self._captured.views else None
        if last is None or not self.drop_view(last.number):
            return False
        self._taken_back = last.observation
        return True

    def drop_view(self, number: int) -> bool:
        """Discard the view with this number. False if there is none, or the user ended it."""
        self.count_kept(wait=True)
        index = None if self._ending else self._captured.drop(number)
        if index is None:
            return False
        # Calibrations that included this view are no longer valid.
        self._history = tuple(p for p in self._history if p.views <= index)
        self._go_on()
        return True

    def finish(self) -> None:
        """End the session; views are kept, and pending work can still be applied."""
        self.count_kept(wait=True)
        self._ending = True
        self._target = None
        self._tracker.set_target(self.camera, None)
        if self.pending is None:
            self._phase = "finished"

    def resume(self) -> bool:
        """Go on after the end, with all views. False if it has not ended.
        After convergence, poses are asked for until the user ends it."""
        if not (self._ending or self._phase in ("converged", "finished")):
            return False
        judged, views = self._convergence, len(self._captured.views)
        self._ending = False
        self._keep_going = self._keep_going or (judged is not None and judged.converged)
        if views >= self.settings.max_views:
            self.settings = replace(self.settings, max_views=views + self.settings.max_views)
        self._go_on()
        return True

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the images."""
        return self._image_size

    def restart(self, image_size: tuple[int, int] | None = None) -> None:
        """Begin anew with the same board, without any view, for images of `image_size` (width,
        height) if their size has changed."""
        self.count_kept(wait=True)
        self._ending, self._taken_back = False, None
        self._image_size = image_size or self._image_size
        self._run += 1
        self._restart(self.board)
        self._recorder.changed(self.state)

    @property
    def state(self) -> SessionState:
        """All that the next target depends on."""
        return SessionState(
            board=self.board,
            views=tuple(self._captured.views),
            next_view=self._captured.next_number,
            next_target=self._next_target if self._target is None else self._target.number + 1,
            history=tuple(p for p in self._history if p.views < len(self._captured.views)),
            heuristic_state=self._heuristic_state,
            skipped=self._skipped,
            start=self._startup.camera,
            keep_going=self._keep_going,
            run=self._run,
            method=self.settings.method,
            cost=self.settings.cost,
            known=self._known,
        )

    def restore(self, state: SessionState) -> None:
        """Go on from a state with the same views, and search the same target again."""
        if (state.method, state.cost) != (self.settings.method, self.settings.cost):
            self.settings = replace(
                self.settings, method=state.method, cost=state.cost, strategy=None
            )
        self._run, self._known = state.run, state.known
        self._restart(state.board, CapturedViews(state.views, state.next_view))
        self._next_target, self._history = state.next_target, state.history
        self._heuristic_state, self._skipped = state.heuristic_state, state.skipped
        self._startup.camera, self._keep_going = state.start, state.keep_going
        if state.views:
            self._recalibrate()

    def note_calibrated(self, work: Work, calibrated: Calibrated) -> None:
        """`work` has calibrated and searches until its outcome comes. From any thread."""
        self._figures.note(work, calibrated)

    def apply(self, outcome: Outcome) -> Snapshot:
        """Apply the result of `pending`; the result of outdated work is ignored."""
        if outcome.work is not self.pending:
            return self.snapshot()
        self.pending = None
        self._history, self._convergence = outcome.history, outcome.convergence
        self._outcome = outcome
        self._warnings = (*outcome.warnings, *([self._lost] if self._lost else []))
        self._lost, self._target = "", None
        found = outcome.suggestion
        self._figures.finish(outcome.calibrated, None if found is None else found.target)
        if self._ending:
            self._phase = "finished"
        elif outcome.is_over:
            self._phase = "converged" if outcome.convergence.converged else "finished"
        else:
            self._phase = "guiding"
            if found is not None:
                self._target, self._heuristic_state = found.target, found.state
                self._next_target = self._target.number + 1
        self._diagnoses = outcome.diagnoses
        self._tracker.set_target(self.camera, self._target)
        return self.snapshot()

    def fail(self, work: Work, error: CalibrationError) -> Snapshot:
        """`work` failed: drops its last view and adds a warning."""
        if work is self.pending:
            self.pending = None
            self._lost = lost = _NOT_KEPT.format(error=said_by(error))
            self._captured.drop(self._captured.views[-1].number)
            if not self._go_on():
                self._warnings = (lost,)
        return self.snapshot()

    def run_pending(self, stop: Callable[[], bool] | None = None) -> Snapshot:
        """Do the `pending` work in place until there is none, what is being kept counted; takes up
        to some seconds.

        `stop` ends a search early, with the best pose so far. An unusable view is dropped, and the
        snapshot's warnings say why.
        """
        self.count_kept(wait=True)
        while (work := self.pending) is not None:
            try:
                self.apply(work.run(stop))
            except CalibrationError as error:
                self.fail(work, error)
        return self.snapshot()

    # -- the state ---------------------------------------------------------------------------------

    @property
    def camera(self) -> Camera:
        """The best camera known, to track and to plan with; see `planning_camera`."""
        return self._startup.camera if self._outcome is None else self._outcome.posterior.camera

    @property
    def phase(self) -> Phase:
        """The session's state."""
        return self._phase

    def snapshot(self) -> Snapshot:
        """The current state as frozen values."""
        tracker, known = self._tracker, self._outcome
        remaining = remaining_steps(self._phase, self._target, tracker.match)
        headline, instruction = headline_and_prompt(
            self._phase, remaining and remaining.current, tracker.pose is not None, self._ending
        )
        if self._phase == "captured" and not self._has_new_view:
            headline, instruction = CALCULATING
        refusal = tracker.refusal if self._is_held and tracker.best_held is None else None
        if refusal is not None:
            headline, instruction = refusal_headline_and_prompt(refusal)
        over = self._phase in ("converged", "finished")
        diagnoses = self._diagnoses.final if over else self._diagnoses.growing
        if self._phase == "startup" and not self._startup.is_ready and self._target is None:
            pose = tracker.pose
            headline, instruction = startup_headline_and_prompt(
                tracker.observation.count,
                self.board.corner_count,
                inside=pose is not None and not len(corners_outside(pose, self.camera, self.board)),
            )
        return Snapshot(
            number=self._number,
            phase=self._phase,
            board=self.board,
            camera=self.camera,
            observation=tracker.observation,
            pose=tracker.pose,
            target=self._target,
            match=tracker.match,
            remaining=remaining,
            calibration=known and known.calibration,
            convergence=self._convergence,
            history=self._history,
            headline=headline,
            instruction=instruction,
            warnings=(*filter(None, [self._captured.not_kept]), *self._warnings),
            diagnoses=joined(self._board_diagnoses, diagnoses),
            final_diagnoses=self._diagnoses.final,
            forecast=known and known.forecast,
            method=self.settings.method,
            cost=self.settings.search_cost,
            uncertainty=known and known.uncertainty,
            search_trace=known and known.search_trace,
            taken_back=self._taken_back is not None,
            refusal=refusal,
            run=self._run,
            captured=tuple(view.number for view in self._captured.views),
            loop=self._figures.now(self._phase, remaining, self.pending, self._history),
        )

    # -- within ------------------------------------------------------------------------------------

    @property
    def _is_held(self) -> bool:
        """Whether the board has been held at its target for long enough."""
        ready = self._phase == "guiding" or (self._phase == "startup" and self._startup.is_ready)
        return ready and self._tracker.held_frames >= self.settings.hold_frames

    def _use_board(self, board: Board) -> None:
        """Adopt a board with another layout; only before the first view."""
        has_views = bool(self._captured.views) or self._captured.is_keeping
        if not (has_views or self._ending) and board != self.board:
            self._restart(board)

    def _watch_taken_back(self) -> None:
        """Forget the view taken back once the board has left its pose."""
        if self._taken_back is None or self._tracker.pose is None:
            return
        there = estimate_pose(self.camera, self.board, self._taken_back)
        if there is None or not is_near(
            self.camera, self.board, self._tracker.pose, there, self.settings
        ):
            self._taken_back = None
            # Whoever moves away as told is not told to hold still on the way.
            self._tracker.set_target(self.camera, self._target)

    def _is_useful(self) -> bool:
        """Whether the view lowers the uncertainty by `useful_drop`, at the target or not."""
        drop, tracker = self.settings.useful_drop, self._tracker
        if drop is None or tracker.pose is None or not tracker.is_still:
            return False
        taken = [view.observation for view in self._captured.views]
        if any(repeats(tracker.observation, other) for other in taken):
            return False
        if self._outcome is None:
            return True  # the first view of a recording: nothing to compare with
        now = self._outcome.posterior
        after = now.with_observation(tracker.observation, tracker.pose)
        return after.uncertainty_px <= (1 - drop) * now.uncertainty_px

    def _go_on(self) -> bool:
        """Calibrate the remaining views; if there are none, restart and return False."""
        if self._captured.views:
            self._recalibrate()
            return True
        self._restart(self.board, self._captured)  # keeps the numbering
        self._recorder.changed(self.state)
        return False

    def _recalibrate(self, *, captured: bool = False) -> None:
        """Calibrate and search anew; `captured`: because there is a new view."""
        self._has_new_view = captured
        state = self.state
        self.pending = Work(
            board=state.board,
            settings=self.settings,
            observations=tuple(view.observation for view in state.views),
            numbers=tuple(view.number for view in state.views),
            history=state.history,
            heuristic_state=state.heuristic_state,
            skipped=state.skipped,
            target_number=state.next_target,
            start=state.start,
            keep_going=state.keep_going,
            last_target=state.views[-1].target,
            known=state.known,
        )
        self._phase = "captured"
        self._tracker.release()
        self._recorder.changed(state)

"""One participant's trial: the same poses under each help, seen by a known camera. Nothing is
calibrated; measured is the time until each pose is reached and held. Times are those of the frames,
so a replayed or simulated trial repeats them."""

from __future__ import annotations

from collections.abc import Callable

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import headline_and_prompt
from venus3d.engine.guidance.remaining import remaining_steps
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.guidance.tracking import PoseTracker
from venus3d.engine.planning.target import Target, unpredicted_target
from venus3d.scene.pages.exercise.exercise import Exercise
from venus3d.scene.pages.exercise.trial_plan import Plan
from venus3d.scene.pages.exercise.view_model import (
    Help,
    MoveBoard,
    Press,
    Request,
    Stage,
    TrialViewModel,
)
from venus3d.storage.exercise import NAN, ExerciseRow, Outcome, target_columns


class Trial(Exercise[TrialViewModel]):
    """The trial of the person with the board."""

    def __init__(
        self,
        board: Board,
        camera: Camera,
        plan: Plan,
        targets: tuple[Pose, ...],
        record: Callable[[ExerciseRow], None],
        *,
        settings: Settings | None = None,
        written: str = "",
        source: str = "",
        seed: int = 0,
        move_board: Callable[[Pose], None] = lambda _: None,
    ) -> None:
        """
        Args:
            camera: the known camera, of the frames' size.
            plan: the participant, and the order of helps.
            targets: shown in this order under each help.
            settings: when a pose counts as reached, and how long it is held.
            source, seed: for the rows.
            move_board: takes a simulated board to the pose that a person has dragged it to.
        """
        super().__init__(camera, board, written, record)
        self._plan, self._targets = plan, targets
        self._source, self._seed = source, seed
        self._move_board = move_board
        self._settings = settings or Settings()
        self._left: list[Help] = [help_ for help_ in plan.order if help_ not in plan.done]
        self._pose = 0  # index of the pose that is shown
        self._target: Target | None = None
        self._shown_count = 0
        self._tracker = PoseTracker(board, camera.image_size, self._settings)
        self._number = 0
        self._start_s: float | None = None  # of this help; None until its first frame
        self._shown_s = 0.0  # time at which the current pose was shown
        self._first_s: float | None = None  # time at which this help's first pose was finished
        self._by_machine = False
        self._step = 1
        self._note, self._note_until_s = "", 0.0
        self.autopilot = False
        """Whether the simulated hand should move the board."""

    def handle(self, request: Request) -> None:
        """Carry out a person's request."""
        super().handle(request)
        match request:
            case Press("autopilot"):
                self.autopilot = not self.autopilot
            case MoveBoard(pose):
                self.autopilot = False
                self._move_board(pose)
            case _:
                pass

    def say(self, text: str, seconds: float) -> None:
        """Show a sentence for `seconds`, or until the simulated hand moves the board."""
        self._note, self._note_until_s, self._changed = text, self._now_s + seconds, True

    def observe(self, observation: Observation, *, by_machine: bool = False) -> None:
        """Process one frame's observation; `by_machine`: the simulated hand moves the board. Raises
        `CalibrationError` if the frame's size is not the camera's."""
        board, self._changed = observation.board, True
        if board is not None and board != self.board:  # its layout turned out differently
            self.board = board
            self._tracker = PoseTracker(board, self.camera.image_size, self._settings)
        self._now_s = observation.time_s
        self._number += 1
        self._tracker.observe(observation, self.camera, self._target)
        if self._tracker.match is not None:
            self._step = self._tracker.match.active_step
        if self.stage not in ("aim", "hold"):
            return
        if self._start_s is None:
            self._start_s = self._shown_s = self._now_s
        self._by_machine = self._by_machine or by_machine
        held = self._tracker.held_frames >= self._settings.hold_frames
        self._judge(there=self._tracker.is_at_target, held=held)

    def _make_view(self) -> TrialViewModel:
        snapshot, help_ = self.snapshot(), self._help
        begun = self._start_s if self._first_s is None else self._first_s
        running = self.stage in ("aim", "hold") and begun is not None
        return TrialViewModel(
            camera=self.camera,
            board=self.board,
            pose=snapshot.pose,
            target=None if self._target is None else self._target.pose,
            match=snapshot.match,
            stage=self.stage,
            help=help_,
            dark=self._dark,
            seconds=self._now_s - begun if running and begun is not None else 0.0,
            rows=tuple(self.rows),
            written=self._written,
            note=self._note if not self.autopilot and self._now_s < self._note_until_s else "",
            participant=self._plan.participant,
            order=self._plan.order,
            place=self._plan.order.index(help_) + 1,
            number=self._pose + 1,
            poses=len(self._targets),
            step=self._step,
            autopilot=self.autopilot,
            snapshot=snapshot,
        )

    def snapshot(self) -> Snapshot:
        """What a guided calibration would report for the same frame."""
        seen = self._tracker
        phase = "finished" if self.stage == "over" else "guiding"
        remaining = remaining_steps(phase, self._target, seen.match)
        headline, instruction = headline_and_prompt(
            phase, remaining and remaining.current, seen.pose is not None
        )
        return Snapshot(
            number=self._number,
            phase=phase,
            board=self.board,
            camera=self.camera,
            observation=seen.observation,
            pose=seen.pose,
            target=self._target,
            match=seen.match,
            remaining=remaining,
            calibration=None,
            convergence=None,
            history=(),
            headline=headline,
            instruction=instruction,
        )

    # -- the clock and the targets -----------------------------------------------------------------

    def begin(self) -> bool:
        """Show the first pose of the next help. False if none is waiting."""
        if self.stage == "ready":
            self._pose, self._start_s, self._first_s = 0, None, None
        return super().begin()

    def give_up(self) -> bool:
        """Skip to the next pose. False if none is shown, or no frame has come since."""
        return self._start_s is not None and super().give_up()

    @property
    def _help(self) -> Help:
        """The help shown, or the next one; at the end, the last one."""
        return self._left[0] if self._left else self._plan.order[-1]

    def _aim(self) -> None:
        self._shown_count, self._step = self._shown_count + 1, 1
        target = self._targets[self._pose]
        # Never the same number twice: a new number makes the page restart at step 1.
        self._target = unpredicted_target(
            self._shown_count, target, self.camera, self.board, reason="", method="random"
        )
        self._tracker.set_target(self.camera, self._target)

    def _row_of(self, outcome: Outcome) -> ExerciseRow:
        assert self._target is not None and self._start_s is not None
        first_s = self._now_s if self._first_s is None else self._first_s
        match, pose, target = self._tracker.match, self._tracker.pose, self._target.pose
        row = ExerciseRow(
            participant=self._plan.participant,
            number=self._plan.number,
            order=" ".join(self._plan.order),
            attempt=self._plan.attempt(self._help),
            place=self._plan.order.index(self._help) + 1,
            help=self._help,
            pose=self._pose + 1,
            poses=len(self._targets),
            outcome=outcome,
            seconds=self._now_s - self._shown_s,
            since_first_s=self._now_s - first_s,
            since_start_s=self._now_s - self._start_s,
            moved_by="autopilot" if self._by_machine else "person",
            overlap=0.0 if match is None else match.overlap,
            off_mm=NAN if pose is None else 1000 * pose.distance_to(target),
            off_deg=NAN if pose is None else pose.angle_to_deg(target),
            source=self._source,
            seed=self._seed,
            **target_columns(target),
        )
        self._first_s, self._shown_s, self._by_machine = first_s, self._now_s, False
        return row

    def _stage_after(self, outcome: Outcome) -> Stage:
        self._pose += 1
        if self._pose < len(self._targets):
            return "aim"
        self._left.pop(0)
        self._pose, self._target = 0, None
        self._tracker.set_target(self.camera, None)
        return "ready" if self._left else "over"

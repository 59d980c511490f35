"""A trial as a plain state machine: `observe(observation)`, and a snapshot of what is shown.

    ready --begin--> running --last pose--> ready (next help) ... --> over

The camera is known and nothing is calibrated: the same poses are asked for under each help, and
what counts is the time until each is reached and held. Times are those of the frames, so that a
replayed or simulated trial gives the same ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import headline_and_prompt
from venus3d.engine.guidance.tracking import PoseTracker
from venus3d.engine.guidance.work import Settings
from venus3d.engine.planning.target import Target
from venus3d.scene.pages.exercise.trial_plan import Plan
from venus3d.scene.pages.exercise.trial_view_model import (
    Help,
    HelpTimes,
    Stage,
    TrialMoment,
    TrialSnapshot,
)

Outcome = Literal["reached", "given up"]


@dataclass(frozen=True)
class PoseTime:
    """How one pose went."""

    help: Help
    place: int
    """1 ...: of the help, in the participant's order."""
    attempt: int
    pose: int
    """1 ..."""
    outcome: Outcome
    seconds: float
    """From when it was shown."""
    since_first_s: float
    """From when the first pose of this help was done with; 0 for that one."""
    since_start_s: float
    """From the start of this help."""
    overlap: float
    """Of the silhouettes at the end; 0 if the board was not seen."""
    off_mm: float
    """Of the board's centre at the end; NaN if it was not seen."""
    off_deg: float
    """The turn that was left at the end; NaN if it was not seen."""
    target: Pose
    by_machine: bool
    """Whether the simulated hand had the board at any time on the way."""


class TrialSession:
    """One participant's trial. Used by one thread."""

    def __init__(
        self,
        board: Board,
        camera: Camera,
        plan: Plan,
        targets: tuple[Pose, ...],
        record: Callable[[PoseTime], None],
        *,
        settings: Settings | None = None,
        written: str = "",
    ) -> None:
        """
        Args:
            camera: the known camera, of the frames' size.
            plan: who it is, and which helps in which order.
            targets: asked for in this order under each help.
            record: is given each pose as soon as it is done with.
            settings: when a pose counts as reached, and for how long it is held.
            written: where the times are, for the screen.
        """
        self.board, self._camera, self._plan, self._targets = board, camera, plan, targets
        self._record, self._written = record, written
        self._settings = settings or Settings()
        self._left: list[Help] = [help_ for help_ in plan.order if help_ not in plan.done]
        self._stage: Stage = "ready"
        self._pose = 0  # index of the pose that is shown
        self._target: Target | None = None
        self._shown_count = 0
        self._times: list[HelpTimes] = []
        self._seen = PoseTracker(board, camera.image_size, self._settings)
        self._number = 0
        self._now = 0.0
        self._start: float | None = None  # of this help; None until its first frame
        self._shown = 0.0  # when the present pose was
        self._first: float | None = None  # when the first pose of this help was done with
        self._by_machine = False

    @property
    def stage(self) -> Stage:
        """Where the trial stands."""
        return self._stage

    @property
    def times(self) -> tuple[HelpTimes, ...]:
        """How the helps went so far."""
        return tuple(self._times)

    def _use_board(self, board: Board) -> None:
        """Go on with a board whose layout turned out differently."""
        if board != self.board:
            self.board = board
            self._seen = PoseTracker(board, self._camera.image_size, self._settings)

    def begin(self) -> bool:
        """Show the first pose of the next help. False if none is waiting for that."""
        if self._stage != "ready":
            return False
        self._stage, self._pose, self._start, self._first = "running", 0, None, None
        self._times.append(HelpTimes(self._left[0]))
        self._aim()
        return True

    def give_up(self) -> bool:
        """Go on to the next pose. False if none is shown."""
        if self._stage != "running" or self._start is None:
            return False
        self._done("given up")
        return True

    def observe(self, observation: Observation, *, by_machine: bool = False) -> None:
        """Take in what was seen in one frame; `by_machine`: the simulated hand has the board.

        Raises `CalibrationError` if the frame's size is not the camera's.
        """
        if observation.board is not None:
            self._use_board(observation.board)
        self._now = observation.time_s
        self._number += 1
        self._seen.observe(observation, self._camera, self._target)
        if self._stage != "running":
            return
        if self._start is None:
            self._start = self._shown = self._now
        self._by_machine = self._by_machine or by_machine
        if self._seen.held_frames >= self._settings.hold_frames:
            self._done("reached")

    def snapshot(self) -> TrialSnapshot:
        """Everything about this moment."""
        seen = self._seen
        phase = "finished" if self._stage == "over" else "guiding"
        headline, instruction = headline_and_prompt(phase, seen.match, seen.pose is not None)
        return TrialSnapshot(
            number=self._number,
            phase=phase,
            board=self.board,
            camera=self._camera,
            observation=seen.observation,
            pose=seen.pose,
            target=self._target,
            match=seen.match,
            calibration=None,
            convergence=None,
            history=(),
            headline=headline,
            instruction=instruction,
            trial=self._moment(),
        )

    def _moment(self) -> TrialMoment:
        begun = self._start if self._first is None else self._first
        running = self._stage == "running" and begun is not None
        help_ = self._left[0] if self._left else self._plan.order[-1]
        return TrialMoment(
            participant=self._plan.participant,
            stage=self._stage,
            order=self._plan.order,
            place=self._plan.order.index(help_) + 1,
            pose=self._pose + 1,
            poses=len(self._targets),
            elapsed_s=self._now - begun if running and begun is not None else 0.0,
            there=self._seen.is_at_target,
            times=self.times,
            written=self._written,
        )

    def _done(self, outcome: Outcome) -> None:
        assert self._target is not None and self._start is not None
        first = self._now if self._first is None else self._first
        match, help_, pose = self._seen.match, self._left[0], self._seen.pose
        target = self._target.pose
        told = PoseTime(
            help=help_,
            place=self._plan.order.index(help_) + 1,
            attempt=self._plan.attempt(help_),
            pose=self._pose + 1,
            outcome=outcome,
            seconds=self._now - self._shown,
            since_first_s=self._now - first,
            since_start_s=self._now - self._start,
            overlap=0.0 if match is None else match.overlap,
            off_mm=np.nan if pose is None else 1000 * pose.distance_to(target),
            off_deg=np.nan if pose is None else pose.angle_to_deg(target),
            target=target,
            by_machine=self._by_machine,
        )
        self._record(told)
        self._times[-1] = _with(self._times[-1], told)
        self._first, self._shown, self._by_machine = first, self._now, False
        self._pose += 1
        if self._pose == len(self._targets):
            self._left.pop(0)
            self._stage, self._pose = ("ready" if self._left else "over"), 0
        self._aim()

    def _aim(self) -> None:
        self._target = None
        if self._stage == "running":
            self._shown_count += 1
            pose = self._targets[self._pose]
            self._target = Target(
                # Never the same number twice: the page starts again at step 1 on another one.
                number=self._shown_count,
                pose=pose,
                steps=decompose(pose, self._camera, self.board),
                method="random",
                cost="projection-variance",
                serves=(),
                reason="",
                predicted_sigma=np.full(9, np.nan),
                predicted_uncertainty_px=np.nan,
                evaluated=0,
                search_s=0.0,
            )
        self._seen.set_target(self._camera, self._target)


def _with(times: HelpTimes, told: PoseTime) -> HelpTimes:
    reached = told.outcome == "reached"
    counts = reached and told.pose > 1
    return replace(
        times,
        ends_s=(*times.ends_s, told.since_first_s),
        reached_s=(*times.reached_s, told.seconds) if counts else times.reached_s,
        given_up=times.given_up + (not reached),
    )

"""The state of a guided calibration after one observation, as frozen values.
The session fills it, or `pose_snapshot` if another program finds the pose; all else reads it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation, View
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import corners_outside
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.convergence import Convergence, Progress
from venus3d.engine.guidance.loop import Loop
from venus3d.engine.guidance.matching import Match, match
from venus3d.engine.guidance.prompts import (
    GIVEN_REASON,
    ONLY_SHOWN,
    Phase,
    Prompt,
    headline_and_prompt,
)
from venus3d.engine.guidance.remaining import RemainingSteps, remaining_steps
from venus3d.engine.planning.forecast import Forecast
from venus3d.engine.planning.search_trace import SearchTrace
from venus3d.engine.planning.settings import Cost, Method
from venus3d.engine.planning.target import Target, unpredicted_target
from venus3d.engine.planning.uncertainty import ProjectionUncertainty


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A guided calibration at one moment."""

    number: int
    """Counts every observation."""
    phase: Phase
    board: Board
    camera: Camera
    """The best camera known: a guess, the start-up estimate, or the calibration's."""
    observation: Observation
    pose: Pose | None
    """The board's current estimated pose; None while it is not seen."""
    target: Target | None
    match: Match | None
    remaining: RemainingSteps | None
    """What is to be done: the steps from the board as it is held now to the target. None without a
    target, and in a phase in which nothing is to be done."""
    calibration: Calibration | None
    convergence: Convergence | None
    history: tuple[Progress, ...]
    headline: str
    """Two or three words for the state: "Hold still", "Captured", "Step 3 of 4"."""
    instruction: Prompt
    """The one instruction to follow now."""
    warnings: tuple[str, ...] = field(default=())
    diagnoses: tuple[Diagnosis, ...] = field(default=())
    """Reasons why the calibration is less trustworthy than its numbers; worst first."""
    final_diagnoses: tuple[Diagnosis, ...] = ()
    """The same of the calibration alone, as if no more views came."""
    forecast: Forecast | None = None
    """None while unknown."""
    method: Method = "global"
    """How the next poses are found."""
    cost: Cost = "projection-variance"
    """The cost that their search minimises."""
    uncertainty: ProjectionUncertainty | None = None
    """Of the current calibration; None while not all nine parameters are estimated."""
    search_trace: SearchTrace | None = None
    """The search of the current target; None if there was none."""
    taken_back: bool = False
    """Whether the board is still where the last view was taken back: no capture by itself."""
    refusal: str | None = None
    """Why the board, held at its target, is not captured by itself: light, sharpness, motion."""
    run: int = 1
    """Counts the calibrations of this session: each begins without views."""
    captured: tuple[int, ...] | None = None
    """Numbers of the captured views, also of those that are not calibrated with yet; None if none
    are captured here, since another program gives the pose."""
    loop: Loop = field(default=Loop())
    """What the method does now, with its figures."""

    @property
    def views(self) -> tuple[View, ...]:
        """The captured views that the calibration is of."""
        return () if self.calibration is None else self.calibration.views

    @property
    def captured_count(self) -> int:
        """How many views are captured, from the moment when they are."""
        return len(self.captured or ())


def pose_snapshot(
    board: Board,
    camera: Camera,
    pose: Pose | None,
    target: Pose | Target | None = None,
    before: Snapshot | None = None,
) -> Snapshot:
    """The board at a pose, and the remaining steps to a target.

    Args:
        pose: `T_camera_board`; None while the board is not seen.
        target: the pose to reach, if any.
        before: the previous snapshot: needed for hysteresis, and for the board's motion, without
            which no target is reached.
    """
    seen = Observation.nothing(camera.image_size)
    if pose is not None:
        ids = np.setdiff1d(np.arange(board.corner_count), corners_outside(pose, camera, board))
        corners = camera.project(pose.apply(board.points_of(ids)))
        seen = Observation(ids, corners, camera.image_size, board=board)
    aim = _target_at(target, camera, board, before)
    same = before is not None and before.target is aim
    compared = None
    if pose is not None and aim is not None:
        compared = match(
            camera,
            board,
            pose,
            aim.pose,
            observation=seen,
            before=None if before is None else before.observation,
            previous=before.match if before is not None and same else None,
        )
    remaining = remaining_steps("guiding", aim, compared)
    headline, instruction = headline_and_prompt(
        "guiding", remaining and remaining.current, pose is not None
    )
    if pose is not None and aim is None:
        headline, instruction = ONLY_SHOWN
    return Snapshot(
        number=1 if before is None else before.number + 1,
        phase="guiding",
        board=board,
        camera=camera,
        observation=seen,
        pose=pose,
        target=aim,
        match=compared,
        remaining=remaining,
        calibration=None,
        convergence=None,
        history=(),
        headline=headline,
        instruction=instruction,
    )


def _target_at(
    target: Pose | Target | None, camera: Camera, board: Board, before: Snapshot | None
) -> Target | None:
    """The target; the previous snapshot's, if it has the same pose."""
    if target is None or isinstance(target, Target):
        return target
    if before is None or before.target is None:
        return unpredicted_target(1, target, camera, board, reason=GIVEN_REASON)
    old, unchanged = before.target, (before.camera, before.board) == (camera, board)
    if unchanged and np.array_equal(old.pose.matrix, target.matrix):
        return old
    return unpredicted_target(old.number + 1, target, camera, board, reason=GIVEN_REASON)

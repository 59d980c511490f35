"""Decomposition of a pose into four steps that a person can do one by one (3.4, eq. 15).

Step 1 translates the board's centre; steps 2, 3 and 4 turn the board about the camera's fixed X, Y
and Z axes through that centre. From the frontal, upright board this is eq. (15). From any other
orientation R0 the remaining rotation `R R0^T = Rz Ry Rx` is decomposed in the same way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import AXES, Array, Axis, Pose

StepKind = Literal["move", "turn"]
HOME_DISTANCE = 0.5
"""Distance of the frontal board from which the steps start, metres."""


@dataclass(frozen=True, eq=False)
class Step:
    """One of the four steps: a translation or a turn about one fixed axis."""

    number: int
    """1 ... 4."""
    kind: StepKind
    axis: Axis | None
    """The axis of a turn; None for the translation."""
    before: Pose
    after: Pose
    angle_deg: float
    """Signed turn, right-handed, degrees; 0 for the translation."""
    translation: Array
    """(3,) displacement of the centre, metres; zero for a turn."""
    corners_outside: tuple[int, ...]
    """Ids of the inner corners outside the image after this step."""

    @property
    def is_visible(self) -> bool:
        """Whether every corner is in the image after this step."""
        return not self.corners_outside

    @property
    def is_idle(self) -> bool:
        """Whether there is nothing to do: less than half a degree or half a millimetre."""
        return abs(self.angle_deg) < 0.5 and float(np.linalg.norm(self.translation)) < 0.0005


Steps = tuple[Step, Step, Step, Step]


def home_pose(distance: float = HOME_DISTANCE) -> Pose:
    """The frontal, upright board on the optical axis, `distance` metres away."""
    return Pose(np.eye(3), np.array([0.0, 0.0, distance]))


def decompose(target: Pose, camera: Camera, board: Board, start: Pose | None = None) -> Steps:
    """The four steps from `start` (default: `home_pose()`, which gives eq. 15) to `target`.

    Args:
        target, start: `T_camera_board`.
        camera, board: used only to find the corners that leave the image.
    """
    begin = home_pose() if start is None else start
    rest = Pose(target.R @ begin.R.T, np.zeros(3))
    return _steps(begin, target, rest.vector()[:3], camera, board)


def decompose_vector(vector: ArrayLike, camera: Camera, board: Board) -> Steps:
    """The four steps from `home_pose()` that turn by a pose vector's own angles.

    Like `decompose` of its pose, but keeps the angles in gimbal lock, where they are not unique.
    `vector` is (6,): degrees and metres. Raises `PoseError` unless it is six finite numbers.
    """
    target = Pose.from_vector(vector)
    return _steps(home_pose(), target, np.asarray(vector, dtype=np.float64)[:3], camera, board)


def _steps(begin: Pose, target: Pose, angles: Array, camera: Camera, board: Board) -> Steps:
    nothing = np.zeros(3)
    placed = begin.moved(target.t - begin.t)
    outside = corners_outside(placed, camera, board)
    steps = [Step(1, "move", None, begin, placed, 0.0, target.t - begin.t, outside)]
    for number, (axis, angle) in enumerate(zip(AXES, angles, strict=True), start=2):
        before = steps[-1].after
        # End on the target itself, not on the product of three rounded turns.
        after = target if number == 4 else before.turned(axis, float(angle))
        outside = corners_outside(after, camera, board)
        steps.append(Step(number, "turn", axis, before, after, float(angle), nothing, outside))
    return (steps[0], steps[1], steps[2], steps[3])


def corners_outside(pose: Pose, camera: Camera, board: Board) -> tuple[int, ...]:
    """Ids of the board's inner corners that the camera does not see in this pose."""
    pixels = camera.project(pose.apply(board.corners))
    with np.errstate(invalid="ignore"):
        inside = ((pixels >= -0.5) & (pixels < np.array(camera.image_size) - 0.5)).all(axis=1)
    return tuple(int(i) for i in np.flatnonzero(~inside))

"""Three successive turns about fixed axes or the board's own, in any order.
For teaching. Guidance uses the camera's fixed axes in the order X, Y, Z only (`decomposition`)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from venus3d.engine.errors import PoseError
from venus3d.engine.geometry.pose import AXES, Array, Axes, Axis, Pose

ORDERS: tuple[str, ...] = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
"""The six orders of three axes."""
_ALMOST_LOCKED_DEG = 6.0


@dataclass(frozen=True, eq=False)
class Turn:
    """One of three turns in a row."""

    number: int
    """1 ... 3, in order of execution."""
    axis: Axis
    angle_deg: float
    direction: Array
    """(3,) the axis during this turn, camera frame."""
    before: Pose
    after: Pose

    def pose_at(self, fraction: float) -> Pose:
        """The board's pose at `fraction` (0 ... 1) of the turn."""
        turned = Rotation.from_rotvec(np.radians(fraction * self.angle_deg) * self.direction)
        return Pose(np.asarray(turned.as_matrix()) @ self.before.R, self.before.t)


TurnSequence = tuple[Turn, Turn, Turn]


def turns(
    start: Pose, angles_deg: ArrayLike, *, order: str = "xyz", axes: Axes = "fixed"
) -> TurnSequence:
    """The turns of `start` by the angles (3,) about X, Y and Z, degrees, in this order of axes.

    With "fixed" axes each turn is about an axis of the camera, with "own" about a board axis as
    turned by the turns before; always through the board's centre.

    Raises `PoseError` for an order that is none of `ORDERS`.
    """
    if order not in ORDERS:
        raise PoseError(f"There is no order of turns {order!r}; use one of {', '.join(ORDERS)}.")
    angles = np.asarray(angles_deg, dtype=np.float64)
    made: list[Turn] = []
    pose = start
    for number, letter in enumerate(order, start=1):
        i = "xyz".index(letter)
        # The board's own axes start as the camera's, whatever the board's start.
        direction = np.eye(3)[i] if axes == "fixed" else pose.R @ start.R.T[:, i]
        turn = Turn(number, AXES[i], float(angles[i]), direction, pose, pose)
        pose = turn.pose_at(1.0)
        made.append(replace(turn, after=pose))
    return (made[0], made[1], made[2])


def is_near_gimbal_lock(angle_y_deg: float) -> bool:
    """Whether a turn about Y is so near to +-90 degrees that X and Z turn nearly alike."""
    return 90.0 - abs(angle_y_deg) < _ALMOST_LOCKED_DEG

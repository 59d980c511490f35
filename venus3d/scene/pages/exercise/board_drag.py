"""Drags the board itself with the mouse, in any view of the scene.

Through the camera this is dragging in the image: viser's pointer moves on a plane parallel to it,
so the grabbed point stays under the pointer.

    drag            moves in the plane of the view
    Shift + drag    tilts and swings, as if the board were the front of a ball
    Ctrl + drag     rotates about Z, to the right for clockwise
    right button    up for farther, down for nearer
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np

from venus3d.engine.geometry.pose import Pose

Gesture = Literal["move", "tilt", "rotate", "depth"]
TURN_DEG = 180.0
"""Turn of a drag across the whole view."""
_DEPTH_PER_VIEW = 2.0  # natural logarithm of the change per view height
_BINDINGS: tuple[tuple[Gesture, str, str | None], ...] = (
    ("move", "left", None),
    ("tilt", "left", "shift"),
    ("rotate", "left", "cmd/ctrl"),
    ("depth", "right", None),
)


class BoardDrag:
    """Makes one board's node draggable; `follow` tells it the board's pose."""

    def __init__(self, node: Any, dragged: Callable[[Pose], None], pose: Pose) -> None:
        """`dragged` is called with `T_camera_board`, in order, and must not block."""
        self._dragged = dragged
        self._pose = pose
        self._grabbed: tuple[Pose, Any] | None = None
        for gesture, button, modifier in _BINDINGS:
            node.on_drag(button, modifier=modifier)(self._callback(gesture))

    @property
    def is_held(self) -> bool:
        """Whether somebody is dragging the board."""
        return self._grabbed is not None

    def follow(self, pose: Pose) -> None:
        """Update the board's pose."""
        self._pose = pose

    def _callback(self, gesture: Gesture) -> Callable[[Any], Any]:
        # Async, so that viser keeps the events of a drag in order.
        async def moved(event: Any) -> None:
            if event.phase == "start" or self._grabbed is None:
                self._grabbed = (self._pose, event)
            pose, start = self._grabbed
            self._dragged(
                dragged_pose(
                    pose,
                    gesture,
                    np.subtract(event.end_position, start.start_position),
                    np.subtract(event.end_screen_pos, start.start_screen_pos),
                )
            )
            if event.phase == "end":
                self._grabbed = None

        return moved


def dragged_pose(pose: Pose, gesture: Gesture, shift: Any, across: Any) -> Pose:
    """The board's pose after a gesture.

    Args:
        pose: the pose when it was grabbed.
        gesture: the kind of gesture.
        shift: (3,) the pointer's movement in the plane of the view, metres, camera frame.
        across: (2,) the same in widths and heights of the view, right and down.
    """
    if gesture == "move":
        return pose.moved(shift)
    right, down = (float(part) for part in across)
    if gesture == "tilt":
        return pose.turned("x", TURN_DEG * down).turned("y", -TURN_DEG * right)
    if gesture == "rotate":
        return pose.turned("z", TURN_DEG * right)
    z = float(pose.t[2]) * float(np.exp(-_DEPTH_PER_VIEW * down))
    return Pose(pose.R, np.array([pose.t[0], pose.t[1], z]))

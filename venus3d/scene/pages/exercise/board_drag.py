"""Drags the board itself with the mouse, in any view of the scene.

Through the camera this is dragging in the image: viser's pointer moves on a plane parallel to it,
so the grabbed point stays under the pointer.

    drag            moves in the plane that the person sees
    Shift + drag    tilts and swings, as if the board were the front of a ball
    Ctrl + drag     rotates about Z: the grabbed point follows the pointer round the centre
    right button    up for farther, down for nearer
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from venus3d.engine.geometry.pose import Array, Pose

Gesture = Literal["move", "tilt", "rotate", "depth"]
TURN_DEG = 180.0
"""Turn of a drag across the whole view."""
_EDGE_ON = 0.2  # sine of the angle between line of sight and plane
_DEPTH_PER_VIEW = 2.0  # natural logarithm of the change per view height
_BINDINGS: tuple[tuple[Gesture, str, str | None], ...] = (
    ("move", "left", None),
    ("tilt", "left", "shift"),
    ("rotate", "left", "cmd/ctrl"),
    ("depth", "right", None),
)


@dataclass(frozen=True, eq=False)
class Pointer:
    """The way of the mouse pointer since it grabbed the board; points in the camera's frame."""

    eye: Array
    """(3,) where the person looks from."""
    start: Array
    """(3,) the grabbed point."""
    end: Array
    """(3,) the pointer now, on the plane through `start` that is parallel to the view."""
    across: tuple[float, float]
    """The same way in widths and heights of the view, right and down."""


class BoardDrag:
    """Makes one board's node draggable; `follow` tells it the board's pose."""

    def __init__(self, node: Any, dragged: Callable[[Pose, Pose], None], pose: Pose) -> None:
        """`dragged` is called with `T_camera_board` now and when it was grabbed, in order, and must
        not block."""
        self._dragged = dragged
        self._pose = pose
        self._grabbed: tuple[Pose, Any] | None = None
        for gesture, button, modifier in _BINDINGS:
            node.on_drag(button, modifier=modifier)(partial(self._moved, gesture))

    @property
    def is_held(self) -> bool:
        """Whether somebody is dragging the board."""
        return self._grabbed is not None

    def follow(self, pose: Pose) -> None:
        """Update the board's pose."""
        self._pose = pose

    # Async, so that viser keeps the events of a drag in order.
    async def _moved(self, gesture: Gesture, event: Any) -> None:
        if event.phase == "start" or self._grabbed is None:
            self._grabbed = (self._pose, event)
        pose, start = self._grabbed
        right, down = np.subtract(event.end_screen_pos, start.start_screen_pos)
        pointer = Pointer(
            np.array(event.client.camera.position),
            np.array(start.start_position),
            np.array(event.end_position),
            (float(right), float(down)),
        )
        self._dragged(dragged_pose(pose, gesture, pointer), pose)
        if event.phase == "end":
            self._grabbed = None


def dragged_pose(pose: Pose, gesture: Gesture, pointer: Pointer) -> Pose:
    """The board's pose after a gesture; `pose`: when it was grabbed."""
    if gesture == "move":
        return pose.moved(pointer.end - pointer.start)
    if gesture == "rotate":
        return pose.turned("z", _turned_deg(pose.t, pointer))
    right, down = pointer.across
    if gesture == "tilt":
        return pose.turned("x", TURN_DEG * down).turned("y", -TURN_DEG * right)
    z = float(pose.t[2]) * float(np.exp(-_DEPTH_PER_VIEW * down))
    return Pose(pose.R, np.array([pose.t[0], pose.t[1], z]))


def _turned_deg(centre: Array, pointer: Pointer) -> float:
    """The pointer's turn about the board's centre, seen along Z: where its rays meet the plane
    through the centre that is parallel to the picture. A plane seen from its edge has no such
    points; there, the pointer's way to the right counts."""
    rays = np.array([pointer.start, pointer.end]) - pointer.eye
    slope = rays[:, 2] / np.linalg.norm(rays, axis=1)
    ahead = centre[2] - pointer.eye[2]
    if (slope * np.sign(ahead) < _EDGE_ON).any():
        return TURN_DEG * pointer.across[0]
    points = pointer.eye + rays * (ahead / rays[:, 2:])
    (x, y), (u, v) = (points - centre)[:, :2]
    return float(np.degrees(np.arctan2(x * v - y * u, x * u + y * v)))

"""Scene cameras that frame given points, and interpolation between them.

    outside   behind, above and beside the camera: camera and board together
    camera    at the camera, with its own field of view
    holder    behind the board, where its holder stands: left and right are swapped
    above     a map: the camera below, the board above it, right is right

Shapes in a row are viewed from far away and perpendicular to the row, so that equal ones look
equal. A view fits the given points exactly into a window of any shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.lessons.lesson import Viewpoint

FOV_RAD = float(np.radians(42.0))
"""Vertical field of view of all views but the camera's own and those of rows."""
_LONG_LENS_RAD = float(np.radians(9.0))
FLIGHT_SECONDS = 0.6
"""Duration of a flight between two views."""
FILLED, FILLED_IN_GUIDE = 0.88, 0.78
"""Share of the window's width or height, whichever is tighter, that a view fills."""
_BESIDE_THE_PICTURE = 1.06
BEHIND = np.array([0.6, 0.46, 0.55])
"""Direction of the usual view of a guided calibration: from behind, above and beside the camera."""
# From the target point to the eye; screens have -y up, so none may be exactly vertical.
_DIRECTIONS: dict[Viewpoint, tuple[float, float, float]] = {
    "outside": (-0.56, -0.56, -0.61),
    "camera": (0.0, 0.0, -1.0),
    "holder": (0.20, -0.62, 0.76),
    "above": (0.0, -1.0, -0.06),
}
OUTSIDE = -np.array(_DIRECTIONS["outside"]) / np.linalg.norm(_DIRECTIONS["outside"])
"""Direction in which the usual view from outside looks."""
# For a row along x, with no lateral tilt; from slightly above, so that the far axis is seen.
_ABREAST: dict[Viewpoint, tuple[float, float, float]] = {
    "outside": (0.0, -0.4, -1.0),
    "camera": (0.0, 0.0, -1.0),
    "holder": (0.0, -0.4, 1.0),
    "above": (0.0, -1.0, -0.06),
}


@dataclass(frozen=True, eq=False)
class SceneCamera:
    """A viewpoint. Camera frame, metres; -y is up."""

    position: Array
    """(3,) the eye."""
    look_at: Array
    """(3,) the point in the middle of the window."""
    fov_rad: float
    """Vertical field of view."""

    def in_window(self, points: Array, aspect: float) -> Array:
        """(N, 2) where points (N, 3) appear in a window of this width over height: -1 ... 1 to the
        right and down; NaN behind the eye."""
        local = (points - self.position) @ self.axes.T
        ahead = np.where(local[:, 2:] > 0, local[:, 2:], np.nan)
        return local[:, :2] / ahead / np.tan(self.fov_rad / 2) / [aspect, 1.0]

    @cached_property
    def axes(self) -> Array:
        """(3, 3) rows: right, down and forward in the window."""
        return view_axes((self.look_at - self.position)[None])[0]


def view_from(
    viewpoint: Viewpoint, camera: Camera, points: ArrayLike, aspect: float
) -> SceneCamera:
    """The view from `viewpoint` that just holds all the points (N, 3), metres; through the camera,
    it holds the camera's picture instead.

    Args:
        aspect: width over height of the window.
    """
    seen = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    if viewpoint == "camera":
        half = max(camera.height / camera.fy, camera.width / camera.fx / aspect) / 2
        ahead = np.array([0.0, 0.0, max(0.2, float(np.median(seen[:, 2])))])
        return SceneCamera(np.zeros(3), ahead, float(2 * np.arctan(_BESIDE_THE_PICTURE * half)))
    return view_along(-np.array(_DIRECTIONS[viewpoint]), seen, aspect)


def view_abreast(viewpoint: Viewpoint, points: Array, aspect: float) -> SceneCamera:
    """The view of shapes in a row along x: like `view_from`, but level and with a long lens."""
    fov_rad = _LONG_LENS_RAD / max(1.0, aspect)  # a wide window is no reason to go nearer
    return view_along(-np.array(_ABREAST[viewpoint]), points, aspect, fov_rad=fov_rad)


def view_along(
    forward: ArrayLike,
    points: Array,
    aspect: float,
    *,
    fov_rad: float = FOV_RAD,
    filled: float = FILLED,
) -> SceneCamera:
    """The nearest view in this direction (3,) in which the points (N, 3) fill this share of the
    window's width or height."""
    axes = view_axes(np.asarray(forward, dtype=np.float64)[None])
    eye = eyes_along(axes, points, aspect, fov_rad=fov_rad, filled=filled)[0]
    ahead = axes[0, 2]
    depth = max(0.05, float(((points - eye) @ ahead).mean()))
    return SceneCamera(eye, eye + depth * ahead, fov_rad)


def eyes_along(
    axes: Array,
    points: Array,
    aspect: float,
    *,
    fov_rad: float = FOV_RAD,
    filled: float = FILLED,
) -> Array:
    """(D, 3) the eye of the nearest view that holds the points (N, 3), for each of these axes
    (D, 3, 3), rows right, down and forward.

    With the eye at e and the window's slope t, a point p is seen if |p_x - e_x| <= t (p_z - e_z).
    The two bounds on e_x meet where e_z is largest; likewise for y. The farther of the two eyes is
    taken.
    """
    local = np.einsum("dij,nj->dni", axes, points)
    slope = filled * np.tan(fov_rad / 2) * np.array([aspect, 1.0])
    low = (local[:, :, :2] - slope * local[:, :, 2:]).max(axis=1)
    high = (local[:, :, :2] + slope * local[:, :, 2:]).min(axis=1)
    depth = ((high - low) / (2 * slope)).min(axis=1)
    eyes = np.column_stack([(low + high) / 2, depth])
    return np.asarray(np.einsum("dij,di->dj", axes, eyes), np.float64)


def between(start: SceneCamera, end: SceneCamera, fraction: float) -> SceneCamera:
    """The view a `fraction` (0 ... 1) of the way; the eye orbits the target point."""
    share = float(fraction * fraction * (3 - 2 * fraction))  # eases in and out
    look_at = start.look_at + share * (end.look_at - start.look_at)
    arms = start.position - start.look_at, end.position - end.look_at
    lengths = [float(np.linalg.norm(arm)) for arm in arms]
    one, other = (arm / length for arm, length in zip(arms, lengths, strict=True))
    angle = float(np.arccos(np.clip(one @ other, -1.0, 1.0)))
    if angle < 1e-3:
        direction = other
    else:
        direction = np.sin((1 - share) * angle) * one + np.sin(share * angle) * other
        direction = direction / max(float(np.linalg.norm(direction)), 1e-9)
    length = lengths[0] ** (1 - share) * lengths[1] ** share
    fov = start.fov_rad + share * (end.fov_rad - start.fov_rad)
    return SceneCamera(look_at + length * direction, look_at, fov)


def view_axes(forward: Array) -> Array:
    """(D, 3, 3) rows right, down and forward of views along these vectors (D, 3), none vertical."""
    ahead = forward / np.linalg.norm(forward, axis=1, keepdims=True)
    x, z = ahead[:, 0], ahead[:, 2]
    right = np.stack([z, np.zeros_like(z), -x], axis=1)  # down x forward
    right = right / np.linalg.norm(right, axis=1, keepdims=True)
    return np.stack([right, np.cross(ahead, right), ahead], axis=1)

"""Scene cameras that frame given points, and interpolation between them.

    outside   behind, above and beside the camera: camera and board together
    camera    at the camera, with its own field of view
    holder    behind the board, where its holder stands: left and right are swapped
    above     a map: the camera below, the board above it, right is right

Shapes in a row are viewed from far away and perpendicular to the row, so that equal ones look
equal. A view fits the given points exactly into a window of any shape.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

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
_FILLED = 0.88  # of the window's half width or height; the rest is margin
_BESIDE_THE_PICTURE = 1.06
# On a phone the panels cover the lower part of a narrow window.
_PHONE, _COVERED_ON_A_PHONE = 0.62, 0.62
# Height of the target point above the middle there, in half heights.
_VERY_NARROW, _RAISED = 0.55, 0.6
_NARROWEST = 0.4
# From the target point to the eye; screens have -y up, so none may be exactly vertical.
_DIRECTIONS: dict[Viewpoint, tuple[float, float, float]] = {
    "outside": (-0.56, -0.56, -0.61),
    "camera": (0.0, 0.0, -1.0),
    "holder": (0.20, -0.62, 0.76),
    "above": (0.0, -1.0, -0.06),
}
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

    @property
    def axes(self) -> Array:
        """(3, 3) rows: right, down and forward in the window."""
        return _axes(self.look_at - self.position)


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
    forward: ArrayLike, points: Array, aspect: float, *, fov_rad: float = FOV_RAD
) -> SceneCamera:
    """The nearest view in this direction (3,) that holds all the points (N, 3).

    With the eye at e and the window's slope t, a point p is seen if |p_x - e_x| <= t (p_z - e_z).
    The two bounds on e_x meet where e_z is largest; likewise for y, where the slopes up and down
    may differ. The farther of the two eyes is taken.
    """
    axes = _axes(np.asarray(forward, dtype=np.float64))
    local = points @ axes.T
    slope = np.tan(fov_rad / 2) * np.array([aspect, 1.0])
    ahead, back = _FILLED * slope, _FILLED * slope
    if aspect < _PHONE:
        ahead[1] = (1 - 2 * _COVERED_ON_A_PHONE) * slope[1]
    low = (local[:, :2] - ahead * local[:, 2:]).max(axis=0)
    high = (local[:, :2] + back * local[:, 2:]).min(axis=0)
    depth = float(((high - low) / (ahead + back)).min())
    eye = np.append((low + high + (ahead - back) * depth) / 2, depth)
    middle = np.append(eye[:2], max(depth + 0.05, float(local[:, 2].mean())))
    return SceneCamera(eye @ axes, middle @ axes, fov_rad)


def view_kept_wide(eye: Array, at: Array, roomy: float, aspect: float) -> SceneCamera:
    """From `eye` to `at`, (3,) metres; farther away in a window narrower than `roomy` (width over
    height), and on a phone with `at` above the panels."""
    aspect = max(_NARROWEST, aspect)
    offset = max(1.0, roomy / aspect) * (eye - at)
    low = np.zeros(3)
    if aspect < _VERY_NARROW < roomy:
        low[1] = _RAISED * np.tan(FOV_RAD / 2) * float(np.linalg.norm(offset))
    return SceneCamera(at + offset + low, at + low, FOV_RAD)


# The operator's view: behind, above and beside the camera.
_GUIDE_EYE, _GUIDE_AT = np.array([-0.60, -0.42, -0.33]), np.array([0.015, 0.04, 0.235])
_NEAR_TARGET = 0.45
"""Largest target distance, metres, that this view shows at its usual place."""
_ROOMY_ASPECT = 0.9
"""Width over height of a window in which everything fits from there."""


def guiding_view(back: float) -> Callable[[float], SceneCamera]:
    """From behind the camera at camera, board and target, `back` times as far as usual."""
    return partial(view_kept_wide, back * _GUIDE_EYE, back * _GUIDE_AT, _ROOMY_ASPECT)


def steps_back(distance: float) -> float:
    """Factor, 1 ... 2.5, by which to step back to see a target `distance` metres from the camera;
    in halves, so that the view a person has turned to mostly stays."""
    return float(min(2.5, max(1.0, np.ceil(2 * distance / _NEAR_TARGET) / 2)))


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


def _axes(forward: Array) -> Array:
    ahead = forward / np.linalg.norm(forward)
    right = np.cross([0.0, 1.0, 0.0], ahead)  # down x forward
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead]).astype(np.float64)

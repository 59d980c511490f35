"""Through the lens: the undistorted live picture in front of the browser's camera, and the 3D steps
over it.

The browser's camera is a symmetric pinhole in the real camera's place. The picture is a plane in
the scene far behind everything, with its corners on the camera's rays: so it is centred on the
principal point and matches the 3D steps in a window of any shape.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import CASING
from venus3d.render.board_mesh import board_ghost, board_outline
from venus3d.render.palette import ground, step_colour
from venus3d.render.redrawing import looks_alike
from venus3d.render.shapes import LabelShape, LineShape, Shape
from venus3d.render.step_shapes import instruction_shapes
from venus3d.scene.pages.audience.state import AudienceState

_SPARE = 1.2
"""A barrel lens sees more than its pinhole: show up to this factor farther from the centre."""


@dataclass(frozen=True)
class Plane:
    """A picture's edges at one metre from the lens, metres; +y is down."""

    left: float
    top: float
    right: float
    bottom: float

    def fov_rad(self, aspect: float) -> float:
        """The vertical field of view that shows all of it in a window of this aspect."""
        half = max(-self.top, self.bottom, max(-self.left, self.right) / max(aspect, 0.05))
        return 2 * float(np.arctan(half))


def plain_plane(image_size: tuple[int, int]) -> Plane:
    """The plane of an unmodified picture, in the middle of the window."""
    wide = image_size[0] / image_size[1]
    return Plane(-wide / 2, -0.5, wide / 2, 0.5)


@dataclass(frozen=True, eq=False)
class Undistortion:
    """Maps a camera's picture of one size to what a pinhole in its place would see."""

    plane: Plane
    maps: tuple[NDArray[Any], NDArray[Any]]
    """Maps for `cv2.remap`."""

    def straightened(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The picture (H, W, 3) without lens distortion."""
        return np.asarray(cv2.remap(rgb, *self.maps, cv2.INTER_LINEAR), np.uint8)


@lru_cache(maxsize=4)
def undistortion(camera: Camera) -> Undistortion:
    """For pictures of the camera's own image size; cached per camera."""
    low, high = _reach(camera)
    size = camera.image_size
    pinhole = camera.without_distortion()
    f = np.array([camera.fx, camera.fy])
    # As many pixels as the picture has, over the part shown.
    scale = np.array(size) / ((high - low) * f)
    K = np.array(pinhole.K)
    K[0, 0], K[1, 1] = f * scale
    K[:2, 2] = -low * f * scale - 0.5
    maps = cv2.initUndistortRectifyMap(
        camera.K, camera.distortion, np.eye(3), K, size, cv2.CV_16SC2
    )
    plane = Plane(float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return Undistortion(plane, (np.asarray(maps[0]), np.asarray(maps[1])))


def _reach(camera: Camera) -> tuple[Array, Array]:
    """Lowest and highest x, y of the picture's rays at z = 1, (2,) each."""
    w, h = camera.image_size
    centre, f = np.array([camera.cx, camera.cy]), np.array([camera.fx, camera.fy])
    corners = np.array([[-0.5, -0.5], [w - 0.5, h - 0.5]])
    ideal = (corners - centre) / f
    x, y = np.linspace(-0.5, w - 0.5, 33), np.linspace(-0.5, h - 0.5, 33)
    sides = [
        np.stack([np.full(33, -0.5), y], 1),
        np.stack([np.full(33, w - 0.5), y], 1),
        np.stack([x, np.full(33, -0.5)], 1),
        np.stack([x, np.full(33, h - 0.5)], 1),
    ]
    rays = camera.unproject(np.concatenate(sides))
    if not np.isfinite(rays).all():
        return ideal[0], ideal[1]
    return (
        np.maximum(rays.min(axis=0), _SPARE * ideal[0]),
        np.minimum(rays.max(axis=0), _SPARE * ideal[1]),
    )


_GHOST_OPACITY = 0.25
"""Opacity at which the board in the picture shows through."""
_BEHIND = 1.004
"""Relative distance of a line's casing, which the line then hides."""


class LensOverlay:
    """Shapes over the picture, in the colours of a dark ground and without letters, which a mirror
    would reverse. Used by one thread."""

    def __init__(self) -> None:
        self._drawn: tuple[Snapshot, tuple[Shape, ...]] | None = None

    def shapes(self, snapshot: Snapshot | None, look: AudienceState) -> tuple[Shape, ...]:
        """The shapes for this moment; none unless the lens view is on."""
        if not look.lens or snapshot is None or snapshot.remaining is None:
            return ()
        drawn, todo = self._drawn, snapshot.remaining
        if (
            drawn is None
            or drawn[0].camera is not snapshot.camera
            or not looks_alike(drawn[0].remaining, todo)
        ):
            self._drawn = drawn = (snapshot, _shapes(snapshot, todo))
        return drawn[1]


def _shapes(snapshot: Snapshot, todo: RemainingSteps) -> tuple[Shape, ...]:
    board, target = snapshot.board, todo.steps[3].after
    goal = board_outline(board, target, "/target/board", ground(True).target, 4.0)
    if todo.from_upright or todo.is_over:
        return _cased(goal)
    step = todo.step(todo.active).step
    return (*_cased(goal), *_step_shapes(board, snapshot.camera, step))


def _step_shapes(board: Board, camera: Camera, step: Step) -> list[Shape]:
    name, colour = f"/steps/{step.number}", step_colour(step.number, True)
    arrow = instruction_shapes(board, camera, step, dark=True, for_camera=True)
    return [
        *_cased(board_outline(board, step.after, f"{name}/outline", colour, 5.0)),
        board_ghost(board, step.after, f"{name}/after", colour, _GHOST_OPACITY),
        *(shape for shape in arrow if not isinstance(shape, LabelShape)),
    ]


def _cased(line: LineShape) -> tuple[Shape, Shape]:
    """The line with a dark edge, visible on white paper."""
    casing = replace(
        line,
        name=f"{line.name}_casing",
        segments=_BEHIND * line.segments,
        pose=Pose(line.pose.R, _BEHIND * line.pose.t),
        colour=CASING,
        width_px=line.width_px + 4,
    )
    return casing, line

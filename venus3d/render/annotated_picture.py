"""The live camera picture with the target, the active step's end and the corners drawn on it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.shapes import Colour

LivePicture = NDArray[np.uint8] | NDArray[np.uint16]
"""(H, W, 3) BGR or (H, W) grey."""
PICTURE_WIDTH = 640
_TARGET_COLOUR = (255, 255, 255)
_CORNER_COLOUR = (255, 255, 255)
CASING = (20, 20, 20)
# Straight edges of the board are curves behind a lens.
_POINTS_PER_EDGE = 16
_SHIFT = 4  # cv2 draws at 1/16 px


def small_picture(image: LivePicture, width: int = PICTURE_WIDTH) -> NDArray[np.uint8]:
    """An RGB copy of a BGR or grey image, 8 or 16 bit, at most `width` wide."""
    picture = image
    if image.dtype != np.uint8:
        # A 10 or 12 bit camera fills only the lower bits: stretch to the largest value.
        picture = np.rint(image * (255.0 / max(int(image.max()), 1))).astype(np.uint8)
    size = (width, round(picture.shape[0] * width / picture.shape[1]))
    # Halves first: the mean of 2 x 2 pixels is quick, of 3 x 3 it takes five times as long.
    while picture.shape[1] >= 2 * width:
        half = (picture.shape[1] // 2, picture.shape[0] // 2)
        picture = cv2.resize(picture, half, interpolation=cv2.INTER_AREA)
    if picture.shape[1] > width:
        picture = cv2.resize(picture, size, interpolation=cv2.INTER_LINEAR)
    code = cv2.COLOR_GRAY2RGB if picture.ndim == 2 else cv2.COLOR_BGR2RGB
    return np.asarray(cv2.cvtColor(picture, code), dtype=np.uint8)


def annotate(
    rgb: NDArray[np.uint8],
    snapshot: Snapshot,
    observation: Observation | None,
    step: int,
    colour: Colour,
) -> NDArray[np.uint8]:
    """Draw on an RGB picture, in place: the target's outline (dashed, white), the board's after
    `step` (solid, in the step's colour), and the detected corners, in pixels of the observation's
    own image size."""
    camera = snapshot.camera.scaled((rgb.shape[1], rgb.shape[0]))
    remaining = snapshot.remaining
    if remaining is not None:
        target = outline_of(camera, snapshot.board, remaining.steps[3].after)
        draw_dashes(rgb, target, _TARGET_COLOUR, 2)
        if not remaining.from_upright:
            end = remaining.steps[step - 1].after
            draw_line(rgb, outline_of(camera, snapshot.board, end), colour, 4, closed=True)
            mark_top(rgb, camera, snapshot.board, end, colour)
    seen = snapshot.observation if observation is None else observation
    if seen.count:
        scale = np.array([rgb.shape[1], rgb.shape[0]]) / np.asarray(seen.image_size)
        # A line from a point to itself is a dot. All in one call: each lets other threads in, and
        # hundreds of circles took a third of the time that the picture has.
        dots = list(_fixed(((seen.corners + 0.5) * scale - 0.5)[:, None].repeat(2, axis=1)))
        for ink, width in ((CASING, 7), (_CORNER_COLOUR, 4)):
            cv2.polylines(rgb, dots, False, ink, width, cv2.LINE_AA, _SHIFT)
    return rgb


def outline_of(camera: Camera, board: Board, pose: Pose) -> Array:
    """(4 * n, 2) pixels around the board; NaN outside the lens model."""
    corners = board.outline
    along = np.linspace(0.0, 1.0, _POINTS_PER_EDGE, endpoint=False)[:, None]
    edges = [a + along * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]
    return camera.project(pose.apply(np.concatenate(edges)))


def draw_line(
    rgb: NDArray[np.uint8], points: Array, colour: Colour, width: int, *, closed: bool
) -> None:
    """A line through points (N, 2) in pixels, with a dark casing, in place; NaN leaves a gap."""
    whole = np.vstack([points, points[:1]]) if closed else points
    _stroke(rgb, _runs(whole), colour, width)


def draw_dashes(rgb: NDArray[np.uint8], points: Array, colour: Colour, width: int) -> None:
    """Every second edge of the line through points (N, 2) in pixels, as `draw_line` draws it."""
    ends = points[: len(points) // 2 * 2].reshape(-1, 2, 2)
    kept = ends[_drawable(ends).all(axis=1)]
    _stroke(rgb, list(_fixed(kept)), colour, width)


def _runs(points: Array) -> list[NDArray[np.int32]]:
    """The drawable parts (n, 2) of a line, in 1/16 px."""
    good = _drawable(points)
    if good.all():
        return [_fixed(points)]
    breaks = np.flatnonzero(np.diff(good)) + 1
    parts = zip(np.split(points, breaks), np.split(good, breaks), strict=True)
    return [_fixed(part) for part, is_good in parts if is_good[0] and len(part) > 1]


def _drawable(points: Array) -> NDArray[np.bool_]:
    # Far outside the picture, cv2's fixed-point coordinates would overflow.
    with np.errstate(invalid="ignore"):
        return np.asarray((np.abs(points) < 1e4).all(axis=-1), dtype=np.bool_)


def _fixed(points: Array) -> NDArray[np.int32]:
    return np.round(points * 16).astype(np.int32)


def _stroke(
    rgb: NDArray[np.uint8], runs: list[NDArray[np.int32]], colour: Colour, width: int
) -> None:
    for ink, thickness in ((CASING, width + 3), (colour, width)):
        cv2.polylines(rgb, runs, False, ink, thickness, cv2.LINE_AA, _SHIFT)


def mark_top(
    rgb: NDArray[np.uint8], camera: Camera, board: Board, pose: Pose, colour: Colour
) -> None:
    """A short spike on the top edge that shows which way up the board is."""
    h = board.height
    spike = np.array([[-0.08 * h, -0.5 * h, 0], [0, -0.62 * h, 0], [0.08 * h, -0.5 * h, 0]])
    draw_line(rgb, camera.project(pose.apply(spike)), colour, 3, closed=False)

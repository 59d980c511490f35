"""The two other helps of a trial, drawn into the live picture: axes, and a filled silhouette. As
published, they use no words. Lines and letters are thick enough for two metres; the colours suit
colour-blind people and never stand alone: axes have letters, the target's are dashed."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.annotated_picture import (
    CASING,
    draw_dashes,
    draw_line,
    mark_top,
    outline_of,
)
from venus3d.render.palette import mixed, step_colour
from venus3d.render.shapes import Colour

Picture = NDArray[np.uint8]
AXIS_COLOURS: tuple[Colour, Colour, Colour] = (step_colour(2), step_colour(3), step_colour(4))
"""X, Y, Z: each in the colour of the step that turns about it."""
TARGET_FILL: Colour = (255, 176, 32)
BOARD_FILL: Colour = (235, 240, 245)
OVERLAP_FILL: Colour = (40, 120, 255)
_AXIS_LENGTH = 0.6  # of the board's shorter side
_POINTS = 13  # along an axis, which a lens bends
_OPACITY = 0.6


def draw_axes(
    rgb: Picture,
    camera: Camera,
    board: Board,
    now: Pose | None,
    target: Pose,
    letters: float = 1.0,
) -> None:
    """Draw the axes of the current board (solid) and of the target (dashed) on an RGB picture, in
    place. The camera may have another image size. A small picture needs larger `letters`."""
    seen = camera.scaled((rgb.shape[1], rgb.shape[0]))
    length = _AXIS_LENGTH * min(board.width, board.height)
    letter_scale = letters * rgb.shape[1] / 1000
    if now is not None:
        _frame(rgb, seen, now, length, letter_scale, dashed=False)
    _frame(rgb, seen, target, length, letter_scale, dashed=True)


def draw_outline(
    rgb: Picture, camera: Camera, board: Board, now: Pose | None, target: Pose
) -> None:
    """Fill the target's silhouette on an RGB picture, in place, with another colour where the board
    covers it; top edges have a spike. The camera may have another image size."""
    seen = camera.scaled((rgb.shape[1], rgb.shape[0]))
    wanted = _mask(rgb, seen, board, target)
    covered = np.zeros_like(wanted) if now is None else _mask(rgb, seen, board, now)
    _fill(rgb, wanted & ~covered, TARGET_FILL)
    _fill(rgb, wanted & covered, OVERLAP_FILL)
    width = _stroke(rgb)
    for pose, colour in ((now, BOARD_FILL), (target, TARGET_FILL)):
        if pose is not None:
            draw_line(rgb, outline_of(seen, board, pose), colour, width, closed=True)
            mark_top(rgb, seen, board, pose, colour)


def _stroke(rgb: Picture) -> int:
    """Width of a line that is visible from two metres, pixels."""
    return max(2, round(rgb.shape[1] / 240))


def _frame(
    rgb: Picture, camera: Camera, pose: Pose, length: float, letter_scale: float, *, dashed: bool
) -> None:
    along = np.linspace(0.0, 1.0, _POINTS)[:, None]
    # Farthest first, so that nearer parts cover it.
    for axis in sorted(range(3), key=lambda i: -float(pose.R[2, i])):
        points = camera.project(pose.apply(along * length * np.eye(3)[axis]))
        colour, width = AXIS_COLOURS[axis], _stroke(rgb)
        if dashed:
            colour = mixed(colour, (255, 255, 255), 0.35)
            draw_dashes(rgb, points, colour, width)
            _head(rgb, points, colour, width)
        else:
            draw_line(rgb, points, colour, width + 3, closed=False)
        name = "XYZ"[axis]
        _letter(rgb, points, name + "'" if dashed else name, colour, letter_scale)
    _dot(rgb, camera.project(pose.t[None])[0], hollow=dashed)


def _head(rgb: Picture, points: Array, colour: Colour, width: int) -> None:
    tip, direction = points[-1], points[-1] - points[0]
    norm = float(np.linalg.norm(direction))
    if not np.isfinite(norm) or norm < 1:
        return
    ahead = direction / norm * 4 * width
    aside = np.array([-ahead[1], ahead[0]]) * 0.6
    head = np.array([tip - ahead + aside, tip, tip - ahead - aside])
    draw_line(rgb, head, colour, width, closed=False)


def _letter(rgb: Picture, points: Array, text: str, colour: Colour, scale: float) -> None:
    tip, direction = points[-1], points[-1] - points[0]
    norm = float(np.linalg.norm(direction))
    if not (np.isfinite(norm) and (np.abs(tip) < 1e4).all()):
        return
    place = tip + (direction / norm if norm > 1 else np.array([1.0, -1.0])) * 26 * scale
    (w, h), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 2)
    corner = (round(place[0] - w / 2), round(place[1] + h / 2))
    # On a disc: over the board's pattern a letter would be unreadable.
    disc, thickness = (round(place[0]), round(place[1])), max(2, round(3 * scale))
    cv2.circle(rgb, disc, round(19 * scale), CASING, -1, cv2.LINE_AA)
    cv2.putText(rgb, text, corner, cv2.FONT_HERSHEY_SIMPLEX, scale, colour, thickness, cv2.LINE_AA)


def _dot(rgb: Picture, place: Array, *, hollow: bool) -> None:
    if np.isfinite(place).all() and (np.abs(place) < 1e4).all():
        centre, radius = (round(place[0]), round(place[1])), 2 * _stroke(rgb)
        cv2.circle(rgb, centre, radius + 2, CASING, -1, cv2.LINE_AA)
        cv2.circle(rgb, centre, radius, (255, 255, 255), 2 if hollow else -1, cv2.LINE_AA)


def _mask(rgb: Picture, camera: Camera, board: Board, pose: Pose) -> NDArray[np.uint8]:
    mask = np.zeros(rgb.shape[:2], np.uint8)
    outline = outline_of(camera, board, pose)
    if np.isfinite(outline).all() and (np.abs(outline) < 1e4).all():
        cv2.fillPoly(mask, [np.round(outline * 16).astype(np.int32)], 255, cv2.LINE_8, 4)
    return mask


def _fill(rgb: Picture, mask: Picture, colour: Colour) -> None:
    # OpenCV, and only where needed: numpy would take longer than the rest of the picture, and this
    # help must be no slower than the others.
    x, y, w, h = cv2.boundingRect(mask)
    part = rgb[y : y + h, x : x + w]
    if part.size:
        flat = np.full_like(part, colour)
        tinted = cv2.addWeighted(part, 1 - _OPACITY, flat, _OPACITY, 0)
        cv2.copyTo(tinted, mask[y : y + h, x : x + w], part)

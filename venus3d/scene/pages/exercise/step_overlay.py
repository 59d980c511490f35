"""Draws the active step into the camera's picture, like the axes and the outline. Lines and labels
only: new arrow meshes for every picture would take longer than all the rest."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.annotated_picture import CASING, draw_line, mark_top, outline_of
from venus3d.render.arrows import arc_point
from venus3d.render.board_mesh import outline_segments
from venus3d.render.palette import ground, step_colour
from venus3d.render.shapes import Colour, LabelShape, LineShape
from venus3d.render.step_shapes import arc_ends, instruction_shapes, protractor
from venus3d.render.text_drawing import paint_labels

Picture = NDArray[np.uint8]
_POINTS = 25  # along an arrow, which an arc or a lens bends
_HEAD = 4.5  # length of an arrow's head, in shaft widths


def draw_step(
    rgb: Picture, camera: Camera, board: Board, target: Pose, step: Step | None
) -> Picture:
    """An RGB picture with the target's outline (thin) and the step's end outline (thick), arrow and
    labels, drawn for a dark ground with dark casings. May draw into `rgb`; the camera may have
    another image size."""
    seen = camera.scaled((rgb.shape[1], rgb.shape[0]))
    width = max(2, round(rgb.shape[1] / 200))
    goal = ground(True).target
    draw_line(rgb, outline_of(seen, board, target), goal, max(1, width - 1), closed=True)
    if step is None:
        mark_top(rgb, seen, board, target, goal)
        return rgb
    colour = step_colour(step.number, True)
    draw_line(rgb, outline_of(seen, board, step.after), colour, width + 1, closed=True)
    mark_top(rgb, seen, board, step.after, colour)
    labels: list[LabelShape] = []
    for shape in instruction_shapes(board, camera, step, dark=True, for_camera=True):
        if isinstance(shape, LabelShape) and shape.in_projection:
            labels.append(shape)
        elif isinstance(shape, LineShape) and shape.in_projection:
            for ends in seen.project(shape.pose.apply(shape.segments)):
                draw_line(rgb, ends, colour, max(1, width - 1), closed=False)
    for points, share in _arrows(board, camera, step):
        _draw_arrow(rgb, seen.project(points), colour, share * width)
    return paint_labels(rgb, labels, seen)


def _arrows(board: Board, camera: Camera, step: Step) -> list[tuple[Array, float]]:
    """Points (N, 3) along each arrow, tail to tip, camera frame, and its thickness."""
    if step.is_idle:
        return []
    along = np.linspace(0, 1, _POINTS)
    if step.axis is None:
        starts = np.vstack([step.before.t, step.before.apply(outline_segments(board)[:, 0])])
        # Straight ahead the arrow is a dot, but the move is visible at the corners.
        ways = starts[:, None] + along[:, None] * step.translation
        return [(way, 1.6 if i == 0 else 0.7) for i, way in enumerate(ways)]
    place = protractor(board, camera, step)
    start, end = arc_ends(step, for_camera=True)
    arc = [arc_point(start + at * (end - start), place.radius) for at in along]
    return [(place.frame.apply(np.array(arc)), 1.6)]


def _draw_arrow(rgb: Picture, points: Array, colour: Colour, width: float) -> None:
    points = points[np.isfinite(points).all(axis=1) & (np.abs(points) < 1e4).all(axis=1)]
    if len(points) < 2:
        return
    tip, far = points[-1], np.linalg.norm(points - points[-1], axis=1)
    head = min(_HEAD * width, 0.6 * float(far.max()))
    if head < 3:  # end-on, it is invisible
        return
    shaft = points[far >= head]
    base = shaft[-1]
    ahead = (tip - base) / np.linalg.norm(tip - base) * head
    aside = 0.55 * np.array([-ahead[1], ahead[0]])
    triangle = np.array([tip - ahead + aside, tip, tip - ahead - aside])
    shaft = np.vstack([shaft, tip - 0.5 * ahead])
    draw_line(rgb, shaft, colour, round(width), closed=False)
    fixed = np.round(triangle * 16).astype(np.int32)
    cv2.polylines(rgb, [fixed], True, CASING, 4, cv2.LINE_AA, 4)
    cv2.fillConvexPoly(rgb, fixed, colour, cv2.LINE_AA, 4)

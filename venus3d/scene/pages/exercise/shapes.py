"""A practice in the scene and in the camera's picture, under each help. The board is the same shape
in both; the help is shapes in the scene, and lines in the picture as a trial draws them: new arrow
meshes for every picture would take longer than all the rest. Names are those of `describe`, plus
/axes/board/x ... and /axes/target/x ..."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import AXES, Array, Pose
from venus3d.languages import cached_by_language
from venus3d.render.annotated_picture import CASING, draw_line, mark_top, outline_of
from venus3d.render.arrows import arc_point
from venus3d.render.board_mesh import board_ghost, board_outline, held_board, outline_segments
from venus3d.render.frustum import camera_shapes
from venus3d.render.palette import ground, mixed, step_colour
from venus3d.render.shapes import Colour, LabelShape, LineShape, Shape
from venus3d.render.step_shapes import arc_ends, instruction_shapes, protractor
from venus3d.render.surroundings import surroundings
from venus3d.render.text_drawing import paint_labels
from venus3d.render.trial_helps import draw_axes, draw_outline
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.view_model import PracticeViewModel

Picture = NDArray[np.uint8]
ORANGE: dict[bool, Colour] = {True: (255, 140, 0), False: (190, 90, 0)}
"""The target's outline in space, on dark and on light ground."""
_LABEL_HEIGHT, _LETTERS = 0.15, 1.7
"""Letters can be read where a low window shows the picture half as large as it is drawn: a label's
share of its height, and how much larger an axis's letter is than in a trial's large picture."""
_AXIS_LENGTH = 0.6  # of the board's shorter side
_DASHES = 7
_POINTS = 25  # along an arrow, which an arc or a lens bends
_HEAD = 4.5  # length of an arrow's head, in shaft widths


def scene_shapes(view: PracticeViewModel) -> tuple[Shape, ...]:
    """All shapes of the trainee's 3D scene."""
    camera = camera_shapes(view.camera, dark=view.dark)
    board = held_board(view.board, view.pose)
    if view.side == "through":
        # From inside the camera, only the edge of its picture is visible.
        camera = tuple(shape for shape in camera if shape.name == "/camera/border")
        return (*camera, *board, *_help_shapes(view, for_camera=True))
    around: list[Shape] = []
    if view.surroundings:
        around = surroundings(view.board, view.pose, view.target, view.dark)
    return (*camera, *board, *around, *_help_shapes(view, for_camera=False))


def picture_background(dark: bool) -> Colour:
    """Background colour of the picture."""
    colours = ground(dark)
    return mixed(colours.background, colours.text, 0.1)


def picture_finish(view: PracticeViewModel) -> Callable[[Any], Any] | None:
    """Draws this help into the picture (H, W, 3) RGB; None for a help that is not drawn."""
    if view.help == "none":
        return None
    camera, board, target, match = view.camera, view.board, view.target, view.match
    step = None if all(match.within) else match.steps[match.active_step - 1]

    def finish(picture: Any) -> Any:
        own = np.ascontiguousarray(picture)
        if view.help == "steps":
            return _draw_step(own, camera, board, target, step)
        if view.help == "axes":
            draw_axes(own, camera, board, view.pose, target, _LETTERS)
        else:
            draw_outline(own, camera, board, view.pose, target)
        return own

    return finish


def _help_shapes(view: PracticeViewModel, *, for_camera: bool) -> list[Shape]:
    board, pose, target = view.board, view.pose, view.target
    if view.help == "steps":
        return _step_shapes(view, for_camera)
    if view.help == "axes":
        return [*_frame(board, pose, "board", view), *_frame(board, target, "target", view)]
    if view.help == "outline":
        colour = ORANGE[view.dark]
        h = board.height
        spike = np.array([[-0.08 * h, -0.5 * h, 0], [0, -0.66 * h, 0], [0.08 * h, -0.5 * h, 0]])
        return [
            board_outline(board, target, "/target/board", colour, 4.0),
            board_ghost(board, target, "/target/fill", colour, 0.45),
            LineShape("/target/top", np.stack([spike[:-1], spike[1:]], 1), target, colour, 4.0),
        ]
    return []


def _step_shapes(view: PracticeViewModel, for_camera: bool) -> list[Shape]:
    board, dark, number = view.board, view.dark, view.match.active_step
    step = view.match.steps[number - 1]
    colour, name = step_colour(number, dark), f"/steps/{number}"
    shapes = list(_goal_shapes(board, view.target, dark))
    if all(view.match.within):
        return shapes
    arrow = instruction_shapes(board, view.camera, step, dark=dark, for_camera=for_camera)
    return [
        *shapes,
        board_outline(board, step.after, f"{name}/outline", colour, 4.0),
        board_ghost(board, step.after, f"{name}/after", colour, 0.4),
        # From outside, an arrow is rarely seen end-on; whatever moves is sent to every trainee.
        *(shape for shape in arrow if for_camera or "/trail_" not in shape.name),
    ]


@cached_by_language(maxsize=64)
def _goal_shapes(board: Board, target: Pose, dark: bool) -> tuple[Shape, ...]:
    """The same objects for the same target, so that they are not redrawn."""
    colour = ground(dark).target
    below = target.apply([0, board.height / 2 + 0.7 * board.square, 0])
    return (
        board_outline(board, target, "/target/board", colour, 2.5),
        LabelShape("/target/label", say.TARGET_LABEL, np.asarray(below), colour),
    )


def _frame(board: Board, pose: Pose, whose: str, view: PracticeViewModel) -> list[Shape]:
    """Three axes with letters: solid for the board, dashed for the target."""
    length = _AXIS_LENGTH * min(board.width, board.height)
    solid = whose == "board"
    ends = np.linspace(0, length, 2 if solid else 2 * _DASHES)
    shapes: list[Shape] = []
    for step, axis, direction in zip((2, 3, 4), AXES, np.eye(3), strict=True):
        colour = step_colour(step, view.dark)
        segments = (ends[:, None] * direction).reshape(-1, 2, 3)
        width = 6.0 if solid else 4.0
        name = f"/axes/{whose}/{axis}"
        tip = pose.apply(1.15 * length * direction)
        letter = axis.upper() + ("" if solid else "'")
        shapes.append(LineShape(name, segments, pose, colour, width))
        shapes.append(LabelShape(f"{name}_label", letter, tip, colour))
    return shapes


def _draw_step(
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
    return paint_labels(rgb, labels, seen, _LABEL_HEIGHT)


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

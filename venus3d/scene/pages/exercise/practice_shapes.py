"""Shapes of a practice, in the scene and in the camera's picture, under each help. The board is the
same shape in both; the help is shapes in the scene, and lines in the picture as a trial draws them.
Names are those of `describe`, plus /axes/board/x ... and /axes/target/x ..."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import AXES, Pose
from venus3d.render.board_mesh import board_ghost, board_outline, board_shape
from venus3d.render.frustum import camera_shapes
from venus3d.render.overlay import AXIS_COLOURS, draw_axes, draw_outline
from venus3d.render.palette import ground, mixed, step_colour
from venus3d.render.shapes import Colour, LabelShape, LineShape, Shape
from venus3d.render.step_shapes import instruction_shapes
from venus3d.scene.pages.exercise.practice_texts import TARGET_LABEL
from venus3d.scene.pages.exercise.step_overlay import draw_step
from venus3d.scene.pages.exercise.view_model import PracticeViewModel

ORANGE: dict[bool, Colour] = {True: (255, 140, 0), False: (190, 90, 0)}
"""The target's outline in space, on dark and on light ground."""
_AXIS_LENGTH = 0.6  # of the board's shorter side
_DASHES = 7


def scene_shapes(view: PracticeViewModel) -> tuple[Shape, ...]:
    """All shapes of the trainee's 3D scene."""
    camera = camera_shapes(view.camera, dark=view.dark)
    if view.side == "through":
        # From inside the camera, only the edge of its picture is visible.
        camera = tuple(shape for shape in camera if shape.name == "/camera/border")
    board = board_shape(view.board, view.pose)
    return (*camera, board, *_help_shapes(view, for_camera=view.side == "through"))


def picture_shapes(view: PracticeViewModel) -> tuple[Shape, ...]:
    """Shapes in the camera's picture; `picture_finish` draws the help into it."""
    return (board_shape(view.board, view.pose),)


def target_picture_shapes(view: PracticeViewModel) -> tuple[Shape, ...]:
    """The board at the target: what the camera should see."""
    return (board_shape(view.board, view.target),)


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
            return draw_step(own, camera, board, target, step)
        draw = draw_axes if view.help == "axes" else draw_outline
        draw(own, camera, board, view.pose, target)
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


@lru_cache(maxsize=64)
def _goal_shapes(board: Board, target: Pose, dark: bool) -> tuple[Shape, ...]:
    """The same objects for the same target, so that they are not redrawn."""
    colour = ground(dark).target
    below = target.apply([0, board.height / 2 + 0.7 * board.square, 0])
    return (
        board_outline(board, target, "/target/board", colour, 2.5),
        LabelShape("/target/label", TARGET_LABEL, np.asarray(below), colour),
    )


def _frame(board: Board, pose: Pose, whose: str, view: PracticeViewModel) -> list[Shape]:
    """Three axes with letters: solid for the board, dashed for the target."""
    length = _AXIS_LENGTH * min(board.width, board.height)
    solid = whose == "board"
    ends = np.linspace(0, length, 2 if solid else 2 * _DASHES)
    shapes: list[Shape] = []
    for axis, direction, bright in zip(AXES, np.eye(3), AXIS_COLOURS, strict=True):
        colour = bright if view.dark else mixed(bright, (0, 0, 0), 0.35)
        segments = (ends[:, None] * direction).reshape(-1, 2, 3)
        width = 6.0 if solid else 4.0
        name = f"/axes/{whose}/{axis}"
        tip = pose.apply(1.15 * length * direction)
        letter = axis.upper() + ("" if solid else "'")
        shapes.append(LineShape(name, segments, pose, colour, width))
        shapes.append(LabelShape(f"{name}_label", letter, tip, colour))
    return shapes

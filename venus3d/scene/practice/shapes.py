"""What is seen of a practice moment, in space and in the camera's picture, under each help.

Both are the same shapes; only the axes and the outline are drawn into the picture as a trial draws
them. Names are those of `describe`; the axes are /axes/board/x ... and /axes/target/x ...
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from venus3d.engine.board import Board
from venus3d.engine.pose import AXES, Pose
from venus3d.scene.board_shape import board_ghost, board_outline, board_shape
from venus3d.scene.frustum import camera_shapes
from venus3d.scene.instruction import instruction_shapes
from venus3d.scene.overlay import AXIS_COLOURS, draw_axes, draw_outline
from venus3d.scene.palette import ground, mixed, step_colour
from venus3d.scene.practice.moment import PracticeMoment
from venus3d.scene.shapes import Colour, LabelShape, LineShape, Shape
from venus3d.scene.texts.practice import TARGET_LABEL

ORANGE: dict[bool, Colour] = {True: (255, 140, 0), False: (190, 90, 0)}
"""The target's outline in space, on dark and on light ground."""
_AXIS_LENGTH = 0.6  # of the board's shorter side
_DASHES = 7


def scene_shapes(moment: PracticeMoment) -> tuple[Shape, ...]:
    """Everything in the trainee's 3D scene."""
    camera = camera_shapes(moment.camera, dark=moment.dark)
    if moment.look == "through":
        # Whoever looks out of the camera sees nothing of it but where its picture ends.
        camera = tuple(shape for shape in camera if shape.name == "/camera/border")
    board = board_shape(moment.board, moment.pose)
    return (*camera, board, *_help_shapes(moment, for_camera=moment.look == "through"))


def picture_shapes(moment: PracticeMoment) -> tuple[Shape, ...]:
    """What the camera's picture shows besides what `picture_finish` draws into it."""
    board = board_shape(moment.board, moment.pose)
    return (board, *(_help_shapes(moment, for_camera=True) if moment.help == "steps" else ()))


def target_picture_shapes(moment: PracticeMoment) -> tuple[Shape, ...]:
    """The board at the target: what the camera should see."""
    return (board_shape(moment.board, moment.target),)


def picture_background(dark: bool) -> Colour:
    """Colour of the picture where nothing stands."""
    colours = ground(dark)
    return mixed(colours.background, colours.text, 0.1)


def picture_finish(moment: PracticeMoment) -> Callable[[Any], Any] | None:
    """Draws this help into the picture (H, W, 3) RGB, if it is one that is drawn."""
    if moment.help not in ("axes", "outline"):
        return None
    draw = draw_axes if moment.help == "axes" else draw_outline

    def finish(picture: Any) -> Any:
        own = np.ascontiguousarray(picture)
        draw(own, moment.camera, moment.board, moment.pose, moment.target)
        return own

    return finish


def _help_shapes(moment: PracticeMoment, *, for_camera: bool) -> list[Shape]:
    board, pose, target = moment.board, moment.pose, moment.target
    if moment.help == "steps":
        return _step_shapes(moment, for_camera)
    if moment.help == "axes":
        return [*_frame(board, pose, "board", moment), *_frame(board, target, "target", moment)]
    if moment.help == "outline":
        colour = ORANGE[moment.dark]
        h = board.height
        spike = np.array([[-0.08 * h, -0.5 * h, 0], [0, -0.66 * h, 0], [0.08 * h, -0.5 * h, 0]])
        return [
            board_outline(board, target, "/target/board", colour, 4.0),
            board_ghost(board, target, "/target/fill", colour, 0.45),
            LineShape("/target/top", np.stack([spike[:-1], spike[1:]], 1), target, colour, 4.0),
        ]
    return []


def _step_shapes(moment: PracticeMoment, for_camera: bool) -> list[Shape]:
    board, dark, number = moment.board, moment.dark, moment.match.active_step
    step = moment.match.steps[number - 1]
    colours, colour = ground(dark), step_colour(number, dark)
    below = moment.target.apply([0, board.height / 2 + 0.7 * board.square, 0])
    shapes: list[Shape] = [
        board_outline(board, moment.target, "/target/board", colours.target, 2.5),
        LabelShape("/target/label", TARGET_LABEL, np.asarray(below), colours.target),
    ]
    if all(moment.match.within):
        return shapes
    name = f"/steps/{number}"
    return [
        *shapes,
        board_outline(board, step.after, f"{name}/outline", colour, 4.0),
        board_ghost(board, step.after, f"{name}/after", colour, 0.4),
        *instruction_shapes(board, moment.camera, step, dark=dark, for_camera=for_camera),
    ]


def _frame(board: Board, pose: Pose, whose: str, moment: PracticeMoment) -> list[Shape]:
    """Three axes with letters: solid for the board, dashed for the target."""
    length = _AXIS_LENGTH * min(board.width, board.height)
    solid = whose == "board"
    ends = np.linspace(0, length, 2 if solid else 2 * _DASHES)
    shapes: list[Shape] = []
    for axis, direction, bright in zip(AXES, np.eye(3), AXIS_COLOURS, strict=True):
        colour = bright if moment.dark else mixed(bright, (0, 0, 0), 0.35)
        segments = (ends[:, None] * direction).reshape(-1, 2, 3)
        width = 6.0 if solid else 4.0
        name = f"/axes/{whose}/{axis}"
        tip = pose.apply(1.15 * length * direction)
        letter = axis.upper() + ("" if solid else "'")
        shapes.append(LineShape(name, segments, pose, colour, width))
        shapes.append(LabelShape(f"{name}_label", letter, tip, colour))
    return shapes

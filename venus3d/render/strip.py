"""All four steps at once, two above two, for teaching: each with its board before and after, and
its arrow."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from venus3d.engine.amounts import step_amount
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render import texts
from venus3d.render.board_mesh import board_outline, board_shape
from venus3d.render.palette import ground, step_colour, step_style
from venus3d.render.shapes import (
    FrustumShape,
    GridShape,
    LabelShape,
    LineShape,
    MeshShape,
    PointShape,
    Shape,
)
from venus3d.render.step_shapes import instruction_shapes, pose_during

STRIP_CENTRE = (0.0, -0.5, 0.55)
"""Middle of the strip in the camera's frame, metres; above everything drawn in place."""
_STRIP = "/strip/"
_GAP, _CAPTION = 0.3, 0.55
"""Gap between two steps, and room for a caption above one, in board widths."""


def strip_shapes(
    board: Board,
    steps: Sequence[Step],
    *,
    dark: bool,
    active: int,
    sweep: float,
    done: Sequence[bool] = (False,) * 4,
    from_above: bool = False,
) -> list[Shape]:
    """The four steps in two rows about `STRIP_CENTRE`, none touching another; one that is `done`
    has no arrow. The rows are above each other; `from_above`, where that would hide one, the second
    is nearer to the camera."""
    cells = [
        _cell(board, s, dark, sweep if s.number == active else 1.0, instruct=not is_done)
        for s, is_done in zip(steps, done, strict=True)
    ]
    boxes = np.array([bounds_of(cell) for cell in cells])
    gap, room = _GAP * board.width, _CAPTION * board.width
    axis, up = (2, 1.0) if from_above else (1, -1.0)
    # (2, 2) sizes by row and column; the caption stands above its step.
    size = (boxes[:, 1] - boxes[:, 0]).reshape(2, 2, 3)
    widths, heights = size[..., 0].max(axis=0), size[..., axis].max(axis=1) + room
    shapes: list[Shape] = []
    for i, (step, is_done, cell, box) in enumerate(zip(steps, done, cells, boxes, strict=True)):
        row, column = divmod(i, 2)
        x = (-(widths[1] + gap) / 2, (widths[0] + gap) / 2)[column]
        higher = up * np.eye(3)[axis]
        middle = np.array(STRIP_CENTRE) + x * np.eye(3)[0]
        middle += ((heights[1] / 2, -heights[0] / 2)[row] - room / 2) * higher
        centre = step.after.t.copy()
        centre[[0, axis]] = box.mean(axis=0)[[0, axis]]
        shapes += [moved_shape(shape, Pose(np.eye(3), middle - centre)) for shape in cell]
        above = middle + heights[row] / 2 * higher
        text, colour = caption(step, is_done), step_colour(step.number, dark)
        name = f"/strip/{step.number}/caption"
        shapes.append(LabelShape(name, text, above, colour, in_motion=_title(step)))
    return shapes


def caption(step: Step, done: bool = False) -> str:
    """Number, word and amount: "2 Tilt +30°"."""
    amount = texts.DONE if done else "" if step.is_idle else step_amount(step)
    return f"{_title(step)} {amount}".rstrip()


def _title(step: Step) -> str:
    return f"{step.number} {step_style(step.number).short_title}"


def _cell(board: Board, step: Step, dark: bool, sweep: float, *, instruct: bool) -> list[Shape]:
    name = f"/strip/{step.number}"
    colour = step_colour(step.number, dark)
    cell: list[Shape] = [
        board_shape(board, pose_during(step, sweep), f"{name}/board"),
        board_outline(board, step.after, f"{name}/outline", colour, 3.0),
        board_outline(board, step.before, f"{name}/before", ground(dark).ghost, 2.0),
    ]
    if instruct:
        instruction = instruction_shapes(
            board, None, step, dark=dark, prefix="/strip", for_camera=True, sweep=sweep
        )
        # The caption says how much.
        cell += [shape for shape in instruction if shape.name != f"{name}/label"]
    return cell


def shows_strip(shapes: Iterable[Shape]) -> bool:
    """Whether the strip is among these shapes."""
    return any(shape.name.startswith(_STRIP) for shape in shapes)


def bounds_of(shapes: Sequence[Shape]) -> Array:
    """(2, 3) lowest and highest coordinates of the shapes, camera frame, metres."""
    points: list[Array] = []
    for shape in shapes:
        if isinstance(shape, MeshShape):
            points.append(shape.pose.apply(shape.mesh.vertices))
        elif isinstance(shape, LineShape):
            points.append(shape.pose.apply(shape.segments.reshape(-1, 3)))
        elif isinstance(shape, LabelShape):
            points.append(shape.position[None])
    everything = np.vstack(points)
    return np.stack([everything.min(axis=0), everything.max(axis=0)])


def moved_shape(shape: Shape, by: Pose) -> Shape:
    """The shape moved by `by`; frustum, points and floor stay."""
    if isinstance(shape, LabelShape):
        return replace(shape, position=by.apply(shape.position))
    if isinstance(shape, FrustumShape | PointShape | GridShape):
        return shape
    return replace(shape, pose=by @ shape.pose)

"""The scene at one moment as a list of named shapes, which both renderers draw.

Names are stable paths, and none is a prefix of another. All poses are in the camera's frame.

    /camera/frustum, /camera/border, /camera/axis    the camera; its true border; principal point
    /camera/axes/x, /camera/axes/x_label             and y, z
    /board/live, /board/back                         the board as held now, and what its back says
    /target/board, /target/label                     the goal
    /steps/N/outline                                 where the board is after step N; of the other
                                                     steps only when asked for
    /steps/N/before, /steps/N/after                  active step only: faint outline; tinted board
    /steps/N/arrow, /steps/N/label                   active step only, unless done: what, how much
    /steps/N/sector, axis, axis_label                active turn only
    /steps/N/trail_1 ... trail_4                     active move only: the same at the corners
    /strip/N/...                                     the same with /strip/N/caption, side by side
    /ground/grid, /ground/below_board, below_target  floor and drop lines (`surroundings.py`)
    /figure/body, /figure/left_upper_arm ...         who holds the board
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.amounts import step_amount
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step, Steps
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.languages import cached_by_language
from venus3d.render import texts
from venus3d.render.board_mesh import board_ghost, board_outline, board_shape, held_board
from venus3d.render.frustum import camera_shapes
from venus3d.render.palette import ground, mixed, step_colour
from venus3d.render.shapes import LabelShape, Shape
from venus3d.render.step_shapes import instruction_shapes, pose_during
from venus3d.render.strip import caption, strip_shapes
from venus3d.render.surroundings import surroundings


@dataclass(frozen=True)
class SceneOptions:
    """What the user chooses to see in the scene."""

    step: int = 1
    """The active step, 1 ... 4."""
    strip: bool = False
    """All four steps at once, and nothing else, instead of the active one in place."""
    dark: bool = True
    sweep: float = 1.0
    """Progress of the active step's board, 0 (before) ... 1 (after)."""
    show_live: bool = True
    """Whether the current board is drawn."""
    all_steps: bool = False
    """Whether the other steps' ends are drawn too."""
    surroundings: bool = True
    """Whether floor, drop lines and the board's holder are drawn."""


def describe(
    snapshot: Snapshot, options: SceneOptions, drawn: RemainingSteps | None = None
) -> tuple[Shape, ...]:
    """All shapes of this snapshot; runs no algorithm of the engine. Unchanged shapes are the same
    objects as in the last call, so that a renderer can skip them by identity.

    Args:
        drawn: steps of an earlier moment whose arrows and boards may stay (`redrawing.py`). The
            amounts are always this moment's.
    """
    board, camera, now = snapshot.board, snapshot.camera, snapshot.remaining
    if now is None:
        still = static_shapes(camera, board, None, options)
        if snapshot.target is not None:
            still = (*still, *_target_shapes(board, snapshot.target.pose, options.dark))
    else:
        steps = now if drawn is None else drawn
        still = static_shapes(camera, board, steps.steps, options, now.done)
        if steps is not now:
            still = tuple(_with_amount(shape, now) for shape in still)
    if options.strip and now is not None:
        return still
    pose = snapshot.pose if options.show_live else None
    if options.surroundings:
        goal = None if snapshot.target is None else snapshot.target.pose
        still = (*still, *surroundings(board, pose, goal, options.dark))
    return still if pose is None else (*still, *held_board(board, pose))


@cached_by_language(maxsize=16)
def static_shapes(
    camera: Camera,
    board: Board,
    steps: Steps | None,
    options: SceneOptions,
    done: tuple[bool, ...] = (False,) * 4,
) -> tuple[Shape, ...]:
    """All but the current board. A step that is `done` has no arrow."""
    if steps is not None and options.strip:
        active, sweep = options.step, options.sweep
        return tuple(
            strip_shapes(board, steps, dark=options.dark, active=active, sweep=sweep, done=done)
        )
    shapes: list[Shape] = [*camera_shapes(camera, dark=options.dark)]
    if steps is None:
        return tuple(shapes)
    # The last step ends on the target.
    shapes += _target_shapes(board, steps[3].after, options.dark)
    for step, is_done in zip(steps, done, strict=True):
        if step.number == options.step:
            shapes += active_shapes(board, camera, step, options, instruct=not is_done)
        elif (
            options.all_steps and not step.is_idle and step.number != 4
        ):  # step 4 ends where the target is drawn
            full = step_colour(step.number, options.dark)
            quiet = mixed(full, ground(options.dark).background, 0.5)
            name = f"/steps/{step.number}/outline"
            shapes.append(board_outline(board, step.after, name, quiet, 1.5))
    return tuple(shapes)


def describe_step(
    board: Board, camera: Camera, step: Step, *, dark: bool = False, instruct: bool = True
) -> tuple[Shape, ...]:
    """One step as its projection shows it: the board after it, its outline before, and arrows if
    there is something to do and it shall `instruct`."""
    colours = ground(dark)
    name = f"/steps/{step.number}"
    shapes: list[Shape] = [board_shape(board, step.after, f"{name}/board")]
    if instruct and not step.is_idle:
        before = board_outline(board, step.before, f"{name}/before", colours.ghost, 2.5)
        # A board that comes nearer would hide where it started.
        shapes.append(replace(before, on_top=step.axis is None))
        shapes += instruction_shapes(board, camera, step, dark=dark, for_camera=True)
    return tuple(shapes)


def active_shapes(
    board: Board, camera: Camera, step: Step, options: SceneOptions, *, instruct: bool = True
) -> list[Shape]:
    """The active step in place: before, after, and what to do."""
    colours = ground(options.dark)
    colour = step_colour(step.number, options.dark)
    name = f"/steps/{step.number}"
    shapes: list[Shape] = [board_outline(board, step.after, f"{name}/outline", colour, 4.0)]
    if step.is_idle or not instruct:
        return [*shapes, board_ghost(board, step.after, f"{name}/after", colour)]
    shapes.append(board_outline(board, step.before, f"{name}/before", colours.ghost, 2.0))
    shapes.append(
        board_ghost(board, pose_during(step, options.sweep), f"{name}/after", colour, 0.45)
    )
    return [
        *shapes,
        *instruction_shapes(board, camera, step, dark=options.dark, sweep=options.sweep),
    ]


def _with_amount(shape: Shape, now: RemainingSteps) -> Shape:
    """A step's label or caption with the amount of this moment."""
    _, where, *rest = shape.name.split("/")
    if not isinstance(shape, LabelShape) or where not in ("steps", "strip"):
        return shape
    step, text = now.step(int(rest[0])), shape.text
    if rest[1] == "label":
        text = step_amount(step.step)
    elif rest[1] == "caption":
        text = caption(step.step, step.done)
    return shape if text == shape.text else replace(shape, text=text)


@cached_by_language(maxsize=16)
def _target_shapes(board: Board, pose: Pose, dark: bool) -> tuple[Shape, ...]:
    colours = ground(dark)
    outline = board_outline(board, pose, "/target/board", colours.target, 2.0)
    below = pose.apply([0, board.height / 2 + 0.7 * board.square, 0])
    return outline, LabelShape(
        "/target/label", texts.TARGET_LABEL, np.asarray(below), colours.target
    )

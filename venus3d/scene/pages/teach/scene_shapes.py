"""The shapes of a teaching page, in 3D and in the camera's picture. `render.describe` and
`render.strip` describe the steps as in a calibration; this module adds the moving board and the
camera's picture."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from venus3d.engine.amounts import degrees, size_mm
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.decomposition import HOME_DISTANCE, Step
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.lessons.lesson import Arrangement
from venus3d.render.board_mesh import board_ghost, board_outline, board_shape, held_board
from venus3d.render.describe import SceneOptions, static_shapes
from venus3d.render.framing import content_of, good_direction
from venus3d.render.frustum import AXIS_LENGTH, border_segments
from venus3d.render.palette import ground
from venus3d.render.shapes import LabelShape, LineShape, Shape
from venus3d.render.step_shapes import instruction_shapes, pose_during
from venus3d.render.strip import bounds_of, strip_shapes
from venus3d.render.surroundings import surroundings
from venus3d.render.viewpoints import (
    OUTSIDE,
    SceneCamera,
    view_abreast,
    view_along,
    view_from,
)
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.comparison import comparison_points, comparison_shapes
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose


def board_pose_at(taught: TaughtPose, state: TeachState) -> Pose:
    """The board's current pose on its path, `T_camera_board`."""
    step, sweep = state.step_and_share
    if step == 4 and sweep == 1.0:
        return taught.pose
    return pose_during(taught.steps[step - 1], sweep)


def shown_step(taught: TaughtPose, state: TeachState) -> int:
    """1 ... 4: the step drawn; at the target, the last one that was not idle."""
    return taught.last_busy if state.at_rest else state.step


def scene_shapes(taught: TaughtPose, state: TeachState) -> tuple[Shape, ...]:
    """All shapes of the 3D scene."""
    camera, board = taught.camera, taught.board
    if state.compares:
        return tuple(comparison_shapes(taught, state))
    if state.arrangement == "strip":
        return tuple(
            strip_shapes(
                board,
                taught.steps,
                dark=state.dark,
                active=state.step,
                sweep=state.sweep,
                from_above=state.viewpoint == "above",
            )
        )
    active = shown_step(taught, state)
    options = SceneOptions(active, dark=state.dark, all_steps=state.all_steps)
    hidden: tuple[str, ...] = ()
    if state.at_rest or state.sweep == 1.0:
        hidden = (f"/steps/{active}/after",)  # the board itself is there
    if state.at_rest and not taught.refusals:
        hidden = (*hidden, "/target/label")
    if state.viewpoint == "camera":
        # From inside the camera, its own picture and axes are in the way.
        hidden = (*hidden, "/camera/frustum", "/camera/ax", "/camera/body")
    grown = _grown_sector(taught, state)
    shapes = [
        grown if grown and shape.name == grown.name else _adapted(shape, taught, state)
        for shape in static_shapes(camera, board, taught.steps, options)
        if not shape.name.startswith(hidden)
    ]
    pose = board_pose_at(taught, state)
    shapes += held_board(board, pose)
    # From inside the camera and from behind the board the figure would be in the way.
    if state.surroundings and state.viewpoint in ("outside", "above"):
        shapes += surroundings(board, pose, taught.pose, state.dark)
    if taught.refusals:
        shapes.append(_refused(taught, state.dark))
    return tuple(shapes)


def _grown_sector(taught: TaughtPose, state: TeachState) -> Shape | None:
    """The sector of the current turn, so far."""
    step = taught.steps[state.step - 1]
    if state.sweep == 1.0 or step.axis is None:
        return None
    shapes = instruction_shapes(
        taught.board, taught.camera, step, dark=state.dark, sweep=state.sweep
    )
    return next((shape for shape in shapes if shape.name.endswith("/sector")), None)


def _refused(taught: TaughtPose, dark: bool) -> Shape:
    # Slightly in front of the board, to avoid flicker.
    sheet = taught.pose @ Pose(np.eye(3), np.array([0.0, 0.0, -0.002]))
    return board_ghost(taught.board, sheet, "/target/refused", ground(dark).warning, 0.4)


def _adapted(shape: Shape, taught: TaughtPose, state: TeachState) -> Shape:
    colours = ground(state.dark)
    if isinstance(shape, LabelShape) and shape.name.startswith("/steps/"):
        # The only label of a step with an amount.
        if shape.name.endswith("/label"):
            text = amount_text(taught.steps[shown_step(taught, state) - 1], state.sweep)
            return replace(shape, text=text)
        return shape
    if taught.refusals and isinstance(shape, LineShape) and shape.name == "/target/board":
        return replace(shape, colour=colours.warning)
    if taught.refusals and isinstance(shape, LabelShape) and shape.name == "/target/label":
        return replace(shape, text=texts.REFUSED_LABEL, colour=colours.warning)
    return shape


def amount_text(step: Step, sweep: float) -> str:
    """The amount done of a step, with unit: "+17°" on the way, "+30°" at its end."""
    if step.axis is None:
        return size_mm(1000 * sweep * float(np.linalg.norm(step.translation)))
    return degrees(sweep * step.angle_deg)


def camera_shapes_at(taught: TaughtPose, state: TeachState) -> tuple[Shape, ...]:
    """Shapes in the camera's picture now: the moving board, its goal, the active step."""
    board, colours = taught.board, ground(state.dark)
    step = taught.steps[shown_step(taught, state) - 1]
    goal = colours.warning if taught.refusals else colours.target
    shapes: list[Shape] = [
        board_shape(board, board_pose_at(taught, state)),
        replace(board_outline(board, taught.pose, "/target/board", goal, 3.0), on_top=True),
    ]
    if taught.refusals:
        shapes.append(_refused(taught, state.dark))
    if not step.is_idle:
        before = board_outline(board, step.before, "/steps/before", colours.ghost, 2.0)
        shapes.append(replace(before, on_top=step.axis is None))
        shapes += [
            replace(shape, text=amount_text(step, state.sweep))
            if isinstance(shape, LabelShape) and shape.name.endswith("/label")
            else shape
            for shape in instruction_shapes(
                board,
                taught.camera,
                step,
                dark=state.dark,
                for_camera=True,
                sweep=state.sweep,
            )
        ]
    return tuple(shapes)


def scene_view_of(
    taught: TaughtPose, state: TeachState, shapes: tuple[Shape, ...], aspect: float
) -> SceneCamera:
    """The scene camera for these shapes in a window of this aspect."""
    points = _points_of_interest(taught, state.arrangement, shapes)
    if state.arrangement != "place":
        return view_abreast(state.viewpoint, points, aspect)
    if state.viewpoint == "outside":
        return view_along(_outside_direction(shapes, aspect), points, aspect)
    return view_from(state.viewpoint, taught.camera, points, aspect)


@lru_cache(maxsize=8)
def _outside_direction(shapes: tuple[Shape, ...], aspect: float) -> Array:
    return good_direction(content_of(shapes), aspect, OUTSIDE)


def _points_of_interest(
    taught: TaughtPose, arrangement: Arrangement, shapes: tuple[Shape, ...]
) -> Array:
    # (N, 3) points that a view of this arrangement must hold, metres.
    if arrangement in ("axes", "order"):
        return comparison_points(taught.board)
    if arrangement == "strip":
        low, high = bounds_of(shapes)
        return np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
    board = taught.board
    return np.concatenate(
        [
            1.4 * AXIS_LENGTH * np.vstack([np.zeros(3), np.eye(3)]),
            border_segments(taught.camera).reshape(-1, 3),
            _around(board, np.array([0.0, 0.0, HOME_DISTANCE])),
            _around(board, taught.pose.t),
        ]
    )


def _around(board: Board, centre: Array) -> Array:
    reach = 0.72 * float(np.hypot(board.width, board.height))
    return centre + reach * np.concatenate([np.eye(3), -np.eye(3)])

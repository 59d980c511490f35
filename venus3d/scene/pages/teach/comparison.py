"""Two boards side by side with their axes, the same three numbers read in two ways: the shapes,
and the words beside them.

/compare/left/board, outline, goal, label, facts    the usual reading: fixed axes, X, Y, Z
/compare/left/x, y, z and x_name, ...               the axes as they stand now
/compare/left/arc, angle                            the turn that is going on
/compare/right/...                                  the other reading
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import Literal

import numpy as np

from venus3d.engine.amounts import degrees, size_deg
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import AXES, Array, Axes, Pose
from venus3d.engine.geometry.rotation_orders import Turn, TurnSequence
from venus3d.render.arrows import arc_arrow, arc_point, frame_along, straight_arrow, turn_frame
from venus3d.render.board_mesh import board_outline, board_shape
from venus3d.render.palette import ground, mixed, step_colour
from venus3d.render.shapes import LabelShape, MeshShape, Shape
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose

Side = Literal["left", "right"]
CENTRES: dict[Side, Array] = {
    "left": np.array([-0.185, 0.0, 0.6]),
    "right": np.array([0.185, 0.0, 0.6]),
}
"""Positions of the two boards for a board as wide as the default one, camera frame, metres."""
_USUAL_WIDTH = 0.252
_AXIS = 0.64  # of the board's width: the axes extend beyond the board
_SHORTEST_ARC_DEG = 12.0


def board_centre(board: Board, side: Side) -> Array:
    """(3,) the centre of this side's board; larger boards are farther apart."""
    return CENTRES[side] * (board.width / _USUAL_WIDTH)


def comparison_points(board: Board) -> Array:
    """(N, 3) points around all shapes here, metres."""
    reach = 1.05 * _AXIS * board.width
    box = np.array(np.meshgrid([-1, 1], [-1.25, 1.1], [-0.6, 0.6])).reshape(3, -1).T * reach
    return np.concatenate([board_centre(board, side) + box for side in CENTRES])


@dataclass(frozen=True)
class ComparisonWords:
    """The comparison's texts at one moment."""

    headline: str
    amount: str
    sentence: str
    turn: int | None = None
    """1 ... 3: the current turn; None before the first and after the last."""
    axis: int = 0
    """0 ... 2: axis of the left board's turn."""


def comparison_words(taught: TaughtPose, state: TeachState) -> ComparisonWords:
    """The texts for this moment."""
    step, sweep = state.step_and_share
    if step == 1:
        return ComparisonWords(texts.COMPARE_START, "", texts.COMPARE_PROMPT)
    if step == 4 and sweep == 1.0:
        apart = taught.apart_deg(state.arrangement)
        same = apart < 0.05
        amount = texts.SAME if same else texts.APART.format(angle=size_deg(apart))
        sentence = texts.SAME_LABEL if same else texts.APART_LABEL
        return ComparisonWords(texts.COMPARE_END, amount, sentence)
    left, right = taught.fixed[step - 2], taught.others(state.arrangement)[step - 2]
    names = {"left": left.axis.upper(), "right": right.axis.upper()}
    alike = left.axis == right.axis
    headline = texts.COMPARE_TURN if alike else texts.COMPARE_TURN_TWO
    sentence = texts.COMPARE_SENTENCES[state.arrangement].format(
        axis=names["left"],
        left_axis=names["left"],
        right_axis=names["right"],
        left=degrees(left.angle_deg),
        right=degrees(right.angle_deg),
    )
    return ComparisonWords(
        headline.format(number=step - 1, **names),
        degrees(sweep * left.angle_deg) if alike else "",
        sentence,
        step - 1,
        AXES.index(left.axis),
    )


def comparison_shapes(taught: TaughtPose, state: TeachState) -> list[Shape]:
    """Both boards of this moment."""
    left, right = texts.COLUMNS[state.arrangement]
    one, two, three = taught.order.upper()
    order = texts.ORDER_NAME.format(one=one, two=two, three=three)
    own = "own" if state.arrangement == "axes" else "fixed"
    readings: tuple[tuple[TurnSequence, Axes, str], ...] = (
        (taught.fixed, "fixed", left),
        (taught.others(state.arrangement), own, right.format(order=order)),
    )
    # Facing the camera swaps left and right, which the words name.
    sides: tuple[Side, Side] = ("left", "right")
    if state.viewpoint == "holder":
        sides = ("right", "left")
    progress = min(max(state.progress - 1.0, 0.0), 3.0)  # the move is not a turn
    return [
        shape
        for side, (turns, axes, title) in zip(sides, readings, strict=True)
        for shape in _turning_board(taught.board, side, turns, progress, axes, title, state.dark)
    ]


def _turning_board(
    board: Board,
    side: Side,
    turns: TurnSequence,
    progress: float,
    axes: Axes,
    title: str,
    dark: bool,
) -> list[Shape]:
    """One board after `progress` (0 ... 3) of its three turns, under its title, with its `axes`."""
    name, centre, colours = f"/compare/{side}", board_centre(board, side), ground(dark)
    # A turn that has just ended is still the one described.
    index = min(max(ceil(progress - 1e-6) - 1, 0), 2)
    turn, fraction = turns[index], min(progress - index, 1.0)

    def here(pose: Pose) -> Pose:
        return Pose(pose.R, centre)

    now = here(turn.pose_at(fraction))
    above = centre - [0, 1.2 * _AXIS * board.width, 0]
    shapes: list[Shape] = [
        board_shape(board, now, f"{name}/board"),
        board_outline(board, here(turns[0].before), f"{name}/outline", colours.ghost, 1.5),
        board_outline(board, here(turns[2].after), f"{name}/goal", colours.target, 3.0),
        LabelShape(f"{name}/label", title, above, colours.text),
        *_axes_shapes(board, name, now, turns[0].before, turn, axes, dark),
    ]
    if 0 < progress < 3 and abs(turn.angle_deg) > 0.5:
        shapes += _arc(board, name, here(turn.before), turn, fraction, dark)
    return shapes


def _axes_shapes(
    board: Board, name: str, now: Pose, start: Pose, turn: Turn, axes: Axes, dark: bool
) -> list[Shape]:
    shapes: list[Shape] = []
    # The board's own axes start along the camera's and move with the board.
    directions = np.eye(3) if axes == "fixed" else now.R @ start.R.T
    for i, axis in enumerate(AXES):
        colour = step_colour(i + 2, dark)
        active = axis == turn.axis
        if not active:
            colour = mixed(colour, ground(dark).background, 0.35)
        direction = directions[:, i]
        arrow = straight_arrow(round(_AXIS * board.width, 4), 0.014 * board.width)
        # Two arrows from the same point would flicker there.
        shapes.append(
            MeshShape(f"{name}/{axis}", arrow, frame_along(direction, now.t), colour, shaded=True)
        )
        at = now.t + 1.1 * _AXIS * board.width * direction
        shapes.append(LabelShape(f"{name}/{axis}_name", axis.upper(), at, colour))
    return shapes


def _arc(
    board: Board, name: str, before: Pose, turn: Turn, fraction: float, dark: bool
) -> list[Shape]:
    colour, radius = step_colour(AXES.index(turn.axis) + 2, dark), round(0.3 * board.width, 4)
    aside = before.R[:, {"x": 1, "y": 0, "z": 0}[turn.axis]]
    origin = before.t + 0.55 * _AXIS * board.width * turn.direction
    frame = turn_frame(turn.direction, aside, origin)
    angle = turn.angle_deg
    end = float(np.copysign(max(abs(angle), _SHORTEST_ARC_DEG), angle))
    arrow = arc_arrow(0.0, round(end, 1), radius, round(0.014 * board.width, 5))
    at = frame.apply(arc_point(end / 2, 1.35 * radius))
    return [
        MeshShape(f"{name}/arc", arrow, frame, colour, shaded=True),
        LabelShape(f"{name}/angle", degrees(fraction * angle), at, colour),
    ]

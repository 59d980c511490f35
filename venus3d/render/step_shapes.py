"""One step's instruction: the arrow, the swept angle, the axis and the amount. A turn is drawn as a
protractor just outside the board, in a plane perpendicular to its axis, so that the board never
hides it; the arc starts at the edge that the words name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.amounts import step_amount
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import AXES, Array, Pose, interpolate
from venus3d.render.arrows import (
    arc_arrow,
    arc_point,
    frame_along,
    sector,
    straight_arrow,
    turn_frame,
)
from venus3d.render.board_mesh import outline_segments
from venus3d.render.palette import step_colour, step_style
from venus3d.render.shapes import Colour, LabelShape, LineShape, MeshShape, Shape

GAP = 0.12
"""Distance of a protractor from the board's side, in board widths."""
SHAFT = 0.016
"""Radius of an arrow's shaft, in board widths."""
SHORTEST_ARC_DEG = 22.0
"""Shortest arc of an arrow."""
READABLE_ARC_DEG = 60.0
"""The same where the camera sees the arc edge-on."""
_SHORTEST_EDGE = 0.3
"""Sine of the angle between a turn's axis and the way to an edge from which its arc may start."""


@dataclass(frozen=True, eq=False)
class Protractor:
    """Place of a turn's arc."""

    frame: Pose
    """+z along the turn's axis, +x towards the arc's start; the origin on the axis."""
    radius: float
    """Of the arc, metres."""
    axis_ends: Array
    """(2, 3) the visible part of the axis; the second end is on the protractor's side."""


def instruction_shapes(
    board: Board,
    camera: Camera | None,
    step: Step,
    *,
    dark: bool,
    prefix: str = "/steps",
    for_camera: bool = False,
    sweep: float = 1.0,
) -> list[Shape]:
    """Arrow, sector, axis and labels of a step; nothing for an idle one.

    The sector grows with `sweep`, 0 ... 1. The camera looks along the plane in which a board tilts
    or swings: with `for_camera` the arrow is long enough to be read from there, while sector and
    number give the true angle. Without a `camera`, all places count as equally good.
    """
    if step.is_idle:
        return []
    name = f"{prefix}/{step.number}"
    if step.axis is None:
        return _move_shapes(board, step, name, dark)
    return _turn_shapes(board, camera, step, name, dark, for_camera, sweep)


def _move_shapes(board: Board, step: Step, name: str, dark: bool) -> list[Shape]:
    colour = step_colour(step.number, dark)
    length = round(float(np.linalg.norm(step.translation)), 4)
    start, end = step.before.t, step.after.t
    shaft = _shaft(board, step)
    along = frame_along(step.translation, start)
    # Seen from behind, a move straight ahead is a dot, but visible at the corners.
    corners = step.before.apply(outline_segments(board)[:, 0]) - start
    # Beside the arrow, below it as the camera sees it.
    aside = np.array([-step.translation[1], step.translation[0], 0.0])
    aside = aside / np.linalg.norm(aside) if np.linalg.norm(aside) > 0.2 * length else [0, 1, 0]
    aside = np.asarray(aside) * (1 if aside[1] >= 0 else -1)
    middle = (start + end) / 2 + aside * 0.16 * board.width * _enlarged(step)
    return [
        _move_arrow(f"{name}/arrow", length, shaft, along, colour),
        *(
            _move_arrow(f"{name}/trail_{i}", length, 0.4 * shaft, along.moved(corner), colour)
            for i, corner in enumerate(corners, start=1)
        ),
        _amount_label(step, name, middle, colour),
    ]


def _amount_label(step: Step, name: str, at: Array, colour: Colour) -> LabelShape:
    word = step_style(step.number).short_title
    return LabelShape(f"{name}/label", step_amount(step), at, colour, in_motion=word)


def _move_arrow(name: str, length: float, shaft: float, pose: Pose, colour: Colour) -> MeshShape:
    arrow = straight_arrow(length, round(shaft, 5))
    # Those at the corners stay as they are: they show the way where the one in the middle is bent.
    ends = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, length]]) if name.endswith("/arrow") else None
    return MeshShape(name, arrow, pose, colour, shaded=True, on_top=True, ends=ends)


def _shaft(board: Board, step: Step) -> float:
    """Radius of the arrow, metres; thicker for a far board."""
    return round(SHAFT * board.width * _enlarged(step), 4)


def _enlarged(step: Step) -> float:
    return float(np.clip(step.after.t[2] / 0.5, 1.0, 2.0))


def pose_during(step: Step, fraction: float) -> Pose:
    """The board's pose after a `fraction` (0 ... 1) of a step."""
    if step.axis is None:
        return interpolate(step.before, step.after, fraction)
    # A turn of more than 180 degrees must go the long way round, like its arrow.
    return step.before.turned(step.axis, fraction * step.angle_deg)


def _turn_shapes(
    board: Board,
    camera: Camera | None,
    step: Step,
    name: str,
    dark: bool,
    for_camera: bool,
    sweep: float,
) -> list[Shape]:
    assert step.axis is not None
    colour = step_colour(step.number, dark)
    place = protractor(board, camera, step)
    angle, radius = round(step.angle_deg, 2), round(place.radius, 5)
    shaft = _shaft(board, step)
    ends = arc_ends(step, for_camera=for_camera)
    arrow = arc_arrow(*ends, radius, shaft)
    outward = place.axis_ends[1] - place.axis_ends[0]
    outward = outward / np.linalg.norm(outward) * 0.07 * board.width * _enlarged(step)
    letter_at = place.axis_ends[1] + outward
    degrees_at = place.frame.apply(arc_point((ends[0] + ends[1]) / 2, 1.28 * radius))
    # The camera looks along Z: the axis is a dot.
    seen = step.axis != "z"
    if seen:  # an edge-on arc would run into its number
        degrees_at = degrees_at + 1.3 * outward
    # In whole degrees, so that an animation makes few meshes.
    done = sector(angle if sweep >= 1 else float(round(sweep * angle)), radius)
    return [
        MeshShape(
            f"{name}/arrow",
            arrow,
            place.frame,
            colour,
            shaded=True,
            on_top=True,
            ends=np.array([arc_point(end, radius) for end in ends]),
        ),
        MeshShape(f"{name}/sector", done, place.frame, colour, 0.4),
        LineShape(f"{name}/axis", place.axis_ends[None], Pose.identity(), colour, 2.0, seen),
        LabelShape(f"{name}/axis_label", step.axis.upper(), letter_at, colour, seen),
        _amount_label(step, name, degrees_at, colour),
    ]


def arc_ends(step: Step, *, for_camera: bool) -> tuple[float, float]:
    """Where a turn's arrow begins and ends, degrees from the start of its arc."""
    angle = round(step.angle_deg, 2)
    sign = 1.0 if angle > 0 else -1.0
    if for_camera and step.axis != "z":
        return 0.0, sign * max(abs(angle), READABLE_ARC_DEG)
    # Move the tail of a small turn's arrow back, so that its tip stays at the end of the turn.
    return sign * min(0.0, abs(angle) - SHORTEST_ARC_DEG), angle


def protractor(board: Board, camera: Camera | None, step: Step) -> Protractor:
    """The place for a turn's arc that this camera sees best; the first of equals."""
    places = _dials(board, step) if step.axis == "z" else _side_places(board, step)
    if camera is None:
        return places[0]
    # The first ones are outside the board; cutting through it counts as one hidden point.
    outer = len(places) // (3 if step.axis == "z" else 2)
    flaws = [_flaws(p, step, camera) + (i >= outer) for i, p in enumerate(places)]
    return places[flaws.index(min(flaws))]


def _dials(board: Board, step: Step) -> list[Protractor]:
    """Dials around the whole board, starting at one of its four edges, then smaller ones."""
    axis, centre = np.array([0.0, 0.0, 1.0]), step.after.t
    diagonal = float(np.hypot(board.width, board.height)) / 2
    places: list[Protractor] = []
    for share in (1.1, 0.8, 0.55):
        # A dial inside the board's outline stands in front of all of it.
        forward = _reach(board, step, axis) + 0.03 * board.width if share < 1 else 0.0
        origin = centre - forward * axis
        for edge in _edges(step, axis, np.array([0.0, -1.0, 0.0])):
            radius = share * diagonal
            ends = np.stack([origin + 0.5 * radius * axis, origin - 0.6 * radius * axis])
            places.append(Protractor(turn_frame(axis, edge, origin), radius, ends))
    return places


def _side_places(board: Board, step: Step) -> list[Protractor]:
    """Places beside the board for a turn about X or Y; the last ones cut through the board."""
    axis, edge = np.eye(3)[AXES.index(step.axis or "x")], _first_edge(step)
    half = np.array([board.width, board.height]) / 2
    radius = 1.2 * float(np.abs(edge @ step.before.R[:, :2]) @ half)
    centre, reach = step.after.t, _reach(board, step, axis)
    # The farther from the optical axis, the less edge-on the arc: prefer that side.
    first = 1.0 if centre @ axis >= 0 else -1.0
    places: list[Protractor] = []
    for beside, share in ((reach + GAP * board.width, 1.0), (0.6 * reach, 0.85)):
        for side in (first, -first):
            origin = centre + side * beside * axis
            far = centre + side * (max(reach, beside) + 0.06 * board.width) * axis
            ends = np.stack([centre - side * (reach + 0.06 * board.width) * axis, far])
            places.append(Protractor(turn_frame(axis, edge, origin), share * radius, ends))
    return places


def _first_edge(step: Step) -> Array:
    """(3,) unit vector to the edge at which a turn's arc begins, if all places are equally good."""
    sign, axis = 1.0 if step.angle_deg > 0 else -1.0, step.axis or "x"
    towards = {"x": [0.0, -sign, 0.0], "y": [sign, 0.0, 0.0], "z": [0.0, -1.0, 0.0]}[axis]
    return np.asarray(_edges(step, np.eye(3)[AXES.index(axis)], np.array(towards))[0])


def arrow_direction(step: Step) -> Array:
    """(3,) unit vector: roughly where a step's arrow points, wherever it is drawn."""
    if step.axis is None:
        return step.translation / np.linalg.norm(step.translation)
    axis = np.eye(3)[AXES.index(step.axis)]
    first, last = arc_ends(step, for_camera=False)
    frame = turn_frame(axis, _first_edge(step), np.zeros(3))
    return np.cross(axis, frame.apply(arc_point((first + last) / 2, 1.0)))


def _reach(board: Board, step: Step, axis: Array) -> float:
    """Extent of the board from its centre along an axis after the step, metres."""
    return float(np.abs(axis @ step.after.R[:, :2]) @ [board.width / 2, board.height / 2])


def _edges(step: Step, axis: Array, towards: Array) -> Array:
    """(4, 3) or (2, 3) unit vectors to the board's edges, perpendicular to the axis, best aligned
    first; without edges that lie on the axis, which a turn about it hardly moves."""
    edges = np.concatenate([step.before.R[:, :2].T, -step.before.R[:, :2].T])
    flat = edges - np.outer(edges @ axis, axis)
    lengths = np.linalg.norm(flat, axis=1)
    order = np.argsort(-(flat @ towards), kind="stable")
    order = order[lengths[order] > _SHORTEST_EDGE]
    return flat[order] / lengths[order, None]


def _flaws(place: Protractor, step: Step, camera: Camera) -> int:
    """How many of the arc's five points the camera does not see, plus two if the arc is edge-on;
    labels do not count, since they are moved into the picture."""
    sign = 1.0 if step.angle_deg > 0 else -1.0
    end = step.angle_deg if step.axis == "z" else sign * max(abs(step.angle_deg), READABLE_ARC_DEG)
    angles = np.linspace(0, end, 5)
    arc = [arc_point(a, 1.08 * place.radius) for a in angles]
    pixels = camera.project(place.frame.apply(np.array(arc)))
    margin = 0.01 * camera.width
    with np.errstate(invalid="ignore"):
        seen = (pixels > margin) & (pixels < np.array(camera.image_size) - margin)
    origin = place.frame.t
    edge_on = abs(origin @ place.frame.R[:, 2]) < 0.06 * origin[2] and step.axis != "z"
    return int((~seen.all(axis=1)).sum()) + 2 * edge_on

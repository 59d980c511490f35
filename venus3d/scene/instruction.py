"""One step's instruction: the arrow, the swept angle, the axis and the number of degrees.

A turn is drawn like a protractor at the board's side: its plane is square to the axis and stands
just outside the board, so that the board never hides it, and the arc starts at the very edge that
the words speak of.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.decomposition import Step
from venus3d.engine.pose import AXES, Array, Pose
from venus3d.scene.arrows import (
    arc_arrow,
    arc_point,
    frame_along,
    sector,
    straight_arrow,
    turn_frame,
)
from venus3d.scene.board_shape import outline_segments
from venus3d.scene.palette import ground, mixed, step_colour
from venus3d.scene.shapes import LabelShape, LineShape, MeshShape, Shape

GAP = 0.12
"""Distance of a protractor from the board's side, in board widths."""
SHAFT = 0.016
"""Radius of an arrow's shaft, in board widths."""


@dataclass(frozen=True, eq=False)
class Protractor:
    """Where a turn's arc stands."""

    frame: Pose
    """+z along the turn's axis, +x to where the arc starts; the origin on the axis."""
    radius: float
    """Of the arc, metres."""
    axis_ends: Array
    """(2, 3) the visible piece of the axis; the second end is on the protractor's side."""


def instruction_shapes(
    board: Board, camera: Camera, step: Step, *, dark: bool, prefix: str = "/steps"
) -> list[Shape]:
    """Arrow and all that belongs to it; nothing for an idle step."""
    if step.is_idle:
        return []
    name = f"{prefix}/{step.number}"
    if step.axis is None:
        return _move_shapes(board, step, name, dark)
    return _turn_shapes(board, camera, step, name, dark)


def _move_shapes(board: Board, step: Step, name: str, dark: bool) -> list[Shape]:
    colour = step_colour(step.number, dark)
    length = round(float(np.linalg.norm(step.translation)), 4)
    start, end = step.before.t, step.after.t
    shaft = SHAFT * board.width
    corners = outline_segments(board)[:, 0]
    trails = np.stack([step.before.apply(corners), step.after.apply(corners)], axis=1)
    return [
        MeshShape(
            f"{name}/arrow",
            straight_arrow(length, round(shaft, 5)),
            frame_along(step.translation, start),
            colour,
            shaded=True,
        ),
        LineShape(f"{name}/trails", trails, Pose.identity(), colour, 1.5),
        LabelShape(
            f"{name}/label", f"{length * 1000:.0f} mm", (start + end) / 2, colour
        ),
    ]


def _turn_shapes(
    board: Board, camera: Camera, step: Step, name: str, dark: bool
) -> list[Shape]:
    assert step.axis is not None
    colour = step_colour(step.number, dark)
    place = protractor(board, camera, step)
    angle, radius = round(step.angle_deg, 2), round(place.radius, 5)
    shaft = round(SHAFT * board.width, 5)
    outward = place.axis_ends[1] - place.axis_ends[0]
    outward = outward / np.linalg.norm(outward)
    label = place.frame.apply(arc_point(angle / 2, 1.28 * radius))
    return [
        MeshShape(
            f"{name}/arrow", arc_arrow(angle, radius, shaft), place.frame, colour, shaded=True
        ),
        MeshShape(f"{name}/sector", sector(angle, radius), place.frame, colour, 0.35),
        LineShape(f"{name}/axis", place.axis_ends[None], Pose.identity(), colour, 2.0),
        LabelShape(
            f"{name}/axis_label",
            step.axis.upper(),
            place.axis_ends[1] + outward * 0.07 * board.width,
            mixed(colour, ground(dark).text, 0.25),
        ),
        LabelShape(f"{name}/label", f"{step.angle_deg:+.0f}°", label, colour),
    ]


def protractor(board: Board, camera: Camera, step: Step) -> Protractor:
    """Where the arc of a turn is best drawn for this camera and this board."""
    axis = np.eye(3)[AXES.index(step.axis)] if step.axis else np.zeros(3)
    edge = _leading_edge(step, axis)
    centre = step.after.t
    half = np.array([board.width, board.height]) / 2
    if step.axis == "z":
        # A dial around the whole board, just wider than its diagonal.
        radius = 1.08 * float(np.hypot(*half))
        frame = turn_frame(axis, edge, centre)
        ends = np.stack([centre + axis * 0.5 * radius, centre - axis * 0.9 * radius])
        return Protractor(frame, radius, ends)
    # Turning about an axis does not change how far the board reaches along it.
    reach = float(np.abs(step.after.R[:, :2] * half).T[:, :] @ axis @ np.ones(2))
    radius = 1.2 * float(np.abs(edge @ step.before.R[:, :2]) @ half)
    away = reach + GAP * board.width

    def at(side: float) -> Protractor:
        origin = centre + side * away * axis
        ends = np.stack([centre - side * away * axis, origin + side * 0.06 * board.width * axis])
        return Protractor(turn_frame(axis, edge, origin), radius, ends)

    # The farther from the optical axis, the less edge-on the arc is seen: prefer that side.
    side = 1.0 if centre @ axis >= 0 else -1.0
    preferred, other = at(side), at(-side)
    return other if _hidden(other, step, camera) < _hidden(preferred, step, camera) else preferred


def _leading_edge(step: Step, axis: Array) -> Array:
    """(3,) direction from the centre to the edge that the step's words name, square to the axis."""
    up, right = np.array([0.0, -1.0, 0.0]), np.array([1.0, 0.0, 0.0])
    sign = 1.0 if step.angle_deg > 0 else -1.0
    wanted = {"x": up * sign, "y": right * sign, "z": up}[step.axis or "z"]
    candidates = np.concatenate([step.before.R[:, :2].T, -step.before.R[:, :2].T])
    flat = candidates - np.outer(candidates @ axis, axis)
    return flat[int(np.argmax(flat @ wanted))]


def _hidden(place: Protractor, step: Step, camera: Camera) -> int:
    """How many of the arc's points the camera does not see."""
    angles = np.linspace(0, step.angle_deg, 7)
    points = place.frame.apply(np.array([arc_point(a, 1.1 * place.radius) for a in angles]))
    pixels = camera.project(points)
    margin = 0.03 * camera.width
    with np.errstate(invalid="ignore"):
        seen = (pixels > margin) & (pixels < np.array(camera.image_size) - margin)
    return int((~seen.all(axis=1)).sum())

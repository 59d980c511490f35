"""What is drawn over the picture: the points, a ruler between two, a cube."""

from __future__ import annotations

from itertools import product

import numpy as np

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.shapes import Colour, LabelShape, LineShape, Shape
from venus3d.scene.pages.measure.state import MeasureState

_INK: Colour = (255, 214, 92)
_CASING: Colour = (16, 20, 28)
_CROSS_M = 0.006
_TICK_M = 0.010
"""Distance of the ruler's ticks; each fifth is longer."""
_BEHIND = 1.002
"""Relative distance of a line's casing, which the line then hides."""
_MOST_TICKS = 400


def measure_shapes(state: MeasureState, pose: Pose | None, label: str) -> tuple[Shape, ...]:
    """The shapes for a board in this pose; none while it is not seen."""
    if pose is None or not state.points:
        return ()
    if state.tool == "cube":
        return _cased("/measure/cube", _cube(state), pose, 3.0)
    shapes = _cased("/measure/points", _crosses(state), pose, 3.0)
    ends = state.ends
    if ends is None:
        return shapes
    middle = pose.apply(ends.mean(axis=0)[None])[0]
    return (
        *shapes,
        *_cased("/measure/ruler", _ruler(ends), pose, 2.5),
        LabelShape("/measure/label", label, middle, _INK),
    )


def _crosses(state: MeasureState) -> Array:
    arms = _CROSS_M * np.array([[[-1, 0, 0], [1, 0, 0]], [[0, -1, 0], [0, 1, 0]]])
    return np.concatenate([arms + np.array([x, y, 0.0]) for x, y in state.points])


def _ruler(ends: Array) -> Array:
    """The line between the ends with a tick each centimetre, on the side away from its middle."""
    along = ends[1] - ends[0]
    length = float(np.linalg.norm(along))
    if length == 0:
        return ends[None]
    along = along / length
    aside = np.array([-along[1], along[0], 0.0])
    count = min(int(length / _TICK_M + 1e-9), _MOST_TICKS)
    lines = [ends]
    for number in range(count + 1):
        foot = ends[0] + number * _TICK_M * along
        reach = 0.008 if number % 5 == 0 else 0.004
        lines.append(np.array([foot, foot + reach * aside]))
    return np.array(lines)


def _cube(state: MeasureState) -> Array:
    """The twelve edges; it stands on the side of the board that is seen, which is -z."""
    (x, y), edge = state.points[0], state.edge_m
    corners = np.array(list(product((0, 1), (0, 1), (0, -1)))) * edge
    corners = corners + np.array([x, y, 0.0])
    pairs = [
        (a, b)
        for a in range(8)
        for b in range(a)
        if abs(float(np.linalg.norm(corners[a] - corners[b])) - edge) < 1e-9
    ]
    return np.array([[corners[a], corners[b]] for a, b in pairs])


def _cased(name: str, segments: Array, pose: Pose, width_px: float) -> tuple[Shape, ...]:
    """Lines with a dark edge, visible on white paper."""
    casing = Pose(pose.R, _BEHIND * pose.t)
    return (
        LineShape(f"{name}_casing", _BEHIND * segments, casing, _CASING, width_px + 3),
        LineShape(name, segments, pose, _INK, width_px),
    )

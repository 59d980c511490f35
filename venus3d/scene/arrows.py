"""Arrows and sectors: what shows a move and a turn.

Meshes are made by trimesh in simple frames of their own (an arrow along +z, a turn about +z that
starts at +x) and placed by poses. Equal numbers give the same mesh object again, so that a renderer
sends nothing twice. Where an arrow belongs and what colour it has is `describe`'s.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import trimesh

from venus3d.engine.pose import Array, Pose

HEAD_RADIUS = 2.6
"""Radius of an arrow's head, in radii of its shaft."""
HEAD_LENGTH = 5.5
"""Length of an arrow's head, in radii of its shaft."""
_SECTIONS = 20
# trimesh's own annotations leave most of what its functions return open.
_trimesh: Any = trimesh


@lru_cache(maxsize=64)
def straight_arrow(length: float, radius: float) -> trimesh.Trimesh:
    """Arrow from the origin to (0, 0, length), metres; short ones are thinner."""
    radius = min(radius, length / (1.6 * HEAD_LENGTH))
    head = HEAD_LENGTH * radius
    # Silhouette as (distance from the axis, height), turned about the axis.
    outline = [
        [0.0, 0.0],
        [radius, 0.0],
        [radius, length - head],
        [HEAD_RADIUS * radius, length - head],
        [0.0, length],
    ]
    return _trimesh.creation.revolve(np.array(outline), sections=_SECTIONS)


@lru_cache(maxsize=256)
def arc_arrow(
    start_deg: float, end_deg: float, arc_radius: float, radius: float
) -> trimesh.Trimesh:
    """Thick arrow along a circle about +z, angles counted from +x; the tip is at `end_deg`.

    Lengths in metres. The arc must be long enough for the arrow's head.
    """
    span = abs(end_deg - start_deg)
    head_deg = min(float(np.degrees(HEAD_LENGTH * radius / arc_radius)), 0.7 * span)
    shaft_deg = span - head_deg
    circle = np.linspace(0, 2 * np.pi, _SECTIONS // 2 + 1)
    section = np.column_stack([arc_radius + radius * np.cos(circle), radius * np.sin(circle)])
    tube = _trimesh.creation.revolve(
        section, angle=np.radians(shaft_deg), sections=max(4, int(shaft_deg / 3))
    )
    tail = _trimesh.creation.icosphere(subdivisions=2, radius=radius)
    tail.apply_translation([arc_radius, 0, 0])
    # The cone points along +z; lay it along the chord from the tube's end to the tip.
    base, tip = arc_point(shaft_deg, arc_radius), arc_point(span, arc_radius)
    length = float(np.linalg.norm(tip - base))
    head = _trimesh.creation.cone(HEAD_RADIUS * radius, length, sections=_SECTIONS)
    head.apply_transform(frame_along(tip - base, base).matrix)
    arrow = _trimesh.util.concatenate([tube, tail, head])
    if end_deg < start_deg:
        arrow.apply_transform(np.diag([1.0, -1.0, 1.0, 1.0]))
    arrow.apply_transform(
        _trimesh.transformations.rotation_matrix(np.radians(start_deg), [0, 0, 1])
    )
    return arrow


@lru_cache(maxsize=256)
def sector(angle_deg: float, arc_radius: float) -> trimesh.Trimesh:
    """The swept angle as a sheet in z = 0, from +x to `angle_deg`, out to `arc_radius`, metres."""
    steps = max(2, int(np.ceil(abs(angle_deg) / 3)) + 1)
    angles = np.radians(np.linspace(0, angle_deg, steps))
    rim = arc_radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(steps)])
    first = np.arange(1, steps)
    faces = np.column_stack([np.zeros_like(first), first, first + 1])
    return trimesh.Trimesh(vertices=np.vstack([[0, 0, 0], rim]), faces=faces, process=False)


def arc_point(angle_deg: float, arc_radius: float) -> Array:
    """(3,) the point of the circle at this angle from +x, metres."""
    angle = np.radians(angle_deg)
    return arc_radius * np.array([np.cos(angle), np.sin(angle), 0.0])


def frame_along(direction: Array, origin: Array) -> Pose:
    """A pose at `origin` whose +z points along `direction` (3,); its roll does not matter."""
    z = direction / np.linalg.norm(direction)
    sideways = np.array([1.0, 0, 0]) if abs(z[0]) < 0.8 else np.array([0, 1.0, 0])
    return turn_frame(z, sideways, origin)


def turn_frame(axis: Array, start: Array, origin: Array) -> Pose:
    """A pose at `origin` with +z along `axis` (3,) and +x along `start` (3,) made square to it."""
    z = axis / np.linalg.norm(axis)
    x = start - (start @ z) * z
    x = x / np.linalg.norm(x)
    R = np.column_stack([x, np.cross(z, x), z]).astype(np.float64)
    return Pose(R, np.asarray(origin, dtype=np.float64))

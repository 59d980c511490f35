"""Arrows and sectors that show a move and a turn.

Meshes are made in frames of their own (an arrow along +z, a turn about +z from +x) and placed by
poses. Equal numbers give the same mesh object, so a renderer uploads nothing twice. They follow
a moving board, so each is made in a fraction of a millisecond, in plain numpy.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import AXES, Array, Pose
from venus3d.render.palette import step_colour
from venus3d.render.shapes import MeshShape

HEAD_RADIUS = 2.6
"""Radius of an arrow's head, in radii of its shaft."""
HEAD_LENGTH = 5.5
"""Length of an arrow's head, in radii of its shaft."""
_SECTIONS = 20
Faces = NDArray[np.intp]
# trimesh's annotations leave most return types open.
_trimesh: Any = trimesh


@lru_cache(maxsize=64)
def straight_arrow(length: float, radius: float) -> trimesh.Trimesh:
    """Arrow from the origin to (0, 0, length), metres; short ones are thinner."""
    radius = min(radius, length / (1.6 * HEAD_LENGTH))
    neck = length - HEAD_LENGTH * radius
    # Silhouette as (distance from the axis, height), turned about the axis.
    silhouette = np.array([[radius, 0.0], [radius, neck], [HEAD_RADIUS * radius, neck]])
    circle = np.linspace(0, 2 * np.pi, _SECTIONS, endpoint=False)
    out, up = silhouette[:, :1], np.broadcast_to(silhouette[:, 1:], (3, _SECTIONS))
    rings = np.stack([out * np.cos(circle), out * np.sin(circle), up], axis=-1)
    vertices = np.vstack([[[0, 0, 0], [0, 0, length]], rings.reshape(-1, 3)])
    return trimesh.Trimesh(vertices=vertices, faces=_straight_faces(), process=False)


@lru_cache(maxsize=256)
def arc_arrow(
    start_deg: float, end_deg: float, arc_radius: float, radius: float
) -> trimesh.Trimesh:
    """Thick arrow along a circle about +z, angles from +x, tip at `end_deg`, lengths in metres. The
    arc must be long enough for the head."""
    span = abs(end_deg - start_deg)
    head_deg = min(float(np.degrees(HEAD_LENGTH * radius / arc_radius)), 0.7 * span)
    shaft_deg = span - head_deg
    ball, cone = _ball(), _cone()
    tail = radius * ball.vertices + [arc_radius, 0, 0]
    tube, tube_faces = _tube(shaft_deg, arc_radius, radius)
    # The cone points along +z; lay it along the chord from the tube's end to the tip.
    base, tip = arc_point(shaft_deg, arc_radius), arc_point(span, arc_radius)
    wide = HEAD_RADIUS * radius
    sizes = [wide, wide, float(np.linalg.norm(tip - base))]
    head = frame_along(tip - base, base).apply(cone.vertices * sizes)
    vertices = np.vstack([tube, tail, head])
    faces = np.vstack(
        [tube_faces, ball.faces + len(tube), cone.faces + len(tube) + len(ball.vertices)]
    )
    if end_deg < start_deg:
        vertices, faces = vertices * [1.0, -1.0, 1.0], faces[:, ::-1]
    turned = Pose.identity().turned("z", start_deg).apply(vertices)
    return trimesh.Trimesh(vertices=turned, faces=faces, process=False)


@lru_cache(maxsize=256)
def sector(angle_deg: float, arc_radius: float) -> trimesh.Trimesh:
    """The swept angle as a sheet in z = 0, from +x to `angle_deg`; `arc_radius` in metres."""
    steps = max(2, int(np.ceil(abs(angle_deg) / 3)) + 1)
    angles = np.radians(np.linspace(0, angle_deg, steps))
    rim = arc_radius * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(steps)])
    first = np.arange(1, steps)
    faces = np.column_stack([np.zeros_like(first), first, first + 1])
    return trimesh.Trimesh(vertices=np.vstack([[0, 0, 0], rim]), faces=faces, process=False)


def handle_shapes(
    pose: Pose, size: float, *, arrows: bool, arcs: bool, dark: bool
) -> tuple[MeshShape, ...]:
    """Arrows along a board's axes and quarter arcs about them, `size` metres, to drag it by; each
    axis in the colour of the step that turns about it."""
    if not (arrows or arcs):
        return ()
    return tuple(
        MeshShape(
            f"/handle/{name}",
            _handle(axis, size, arrows, arcs),
            pose,
            step_colour(axis + 2, dark),
            0.6,
            in_projection=False,
            on_top=True,
        )
        for axis, name in enumerate(AXES)
    )


@lru_cache(maxsize=16)
def _handle(axis: int, size: float, arrows: bool, arcs: bool) -> trimesh.Trimesh:
    """An arrow along one axis, and a quarter arc about it between the two others."""
    directions, parts = np.eye(3), list[Any]()
    if arrows:
        arrow = straight_arrow(size, 0.009 * size)
        place = frame_along(directions[axis], np.zeros(3))
        parts.append((place.apply(arrow.vertices), arrow.faces))
    if arcs:
        vertices, faces = _tube(90.0, 0.65 * size, 0.008 * size)
        place = turn_frame(directions[axis], directions[(axis + 1) % 3], np.zeros(3))
        parts.append((place.apply(vertices), faces))
    meshes = [trimesh.Trimesh(vertices=v, faces=f, process=False) for v, f in parts]
    return _trimesh.util.concatenate(meshes)


def _tube(shaft_deg: float, arc_radius: float, radius: float) -> tuple[Array, Faces]:
    """Vertices and faces of the arc, open at both ends."""
    circle = np.linspace(0, 2 * np.pi, _SECTIONS // 2, endpoint=False)
    steps = max(4, int(shaft_deg / 3)) + 1
    angles = np.radians(np.linspace(0, shaft_deg, steps))[:, None]
    out = arc_radius + radius * np.cos(circle)
    up = np.broadcast_to(radius * np.sin(circle), (steps, len(circle)))
    rings = np.stack([out * np.cos(angles), out * np.sin(angles), up], axis=-1)
    return rings.reshape(-1, 3), _skin(steps, len(circle))[:, ::-1]


@lru_cache(maxsize=64)
def _skin(rings: int, around: int, first: int = 0) -> Faces:
    """Faces between consecutive closed rings of vertices, facing outwards if the rings run
    counter-clockwise from bottom to top."""
    ring, place = np.divmod(np.arange((rings - 1) * around), around)
    right = (place + 1) % around
    low, high = first + ring * around, first + (ring + 1) * around
    one = np.column_stack([low + place, low + right, high + right])
    other = np.column_stack([low + place, high + right, high + place])
    return np.vstack([one, other])


@lru_cache(maxsize=1)
def _straight_faces() -> Faces:
    """Faces of an arrow whose vertices are its foot, its tip and three rings."""
    here = np.arange(_SECTIONS)
    after = (here + 1) % _SECTIONS
    last = 2 + 2 * _SECTIONS
    foot = np.column_stack([np.zeros_like(here), 2 + after, 2 + here])
    tip = np.column_stack([last + here, last + after, np.ones_like(here)])
    return np.vstack([foot, _skin(3, _SECTIONS, 2), tip])


@lru_cache(maxsize=1)
def _ball() -> Any:
    """A sphere of radius 1."""
    return _trimesh.creation.icosphere(subdivisions=2, radius=1.0)


@lru_cache(maxsize=1)
def _cone() -> Any:
    """A cone from a disc of radius 1 in z = 0 to (0, 0, 1)."""
    return _trimesh.creation.cone(1.0, 1.0, sections=_SECTIONS)


def arc_point(angle_deg: float, arc_radius: float) -> Array:
    """(3,) the point on the circle at this angle from +x, metres."""
    angle = np.radians(angle_deg)
    return arc_radius * np.array([np.cos(angle), np.sin(angle), 0.0])


def frame_along(direction: Array, origin: Array) -> Pose:
    """A pose at `origin` with +z along `direction` (3,) and any roll."""
    z = direction / np.linalg.norm(direction)
    sideways = np.array([1.0, 0, 0]) if abs(z[0]) < 0.8 else np.array([0, 1.0, 0])
    return turn_frame(z, sideways, origin)


def turn_frame(axis: Array, start: Array, origin: Array) -> Pose:
    """A pose at `origin` with +z along `axis` (3,) and +x along `start` (3,), orthogonalised."""
    z = axis / np.linalg.norm(axis)
    x = start - (start @ z) * z
    x = x / np.linalg.norm(x)
    R = np.column_stack([x, np.cross(z, x), z]).astype(np.float64)
    return Pose(R, np.asarray(origin, dtype=np.float64))

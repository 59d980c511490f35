"""Named shapes of the scene, drawn by viser and pyrender alike, and what both offscreen renderers
make of them: lines as ribbons of triangles, shading by a lamp above the camera's left shoulder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose

Colour = tuple[int, int, int]
_NEAR = 0.01
_TO_LAMP = np.array([-0.35, -0.75, -0.56]) / np.linalg.norm([-0.35, -0.75, -0.56])
_AMBIENT = 0.62


@dataclass(frozen=True, eq=False)
class MeshShape:
    """A mesh with one colour or a texture."""

    name: str
    """Path in the scene tree: "/steps/3/arrow"."""
    mesh: trimesh.Trimesh
    """Vertices in the shape's own frame, metres; a textured mesh holds uv and image."""
    pose: Pose
    """Own frame to camera frame."""
    colour: Colour = (255, 255, 255)
    opacity: float = 1.0
    textured: bool = False
    in_projection: bool = True
    """Whether the offscreen projections include it."""
    shaded: bool = False
    """Whether it is shaded (arrows are; boards keep their plain colours)."""
    on_top: bool = False
    """Whether nothing may hide it."""
    ends: Array | None = None
    """(2, 3) an arrow's tail and tip, own frame; None for what is no arrow."""


@dataclass(frozen=True, eq=False)
class LineShape:
    """Straight segments with a constant width on the screen."""

    name: str
    segments: Array
    """(N, 2, 3) in the shape's own frame, metres."""
    pose: Pose
    colour: Colour
    width_px: float = 2.0
    in_projection: bool = True
    on_top: bool = False
    """Whether nothing occludes it in the offscreen projections."""


@dataclass(frozen=True, eq=False)
class LabelShape:
    """A short text at a point."""

    name: str
    text: str
    position: Array
    """(3,) camera frame, metres."""
    colour: Colour
    in_projection: bool = True
    in_motion: str = ""
    """What it says while the text changes; empty: the text."""


@dataclass(frozen=True, eq=False)
class FrustumShape:
    """The camera's frustum with its live picture."""

    name: str
    fov_y_rad: float
    aspect: float
    scale: float
    image: NDArray[np.uint8] | None
    in_projection: Literal[False] = False


@dataclass(frozen=True, eq=False)
class PointShape:
    """A cloud of dots of one size."""

    name: str
    points: Array
    """(N, 3) camera frame, metres."""
    colours: NDArray[np.uint8]
    """(N, 3) RGB."""
    size: float
    """Diameter of a dot, metres."""
    in_projection: Literal[False] = False


@dataclass(frozen=True, eq=False)
class GridShape:
    """A level grid that fades with the distance."""

    name: str
    height: float
    """Its y in the camera's frame, metres."""
    cell: float
    section: float
    """Distances of the fine and of the strong lines, metres."""
    colour: Colour
    section_colour: Colour
    in_projection: Literal[False] = False


Shape = MeshShape | LineShape | LabelShape | FrustumShape | PointShape | GridShape


def line_mesh(shape: LineShape, camera: Camera) -> tuple[Array, NDArray[np.intp]]:
    """Vertices (4 N, 3) in the camera's frame, metres, and faces (2 N, 3) of a line as flat ribbons
    that face the camera and are equally wide in its picture; segments nearer than a centimetre to
    the lens plane are left out."""
    ends = shape.pose.apply(shape.segments)
    ends = ends[(ends[..., 2] > _NEAR).all(axis=1)]
    along = ends[:, 1] - ends[:, 0]
    half = shape.width_px / 2 / np.sqrt(camera.fx * camera.fy)
    length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    aside = np.cross(along, ends.mean(axis=1))
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    reach = half * ends[..., 2:]
    # Slightly longer than the segment, so that the corners of an outline close.
    forward = (along / length)[:, None] * reach * np.array([-0.8, 0.8])[None, :, None]
    ends = ends + forward
    sideways = aside[:, None] * reach
    vertices = np.stack([ends - sideways, ends + sideways], axis=2).reshape(-1, 3)
    quads = np.arange(4 * len(ends)).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [2, 1, 3]]])
    return vertices, faces


def shaded_colours(shape: MeshShape, normals: ArrayLike) -> Array:
    """Colours (N, 3), 0 ... 255, of surfaces with normals (N, 3) in the shape's own frame."""
    facing = (np.asarray(normals, dtype=np.float64) @ shape.pose.R.T) @ _TO_LAMP
    light = _AMBIENT + (1.08 - _AMBIENT) * np.clip(facing, 0, None)
    return np.clip(np.array(shape.colour) * light[:, None], 0, 255)

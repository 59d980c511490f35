"""Named shapes of the scene, drawn by viser and pyrender alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import trimesh
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array, Pose

Colour = tuple[int, int, int]


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

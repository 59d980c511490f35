"""Shading, the same for both renderers: a lamp above the camera's left shoulder."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.pose import Array
from venus3d.render.shapes import MeshShape

_TO_LAMP = np.array([-0.35, -0.75, -0.56]) / np.linalg.norm([-0.35, -0.75, -0.56])
_AMBIENT = 0.62


def shaded_colours(shape: MeshShape, normals: ArrayLike) -> Array:
    """Colours (N, 3), 0 ... 255, of surfaces with normals (N, 3) in the shape's own frame."""
    facing = (np.asarray(normals, dtype=np.float64) @ shape.pose.R.T) @ _TO_LAMP
    light = _AMBIENT + (1.08 - _AMBIENT) * np.clip(facing, 0, None)
    return np.clip(np.array(shape.colour) * light[:, None], 0, 255)

"""Lines as flat ribbons that face the camera, with a constant width on the screen."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.render.shapes import LineShape

_NEAR = 0.01


def line_mesh(shape: LineShape, camera: Camera) -> tuple[Array, NDArray[np.intp]]:
    """Vertices (4 N, 3) in the camera's frame, metres, and faces (2 N, 3) of a line's segments;
    those nearer than a centimetre to the lens plane are left out."""
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

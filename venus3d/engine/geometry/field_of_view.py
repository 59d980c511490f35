"""How far a camera sees, through its lens as it is."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

_BISECTIONS = 40


@lru_cache(maxsize=8)  # milliseconds, and a page asks at each frame
def fields_of_view_deg(camera: Camera) -> tuple[float, float, float]:
    """Degrees that the picture covers: across its middle row and its middle column from edge to
    edge, and from its upper left to its lower right corner. Over 180 for a lens that sees behind
    itself; where the image circle ends within the picture, up to there."""
    w, h = camera.width - 0.5, camera.height - 0.5
    across = _between(camera, [-0.5, camera.cy], [w, camera.cy])
    down = _between(camera, [camera.cx, -0.5], [camera.cx, h])
    return across, down, _between(camera, [-0.5, -0.5], [w, h])


def _between(camera: Camera, one: list[float], other: list[float]) -> float:
    a, b = _outermost(camera, one), _outermost(camera, other)
    angle = float(np.arccos(np.clip(a @ b, -1.0, 1.0)))
    from_axis = sum(float(np.arccos(np.clip(ray[2], -1.0, 1.0))) for ray in (a, b))
    return float(np.degrees(angle if from_axis <= np.pi else 2 * np.pi - angle))


def _outermost(camera: Camera, end: list[float]) -> Array:
    """The ray of a pixel, or of the last one on the way to it that has one."""
    ray = camera.unproject(end)
    if np.isfinite(ray).all():
        return ray
    centre, edge = np.array([camera.cx, camera.cy]), np.asarray(end)
    inside, outside, found = 0.0, 1.0, camera.unproject(centre)
    for _ in range(_BISECTIONS):
        middle = (inside + outside) / 2
        ray = camera.unproject(centre + middle * (edge - centre))
        if np.isfinite(ray).all():
            inside, found = middle, ray
        else:
            outside = middle
    return found

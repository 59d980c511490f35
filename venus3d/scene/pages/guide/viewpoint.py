"""The scene camera of a guided calibration: from behind the camera at camera, board and target, or
at the strip of steps."""

from __future__ import annotations

from functools import partial

import numpy as np

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.shapes import LineShape, Shape
from venus3d.render.strip import STRIP_CENTRE, bounds_of
from venus3d.render.viewpoints import FOV_RAD, guiding_view, steps_back, view_kept_wide
from venus3d.scene.web.camera_rig import Framing


def guide_view(shapes: tuple[Shape, ...], target: int) -> tuple[object, Framing]:
    """What is looked at, and the view of it. Tabs turn only when the subject changes: the strip
    appears, changes or disappears, or the target of number `target` is far away."""
    strip = [shape for shape in shapes if shape.name.startswith("/strip/")]
    goals = [s.pose for s in shapes if isinstance(s, LineShape) and s.name == "/target/board"]
    if strip:
        # Another pose with the same number is another strip.
        return (target, goals[0].vector().tobytes()), _strip_view(bounds_of(strip))
    back = steps_back(goals[0].distance_to(Pose.identity()) if goals else 0.0)
    return back, guiding_view(back)


def _strip_view(bounds: Array) -> Framing:
    """From behind the camera at a strip with bounds (2, 3), metres."""
    x, y, z = STRIP_CENTRE
    width = 1.1 * float(bounds[1, 0] - bounds[0, 0])
    # Boards in front of the steps' common depth (start poses) look larger and need room too.
    distance = 0.5 * width / np.tan(FOV_RAD / 2) + max(0.0, z - float(bounds[0, 2]))
    eye = np.array([x, y - 0.25 * distance, z - distance])
    return partial(view_kept_wide, eye, np.array([x, y, z]), 1.0)

"""The camera in the scene: frustum, the image's true border, the axes."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import trimesh

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import AXES, Array, Pose
from venus3d.render.arrows import frame_along, straight_arrow
from venus3d.render.palette import ground, mixed, step_colour
from venus3d.render.shapes import FrustumShape, LabelShape, LineShape, MeshShape, Shape

DEPTH = 0.14
"""Distance of the frustum's picture from the lens, metres."""
AXIS_LENGTH = 0.07
_WIDE = np.cos(np.radians(60))
"""Of an image corner's angle to the axis, from which the border is drawn on a dome."""
_WIDE_SLOPE, _WIDE_DEPTH = 0.45, 0.6 * DEPTH
"""Of the picture within the dome: half its height over its distance, and that, metres."""
_trimesh: Any = trimesh  # its annotations leave most return types open


@lru_cache(maxsize=8)
def camera_shapes(camera: Camera, *, dark: bool) -> tuple[Shape, ...]:
    """Frustum, distorted border, optical axis, x y z; all with `in_projection` False."""
    colours = ground(dark)
    here = Pose.identity()
    shapes: list[Shape] = [
        frustum(camera),
        MeshShape("/camera/body", _body(), here, colours.camera, in_projection=False, shaded=True),
        LineShape("/camera/border", border_segments(camera), here, colours.camera, 2.0, False),
        LineShape("/camera/axis", _axis_segments(), here, colours.camera, 1.5, False),
    ]
    for axis, step, direction in zip(AXES, (2, 3, 4), np.eye(3), strict=True):
        # The colour of the step that turns about this axis.
        colour = step_colour(step, dark)
        name = f"/camera/axes/{axis}"
        arrow = straight_arrow(AXIS_LENGTH, 0.0022)
        place = frame_along(direction, np.zeros(3))
        shapes.append(MeshShape(name, arrow, place, colour, in_projection=False, shaded=True))
        at = direction * AXIS_LENGTH * 1.22
        shapes.append(
            LabelShape(f"{name}_label", axis, at, mixed(colour, colours.text, 0.2), False)
        )
    return tuple(shapes)


@lru_cache(maxsize=1)
def _body() -> trimesh.Trimesh:
    """A small camera behind its lens, which is at the origin; nothing of it is in front of z = 0,
    where it would be in the way of a view through the camera."""
    house = _trimesh.creation.box([0.034, 0.024, 0.02])
    house.apply_translation([0.0, 0.0, -0.025])
    grip = _trimesh.creation.box([0.012, 0.006, 0.011])
    grip.apply_translation([0.0, -0.015, -0.025])
    tube = _trimesh.creation.cylinder(0.01, segment=[[0, 0, -0.016], [0, 0, -0.003]], sections=24)
    return _trimesh.util.concatenate([house, grip, tube])


def frustum(camera: Camera) -> FrustumShape:
    """The frustum with its picture at `DEPTH`, about the optical axis (the border's lines show the
    true principal point). No pyramid holds what a wide lens sees: its picture is inside the dome on
    which the border is drawn. viser scales a frustum to a volume: depth = scale / cbrt(tan(fov/2)^2
    aspect / 3)."""
    slope, depth = camera.height / (2 * camera.fy), DEPTH
    if _is_wide(camera):
        slope, depth = min(slope, _WIDE_SLOPE), _WIDE_DEPTH
    aspect = (camera.width / camera.fx) / (camera.height / camera.fy)
    scale = depth * np.cbrt(slope**2 * aspect / 3)
    return FrustumShape("/camera/frustum", 2 * float(np.arctan(slope)), aspect, float(scale), None)


def _is_wide(camera: Camera) -> bool:
    if camera.lens.is_perspective:
        return False
    return not (camera.unproject(camera.image_corners)[:, 2] > _WIDE).all()


@lru_cache(maxsize=8)
def border_segments(camera: Camera) -> Array:
    """(N, 2, 3) the image's border where its rays meet z = `DEPTH`, with lens distortion, or a
    sphere of this radius if the lens sees far to the side, and the rim of the image circle; without
    segments that no ray reaches."""
    w, h = camera.width - 0.5, camera.height - 0.5
    along = np.linspace(0, 1, 25)[:, None]
    corners = np.array([[-0.5, -0.5], [w, -0.5], [w, h], [-0.5, h]])
    edges = [a + along * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)]
    if camera.image_circle is not None:
        edges.append(camera.image_circle.border(camera.image_size))
    rays = [camera.unproject(edge) for edge in edges]
    if not _is_wide(camera):
        rays = [line / line[:, 2:] for line in rays]
    segments = DEPTH * np.concatenate([np.stack([r[:-1], r[1:]], axis=1) for r in rays])
    return segments[np.isfinite(segments).all(axis=(1, 2))]


@lru_cache(maxsize=1)
def _axis_segments() -> Array:
    """The optical axis, and a cross where it meets the picture: the principal point."""
    arm, z = 0.06 * DEPTH, DEPTH
    return np.array(
        [
            [[0, 0, 0], [0, 0, z]],
            [[-arm, 0, z], [arm, 0, z]],
            [[0, -arm, z], [0, arm, z]],
        ],
        dtype=np.float64,
    )

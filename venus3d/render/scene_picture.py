"""The scene from outside, drawn offscreen: what the page shows in 3D, as a picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from concurrent.futures import Future
from dataclasses import replace

import numpy as np

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.framing import points_of
from venus3d.render.offscreen import Image, Offscreen
from venus3d.render.palette import ground, picture_background
from venus3d.render.shapes import FrustumShape, LabelShape, LineShape, MeshShape, Shape
from venus3d.render.viewpoints import SceneCamera


def scene_picture(
    offscreen: Offscreen,
    shapes: Iterable[Shape],
    view: SceneCamera,
    size: tuple[int, int],
    *,
    dark: bool,
) -> Future[Image]:
    """The picture (RGB) of these shapes from a viewpoint, `size` (width, height); the floor's grid,
    clouds of points and the names of the camera's axes are left out."""
    width, height = size
    focal = height / 2 / float(np.tan(view.fov_rad / 2))
    eye = Camera(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2)
    T_view_camera = Pose(view.axes, -view.axes @ view.position)
    seen = [moved for shape in shapes for moved in _seen(shape, T_view_camera, dark)]
    return offscreen.submit(eye, seen, background=picture_background(dark), size=size)


def _seen(shape: Shape, T_view_camera: Pose, dark: bool) -> Iterator[Shape]:
    """The shape in the viewpoint's frame, as far as it is drawn."""
    match shape:
        case MeshShape() | LineShape():
            yield replace(shape, pose=T_view_camera @ shape.pose, in_projection=True)
        case LabelShape() if not shape.name.startswith("/camera/"):
            at = T_view_camera.apply(shape.position)
            yield replace(shape, position=at, in_projection=True)
        case FrustumShape():
            lens, *corners = points_of(shape)
            edges = np.array([[lens, corner] for corner in corners])
            yield LineShape(shape.name, edges, T_view_camera, ground(dark).camera)
        case _:
            return

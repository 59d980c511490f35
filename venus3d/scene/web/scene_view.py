"""Draws the list of shapes in the browser.

A node is created once per name; later only changes are sent, all of one moment in one atomic batch,
so that no tab shows half a step. Names that are no longer drawn are hidden and kept. Names must not
nest (no "/a" beside "/a/b"): viser would move the inner shape with the outer one, while all shapes
are in the camera's frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.palette import ground
from venus3d.render.shapes import (
    FrustumShape,
    LabelShape,
    LineShape,
    MeshShape,
    PointShape,
    Shape,
)

Host = viser.ViserServer | viser.ClientHandle
"""Where a page or a scene lives: all tabs, or one."""

_FRUSTUM_PICTURE_WIDTH = 320
_LABEL_SCALE = 1.25


@dataclass
class _Node:
    shape: Shape
    handle: Any


class SceneView:
    """The 3D scene of a server, or of one tab. Used by one thread."""

    def __init__(self, host: Host) -> None:
        """An empty scene with the camera's up direction and even light."""
        self._host = host
        self._nodes: dict[str, _Node] = {}
        self._picture: NDArray[np.uint8] | None = None
        scene = host.scene
        scene.set_up_direction("-y")
        scene.configure_default_lights(enabled=False)
        scene.configure_environment_map(None)
        # Even ambient light, since a board must read as a pattern, not a shaded object. Both lights
        # add up to about pi, which shows a colour unchanged.
        scene.add_light_ambient("/light/even", intensity=2.5)
        scene.add_light_directional(
            "/light/eye", intensity=0.9, position=(-0.6, -1.0, -1.0), cast_shadow=False
        )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the visible shapes."""
        nodes = tuple(self._nodes.items())  # another thread may be drawing
        return tuple(name for name, node in nodes if node.handle.visible)

    def node(self, name: str) -> Any:
        """viser's handle of a drawn shape, for binding gestures; None before it is drawn."""
        found = self._nodes.get(name)
        return None if found is None else found.handle

    def draw(self, shapes: tuple[Shape, ...], *, dark: bool) -> None:
        """Show these shapes and no others of ours."""
        with self._host.atomic():
            for shape in shapes:
                self._draw_one(shape, dark)
            drawn = {shape.name for shape in shapes}
            for name, node in self._nodes.items():
                if name not in drawn:
                    node.handle.visible = False

    def set_picture(self, rgb: NDArray[np.uint8]) -> None:
        """Put the live picture (H, W, 3) RGB into the frustum."""
        height = round(rgb.shape[0] * _FRUSTUM_PICTURE_WIDTH / rgb.shape[1])
        size = (_FRUSTUM_PICTURE_WIDTH, height)
        self._picture = np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), np.uint8)
        for node in tuple(self._nodes.values()):
            if isinstance(node.shape, FrustumShape):
                node.handle.image = self._picture

    def _draw_one(self, shape: Shape, dark: bool) -> None:
        node = self._nodes.get(shape.name)
        if node is not None and node.shape is shape:
            node.handle.visible = True
            return
        if node is not None and not _same_kind(node.shape, shape):
            node.handle.remove()
            node = None
        if node is None:
            self._nodes[shape.name] = _Node(shape, self._create(shape, dark))
            return
        if isinstance(shape, MeshShape):
            _update_mesh(node, shape)
        elif isinstance(shape, LineShape):
            _update_line(node, shape)
        elif isinstance(shape, LabelShape):
            node.handle.text = shape.text
            node.handle.position = tuple(shape.position)
        elif isinstance(shape, PointShape):
            node.handle.points, node.handle.colors = shape.points, shape.colours
            node.handle.point_size = shape.size
        else:
            node.handle.fov, node.handle.aspect = shape.fov_y_rad, shape.aspect
            node.handle.scale = shape.scale
            node.handle.color = ground(dark).camera
        node.handle.visible = True
        node.shape = shape

    def _create(self, shape: Shape, dark: bool) -> Any:
        scene = self._host.scene
        if isinstance(shape, MeshShape):
            if shape.textured:
                return scene.add_mesh_trimesh(
                    shape.name, shape.mesh, **_place(shape.pose), cast_shadow=False
                )
            return scene.add_mesh_simple(
                shape.name,
                *_mesh_arrays(shape),
                color=shape.colour,
                opacity=_opacity(shape),
                side="double",
                cast_shadow=False,
                receive_shadow=False,
                **_place(shape.pose),
            )
        if isinstance(shape, LineShape):
            return scene.add_line_segments(
                shape.name,
                shape.segments,
                shape.colour,
                thickness=shape.width_px,
                thickness_units="screen",
                **_place(shape.pose),
            )
        if isinstance(shape, LabelShape):
            return scene.add_label(
                shape.name,
                shape.text,
                position=shape.position,
                font_screen_scale=_LABEL_SCALE,
                anchor="center-center",
            )
        if isinstance(shape, PointShape):
            return scene.add_point_cloud(
                shape.name,
                shape.points,
                shape.colours,
                point_size=shape.size,
                point_shape="circle",
                point_shading="flat",
                precision="float32",
            )
        return scene.add_camera_frustum(
            shape.name,
            shape.fov_y_rad,
            shape.aspect,
            scale=shape.scale,
            thickness=2.0,
            thickness_units="screen",
            color=ground(dark).camera,
            image=self._picture if shape.image is None else shape.image,
            jpeg_quality=75,
            cast_shadow=False,
        )


def _same_kind(old: Shape, new: Shape) -> bool:
    if isinstance(old, MeshShape) and isinstance(new, MeshShape):
        # A textured mesh is one opaque GLB: another mesh needs another node.
        return old.textured == new.textured and not (new.textured and old.mesh is not new.mesh)
    return type(old) is type(new)


def _place(pose: Pose) -> dict[str, Any]:
    return {"wxyz": pose.wxyz, "position": pose.t}


def _opacity(shape: MeshShape) -> float | None:
    return None if shape.opacity >= 1.0 else shape.opacity


def _mesh_arrays(shape: MeshShape) -> tuple[Array, NDArray[np.uint32]]:
    mesh: Any = shape.mesh
    return np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.uint32)


def _move(handle: Any, pose: Pose) -> None:
    handle.wxyz, handle.position = pose.wxyz, pose.t


def _update_mesh(node: _Node, shape: MeshShape) -> None:
    handle: Any = node.handle
    _move(handle, shape.pose)
    if shape.textured:
        return
    if not (isinstance(node.shape, MeshShape) and node.shape.mesh is shape.mesh):
        handle.vertices, handle.faces = _mesh_arrays(shape)
    handle.color, handle.opacity = shape.colour, _opacity(shape)


def _update_line(node: _Node, shape: LineShape) -> None:
    handle, old = node.handle, node.shape
    _move(handle, shape.pose)
    if not (isinstance(old, LineShape) and old.segments is shape.segments):
        handle.points = shape.segments
    # One colour for all: viser takes per-point colours as linear light and shows them paler.
    handle.colors = np.asarray(shape.colour, np.uint8)
    handle.thickness = shape.width_px

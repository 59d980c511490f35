"""Renderer of shapes with pyrender. Imported only by the thread that owns OpenGL.

`PYOPENGL_PLATFORM` must be set before the import. Lens, labels and backgrounds are `offscreen`'s.
pyrender's last release (2021) reads the depth buffer back each time, frees whatever the current
scene does not show, and sorts translucent meshes by the origins of their frames; the subclasses
below change that.
"""

from __future__ import annotations

import ctypes
from collections import OrderedDict
from collections.abc import Sequence
from typing import Any

import numpy as np
import pyrender
import trimesh
from numpy.typing import NDArray
from OpenGL import EGL, GL
from OpenGL.plugins import FormatHandler
from pyrender.platforms.egl import EGLPlatform, get_device_by_index
from pyrender.renderer import Renderer

from venus3d.engine.geometry.camera import Camera
from venus3d.render.shapes import Colour, LineShape, MeshShape, line_mesh, shaded_colours

# `ctypes.byref` returns `builtins.CArgObject` up to Python 3.11, `_ctypes.CArgObject` from 3.12.
# PyOpenGL 3.1.0, which pyrender pins, looks up handlers by that name, knows only the old one and so
# can make no texture. Registering a known name again changes nothing.
_by_reference = type(ctypes.byref(ctypes.c_int()))
FormatHandler(
    "ctypesparameter",
    "OpenGL.arrays.ctypesparameters.CtypesParameterHandler",
    [f"{_by_reference.__module__}.{_by_reference.__name__}"],
)

KEPT_MESHES = 64
PRIVATE: dict[type[Any], tuple[str, ...]] = {
    EGLPlatform: ("_egl_context", "_egl_display"),
    Renderer: (
        "_configure_forward_pass_viewport",
        "_forward_pass",
        "_sorted_mesh_nodes",
        "_bind_and_draw_primitive",
        "_read_main_framebuffer",
        "_main_fb",
        "_main_fb_ms",
    ),
}
"""Private names of pyrender that are used or overridden below."""
_FLAGS = pyrender.RenderFlags.FLAT | pyrender.RenderFlags.OFFSCREEN | pyrender.RenderFlags.RGBA
_OPENGL_FROM_OPENCV = np.diag([1.0, -1.0, -1.0, 1.0])
_NEAR, _FAR = 0.01, 20.0
_SPARE_PX = 3
_ON_TOP = 0.1
"""Share of the depth range reserved for shapes that nothing may hide."""


class GlRenderer:
    """Draws meshes and lines through an ideal pinhole. Belongs to the thread that created it."""

    def __init__(self, *, smooth: bool = True) -> None:
        """`smooth`: 4x multisampling; takes twice as long."""
        self._platform = _Platform(64, 64, device=get_device_by_index(0))
        self._platform.init_context()
        self._renderer = _Renderer(64, 64)
        self._renderer.smooth = smooth
        GL.glFrontFace(GL.GL_CW)  # the first row is the top one (see the camera)
        self._scene: Any = pyrender.Scene(bg_color=[0.0, 0.0, 0.0, 0.0])
        self._camera_node: Any = self._scene.add(
            _TopDownCamera(1, 1, 0, 0, znear=_NEAR, zfar=_FAR), pose=_OPENGL_FROM_OPENCV
        )
        # Holding the source mesh keeps its id from being reused.
        self._nodes: OrderedDict[tuple[Any, ...], tuple[Any, Any]] = OrderedDict()

    def render(
        self, camera: Camera, shapes: Sequence[MeshShape | LineShape], background: Colour
    ) -> NDArray[np.uint8]:
        """RGBA (H, W, 4) of the shapes on a plain background; alpha is meaningless."""
        self._platform.make_current()
        self._scene.bg_color = np.array((*background, 255)) / 255.0
        lens = self._camera_node.camera
        lens.fx, lens.fy = camera.fx, camera.fy
        # pyrender's pixel origin is the pixel's edge, OpenCV's its centre.
        lens.cx, lens.cy = camera.cx + 0.5, camera.cy + 0.5
        self._renderer.viewport_width, self._renderer.viewport_height = camera.image_size
        used: set[tuple[Any, ...]] = set()
        passing: list[Any] = []
        order: list[tuple[bool, Any]] = []
        for shape in shapes:
            if isinstance(shape, LineShape):
                node = self._scene.add(_line_mesh(shape, camera))
                passing.append(node)
                order.append((False, node))
            else:
                node = self._node_of(shape, used)
                order.append((shape.opacity < 1, node))
            node.mesh.primitives[0].on_top = shape.on_top
        # Opaque shapes first, then translucent ones in list order.
        self._renderer.order = [
            n for late in (False, True) for is_late, n in order if is_late == late
        ]
        window = self._renderer.window = _window_of(shapes, camera)
        # One number per pixel: numpy repeats four a hundred times as slowly.
        plain = np.array((*background, 255), dtype=np.uint8).view(np.uint32)[0]
        picture = np.full((camera.height, camera.width, 1), plain).view(np.uint8)
        try:
            drawn = self._renderer.render(self._scene, _FLAGS)
            x, y, width, height = window
            picture[y : y + height, x : x + width] = drawn
            return picture
        finally:
            for node in passing:
                self._scene.remove_node(node)
            self._forget(used)

    def close(self) -> None:
        """Release the graphics memory and the context."""
        try:
            self._platform.make_current()
            self._renderer.delete()
        finally:
            self._platform.delete_context()

    def _node_of(self, shape: MeshShape, used: set[tuple[Any, ...]]) -> Any:
        key = _key(shape)
        while key in used:  # a mesh used twice in one picture needs a second node
            key = (*key, "again")
        used.add(key)
        if key not in self._nodes:
            self._nodes[key] = (shape.mesh, self._scene.add(_gl_mesh(shape)))
        self._nodes.move_to_end(key)
        node = self._nodes[key][1]
        self._scene.set_pose(node, shape.pose.matrix)
        return node

    def _forget(self, used: set[tuple[Any, ...]]) -> None:
        while len(self._nodes) > max(KEPT_MESHES, len(used)):
            self._scene.remove_node(self._nodes.popitem(last=False)[1][1])


class _TopDownCamera(pyrender.IntrinsicsCamera):
    """Renders the top row first, as OpenCV has it, so that nothing need be flipped."""

    def get_projection_matrix(self, width: int | None = None, height: int | None = None) -> Any:
        P = np.asarray(super().get_projection_matrix(width, height), dtype=np.float64)
        P[1] *= -1
        return P


class _Platform(EGLPlatform):
    """Offscreen EGL; closing one context leaves the display to the others."""

    def delete_context(self) -> None:
        if self._egl_context is not None:
            EGL.eglDestroyContext(self._egl_display, self._egl_context)
        self._egl_context = self._egl_display = None


class _Renderer(Renderer):
    order: list[Any]
    window: tuple[int, int, int, int]
    """The part (x, y, width, height) that is cleared, drawn and read; cost grows with its area."""
    smooth: bool

    def _configure_forward_pass_viewport(self, flags: int) -> None:
        super()._configure_forward_pass_viewport(flags)
        if not self.smooth:
            GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self._main_fb)

    def _forward_pass(self, *args: Any, **kwargs: Any) -> Any:
        GL.glEnable(GL.GL_SCISSOR_TEST)
        GL.glScissor(*self.window)
        try:
            return super()._forward_pass(*args, **kwargs)
        finally:
            GL.glDisable(GL.GL_SCISSOR_TEST)

    def _sorted_mesh_nodes(self, scene: Any) -> list[Any]:
        return self.order

    def _bind_and_draw_primitive(self, primitive: Any, *args: Any, **kwargs: Any) -> None:
        # A translucent sheet must not hide what is drawn later.
        GL.glDepthMask(primitive.material.alphaMode != "BLEND")
        GL.glDepthRange(*((0.0, _ON_TOP) if primitive.on_top else (_ON_TOP, 1.0)))
        super()._bind_and_draw_primitive(primitive, *args, **kwargs)
        GL.glDepthMask(True)

    def _read_main_framebuffer(self, scene: Any, flags: int) -> Any:
        x, y, width, height = self.window
        box = (x, y, x + width, y + height)
        if self.smooth:
            GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._main_fb_ms)
            GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, self._main_fb)
            GL.glBlitFramebuffer(*box, *box, GL.GL_COLOR_BUFFER_BIT, GL.GL_LINEAR)
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, self._main_fb)
        rgba: Any = GL.glReadPixels(x, y, width, height, GL.GL_RGBA, GL.GL_UNSIGNED_BYTE)
        return np.frombuffer(rgba, dtype=np.uint8).reshape(height, width, 4)


def _window_of(
    shapes: Sequence[MeshShape | LineShape], camera: Camera
) -> tuple[int, int, int, int]:
    """(x, y, width, height) of the part of the picture that meshes can touch; all of it if there
    are lines or something reaches behind the lens."""
    whole = (0, 0, camera.width, camera.height)
    corners = [
        shape.pose.apply(trimesh.bounds.corners(shape.mesh.bounds))
        for shape in shapes
        if isinstance(shape, MeshShape)
    ]
    if len(corners) < len(shapes) or not corners:
        return whole
    points = np.concatenate(corners)
    if points[:, 2].min() < _NEAR:
        return whole
    pixels = camera.project(points)
    size = np.array(camera.image_size)
    low = np.clip(np.floor(pixels.min(axis=0)).astype(int) - _SPARE_PX, 0, size - 1)
    high = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + _SPARE_PX + 1, low + 1, size)
    (x, y), (width, height) = (pair.tolist() for pair in (low, high - low))
    return (x, y, width, height)


def _key(shape: MeshShape) -> tuple[Any, ...]:
    if shape.textured:
        return (id(shape.mesh), shape.opacity)
    # Shading is baked into the colours, so a shaded mesh that turned is a new mesh.
    turn = shape.pose.R.round(3).tobytes() if shape.shaded else None
    return (id(shape.mesh), shape.opacity, shape.colour, turn)


def _gl_mesh(shape: MeshShape) -> Any:
    mesh = shape.mesh
    texture: Any = None
    uv: Any = None
    if shape.textured:
        visual: Any = mesh.visual
        uv = np.asarray(visual.uv, dtype=np.float32)
        source = np.asarray(visual.material.baseColorTexture.convert("RGB"))
        clamp = pyrender.constants.GLTF.CLAMP_TO_EDGE
        texture = pyrender.Texture(
            source=source, source_channels="RGB", sampler=pyrender.Sampler(wrapS=clamp, wrapT=clamp)
        )
    factor = [1.0, 1.0, 1.0, shape.opacity]
    colours = None
    if shape.shaded:
        colours = np.column_stack(
            [shaded_colours(shape, mesh.vertex_normals) / 255.0, np.ones(len(mesh.vertices))]
        )
    elif not shape.textured:
        factor[:3] = [c / 255.0 for c in shape.colour]
    primitive = pyrender.Primitive(
        positions=np.asarray(mesh.vertices, dtype=np.float32),
        indices=np.asarray(mesh.faces, dtype=np.uint32),
        texcoord_0=uv,
        color_0=colours,
        material=pyrender.MetallicRoughnessMaterial(
            baseColorFactor=factor,
            baseColorTexture=texture,
            alphaMode="OPAQUE" if shape.opacity >= 1 else "BLEND",
            # Boards fill most of a picture and are uploaded once; no other mesh is worth checking.
            doubleSided=not (shape.textured and shape.opacity >= 1 and _is_closed(mesh)),
        ),
    )
    return pyrender.Mesh([primitive])


def _is_closed(mesh: trimesh.Trimesh) -> bool:
    """Whether its back faces are never visible, so that they need not be drawn."""
    merged = mesh.copy()
    merged.merge_vertices(merge_tex=True, merge_norm=True)
    return bool(merged.is_watertight and merged.is_winding_consistent and merged.volume > 0)


def _line_mesh(shape: LineShape, camera: Camera) -> Any:
    vertices, faces = line_mesh(shape, camera)
    primitive = pyrender.Primitive(
        positions=vertices.astype(np.float32),
        indices=faces.astype(np.uint32),
        material=pyrender.MetallicRoughnessMaterial(
            baseColorFactor=[*(c / 255.0 for c in shape.colour), 1.0],
            alphaMode="OPAQUE",
            doubleSided=True,
        ),
    )
    return pyrender.Mesh([primitive])

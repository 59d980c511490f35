"""Draws the list of shapes in the browser.

A node is created once per name; later only changes are sent, all of one moment in one atomic batch,
so that no tab shows half a step. Names that are no longer drawn are hidden and kept. Names must not
nest (no "/a" beside "/a/b"): viser would move the inner shape with the outer one, while all shapes
are in the camera's frame.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
import trimesh
import viser
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.facing_arrows import facing
from venus3d.render.framing import picture_among, shares_at_picture
from venus3d.render.palette import ground
from venus3d.render.shapes import (
    FrustumShape,
    GridShape,
    LabelShape,
    LineShape,
    MeshShape,
    PointShape,
    Shape,
)
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.web.labels import SceneLabel, put_labels
from venus3d.scene.web.shared_view import SharedView

Host = viser.ViserServer | viser.ClientHandle
"""Where a page or a scene lives: all tabs, or one."""

_FRUSTUM_PICTURE_WIDTH = 320
_NEARER: dict[str, float] = {"-in-front": 0.45, "-nearer": 0.3, "-nearest": 0.2}
"""Shares of the way from the eye at which shapes are drawn that nothing may hide: smaller and
nearer, so that they look the same. The first is twice as far as labels: at 0.25, an arrow's end
that was nearer than a label covered its letters. The others are for a camera near the eye, whose
picture would be before the first. Each is a node of its own beside the one in its true place, since
a browser applies a node's position at once but its scale only when it comes to it: a shape that is
near already and not yet small fills the window."""
_PULSE_S, _PULSE_OPACITY = 0.7, 0.9
"""How long the end of a new step is stronger, once, and how strong."""
_ENDS = re.compile("/steps/[1-4]/after")
_ARROW = re.compile("^/(steps|strip)/.*/arrow")
_SAMPLED = 16
"""Faces of an arrow's mesh that labels keep away from."""
_FADES_AT = 4.0  # metres from the eye


@dataclass
class _Node:
    shape: Shape
    handle: Any


class SceneView:
    """The 3D scene of a server, or of one tab. Used by one thread."""

    def __init__(
        self,
        host: Host,
        *,
        wake: Callable[[], None] = lambda: None,
        arrived: Callable[[], bool] = lambda: True,
        plain_labels: bool = False,
    ) -> None:
        """An empty scene with the camera's up direction and even light.

        Args:
            wake: called on viser's threads when `refresh` is due, since a tab's view moves.
            arrived: whether the tabs show the views that they were sent (`CameraRig.arrived`).
            plain_labels: viser's own labels, which a recording can hold.
        """
        self._host, self._plain_labels = host, plain_labels
        self._view = SharedView(host, wake)
        self._arrived = arrived
        self._drawn: tuple[tuple[Shape, ...], bool] = ((), True)
        self._drawn_from: tuple[object, bool] = (None, False)
        self._nodes: dict[str, _Node] = {}
        self._changing: list[SceneLabel] = []
        """Labels that do not say their texts yet."""
        self._pulsed: str | None = None
        """The step's end that was made stronger last, and when that began, while it lasts."""
        self._pulsing: float | None = None
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
        return tuple(_true_name(name) for name, node in nodes if node.handle.visible)

    def node(self, name: str) -> Any:
        """viser's handle of a drawn shape, for binding gestures; None before it is drawn."""
        nearer = [self._nodes[name + end] for end in _NEARER if name + end in self._nodes]
        found = next((node for node in nearer if node.handle.visible), self._nodes.get(name))
        return None if found is None else found.handle

    def draw(self, shapes: tuple[Shape, ...], *, dark: bool) -> None:
        """Show these shapes and no others of ours."""
        self._drawn = shapes, dark
        view, at_rest = self._drawn_from = self._view_now()
        if view is not None and at_rest and not self._plain_labels:
            eye, picture = view.position, picture_among(shapes)
            shapes = tuple(_in_front(facing(shape, view), eye, picture) for shape in shapes)
        with self._host.atomic():
            for shape in shapes:
                self._draw_one(shape, dark)
            drawn = {shape.name for shape in shapes}
            for name, node in self._nodes.items():
                if name not in drawn:
                    node.handle.visible = False
            labels = [
                (shape, self._nodes[shape.name].handle)
                for shape in shapes
                if isinstance(shape, LabelShape)
            ]
            seen_from = None if self._plain_labels else view
            tips, window_px = _tips(self._drawn[0]), self._view.window_px
            put_labels(labels, seen_from, window_px, tips, _shafts(shapes))
            self._changing = [label for _, label in labels if label.is_changing]
            self._pulse()

    @property
    def is_due(self) -> bool:
        """Whether `refresh` is due, now or soon."""
        moving = self._pulsing is not None or self._changing or not self._at_rest
        return bool(moving) or self._view_now() != self._drawn_from

    def refresh(self) -> None:
        """Draw the same shapes again for the point of view of now."""
        settled = any(label.is_due for label in self._changing)
        if settled or self._view_now() != self._drawn_from:
            shapes, dark = self._drawn
            self.draw(shapes, dark=dark)
        elif self._pulsing is not None:
            self._pulse()

    def _pulse(self) -> None:
        """Make the plate at the end of a new step stronger for a moment. It only fades: nothing
        moves, so it suits those who want no motion too."""
        plates = [shape for shape in self._drawn[0] if isinstance(shape, MeshShape)]
        end = next((plate for plate in plates if _ENDS.fullmatch(plate.name)), None)
        name = None if end is None else end.name
        if name != self._pulsed:
            self._pulsed, self._pulsing = name, None if name is None else time.monotonic()
        if end is None or self._pulsing is None:
            return
        done = (time.monotonic() - self._pulsing) / _PULSE_S
        more = (_PULSE_OPACITY - end.opacity) * np.sin(np.pi * min(done, 1.0))
        self._nodes[end.name].handle.opacity = end.opacity + float(more)
        if done >= 1:
            self._pulsing = None

    def _view_now(self) -> tuple[SceneCamera | None, bool]:
        return self._view.now(), self._at_rest

    @property
    def _at_rest(self) -> bool:
        """Whether the eye is where the program thinks it is: a slow browser is still on its way
        when the last view of a flight has long been sent."""
        return self._view.at_rest and self._arrived()

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
            node.handle.show(shape)
        elif isinstance(shape, PointShape):
            node.handle.points, node.handle.colors = shape.points, shape.colours
            node.handle.point_size = shape.size
        elif isinstance(shape, GridShape):
            node.handle.cell_color, node.handle.section_color = shape.colour, shape.section_colour
        else:
            node.handle.fov, node.handle.aspect = shape.fov_y_rad, shape.aspect
            node.handle.scale = shape.scale
            node.handle.color = ground(dark).camera
        node.handle.visible = True
        node.shape = shape

    def _create(self, shape: Shape, dark: bool) -> Any:
        scene = self._host.scene
        if isinstance(shape, MeshShape):
            scale = _NEARER.get(shape.name.removeprefix(_true_name(shape.name)), 1.0)
            if shape.textured:
                return scene.add_mesh_trimesh(
                    shape.name, shape.mesh, scale=scale, **_place(shape.pose), cast_shadow=False
                )
            return scene.add_mesh_simple(
                shape.name,
                *_mesh_arrays(shape),
                color=shape.colour,
                opacity=_opacity(shape),
                scale=scale,
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
            return SceneLabel(self._host, shape)
        if isinstance(shape, GridShape):
            return scene.add_grid(
                shape.name,
                plane="xz",
                cell_size=shape.cell,
                section_size=shape.section,
                cell_color=shape.colour,
                section_color=shape.section_colour,
                infinite_grid=True,
                fade_distance=_FADES_AT,
                fade_strength=1.5,
                shadow_opacity=0.0,
                position=(0.0, shape.height, 0.0),
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


def _in_front(shape: Shape, eye: Array, picture: Array) -> Shape:
    """A shape that nothing may hide, nearer to the eye (3,), and before the frustum's `picture`
    (`picture_among`); others as they are."""
    if not (isinstance(shape, MeshShape) and shape.on_top):
        return shape
    points = shape.pose.apply(np.asarray(shape.mesh.vertices, np.float64))
    hidden_from = shares_at_picture(points, eye[None], picture).min()
    fits = (name for name, share in _NEARER.items() if share < hidden_from)
    name = next(fits, tuple(_NEARER)[-1])
    pose = Pose(shape.pose.R, eye + _NEARER[name] * (shape.pose.t - eye))
    return replace(shape, name=shape.name + name, pose=pose)


def _tips(shapes: Sequence[Shape]) -> list[Array]:
    """(3,) where each arrow points."""
    arrows = (shape for shape in shapes if isinstance(shape, MeshShape))
    return [arrow.pose.apply(arrow.ends)[1] for arrow in arrows if arrow.ends is not None]


def _shafts(shapes: Sequence[Shape]) -> Array:
    """(N, 3) points on the arrows of the steps, as they are drawn."""
    arrows = [s for s in shapes if isinstance(s, MeshShape) and _ARROW.search(s.name)]
    points = [arrow.pose.apply(_sampled(arrow.mesh)) for arrow in arrows]
    return np.concatenate(points or [np.zeros((0, 3))])


@lru_cache(maxsize=64)
def _sampled(mesh: trimesh.Trimesh) -> Array:
    """(N, 3) points along the edges of some of the mesh's faces."""
    faces = np.asarray(mesh.faces)[:: max(1, len(mesh.faces) // _SAMPLED)]
    corners = np.asarray(mesh.vertices, np.float64)[faces]
    along = np.linspace(0, 1, 5)[:-1, None, None, None]
    return (corners + along * (np.roll(corners, -1, axis=1) - corners)).reshape(-1, 3)


def _true_name(name: str) -> str:
    """A shape's name, of whichever of its nodes."""
    for end in _NEARER:
        name = name.removesuffix(end)
    return name


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


def _move(handle: Any, old: Shape, pose: Pose) -> None:
    # viser leaves out what is so already, too, but with a comparison that takes longer.
    before = old.pose if isinstance(old, MeshShape | LineShape) else None
    if before is None or not np.array_equal(before.R, pose.R):
        handle.wxyz = pose.wxyz
    if before is None or not np.array_equal(before.t, pose.t):
        handle.position = pose.t


def _update_mesh(node: _Node, shape: MeshShape) -> None:
    handle, old = node.handle, node.shape
    _move(handle, old, shape.pose)
    if shape.textured or not isinstance(old, MeshShape):
        return
    if old.mesh is not shape.mesh:
        handle.vertices, handle.faces = _mesh_arrays(shape)
    # Setting what is so already takes viser longer than a comparison.
    if (old.colour, old.opacity) != (shape.colour, shape.opacity):
        handle.color, handle.opacity = shape.colour, _opacity(shape)


def _update_line(node: _Node, shape: LineShape) -> None:
    handle, old = node.handle, node.shape
    _move(handle, old, shape.pose)
    if not isinstance(old, LineShape) or old.segments is not shape.segments:
        handle.points = shape.segments
    if isinstance(old, LineShape) and (old.colour, old.width_px) == (shape.colour, shape.width_px):
        return
    # One colour for all: viser takes per-point colours as linear light and shows them paler.
    handle.colors = np.asarray(shape.colour, np.uint8)
    handle.thickness = shape.width_px

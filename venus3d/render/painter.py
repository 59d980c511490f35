"""A small software renderer, used without OpenGL; it fills polygons with OpenCV. It draws through
an ideal pinhole with a depth buffer, slower than OpenGL and without antialiasing; a printed board
is warped as a whole, so its corners are exact."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
import trimesh
from numpy.typing import NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.render.shapes import Colour, LineShape, MeshShape, line_mesh, shaded_colours

_NEAR = 0.01
_SUBPIXEL_BITS = 6
_LARGEST_PX = 30000


class Painter:
    """Draws meshes and lines through an ideal pinhole with OpenCV. Stateless."""

    def render(
        self, camera: Camera, shapes: Sequence[MeshShape | LineShape], background: Colour
    ) -> NDArray[np.uint8]:
        """RGBA (H, W, 4) of the shapes on a plain background; alpha is meaningless."""
        canvas = _Canvas(camera, background)
        # Opaque shapes first, then translucent ones in list order.
        for shape in sorted(shapes, key=lambda s: isinstance(s, MeshShape) and s.opacity < 1):
            if isinstance(shape, LineShape):
                vertices, faces = line_mesh(shape, camera)
                colours = np.tile(np.array(shape.colour, dtype=np.float64), (len(faces), 1))
                canvas.fill(vertices[faces], colours, on_top=shape.on_top)
            elif shape.textured:
                _paint_textured(canvas, shape)
            else:
                triangles = shape.pose.apply(shape.mesh.vertices)[shape.mesh.faces]
                colours = (
                    shaded_colours(shape, shape.mesh.face_normals)
                    if shape.shaded
                    else np.tile(np.array(shape.colour, dtype=np.float64), (len(triangles), 1))
                )
                canvas.fill(triangles, colours, shape.opacity, on_top=shape.on_top)
        return canvas.picture

    def close(self) -> None:
        """Nothing to release."""


class _Canvas:
    """A picture with a buffer of inverse depths."""

    def __init__(self, camera: Camera, background: Colour) -> None:
        self.camera = camera
        size = (camera.height, camera.width)
        self.picture = np.full((*size, 4), (*background, 255), dtype=np.uint8)
        self.nearness = np.zeros(size, dtype=np.float32)
        """1 / z of each pixel's surface, 1/m."""
        self.touched = np.zeros(size, dtype=np.bool_)
        """Where the current sheet is painted: pixels shared by two triangles must not blend
        twice."""

    def fill(
        self,
        triangles: Array,
        colours: Array,
        opacity: float = 1.0,
        layer: NDArray[np.uint8] | None = None,
        on_top: bool = False,
    ) -> None:
        """Fill triangles (N, 3, 3), camera frame, with colours (N, 3) or with pixels of `layer`."""
        lift, camera = 1 / _NEAR if on_top else 0.0, self.camera
        self.touched[:] = False
        ahead = (triangles[..., 2] > _NEAR).all(axis=1)
        triangles, colours = triangles[ahead], colours[ahead]
        focal, centre = [camera.fx, camera.fy], [camera.cx, camera.cy]
        pixels = triangles[..., :2] / triangles[..., 2:] * focal + centre
        first, *others = triangles.transpose(1, 0, 2)
        normals = np.cross(*(other - first for other in others))
        offsets = (normals * first).sum(axis=1)
        # Not those seen exactly edge-on, nor beyond what OpenCV's fixed point holds.
        drawn = (np.abs(offsets) > 1e-12) & (np.abs(pixels).max(axis=(1, 2)) < _LARGEST_PX)
        for one in np.flatnonzero(drawn):
            plane = normals[one] / offsets[one]
            self._fill_one(pixels[one], plane, colours[one], opacity, layer, lift)

    def _fill_one(
        self,
        pixels: Array,
        plane: Array,
        colour: Array,
        opacity: float,
        layer: NDArray[np.uint8] | None,
        lift: float,
    ) -> None:
        """Fill a triangle with corners (3, 2), pixels, in the plane {p: plane·p = 1}."""
        camera = self.camera
        low = np.maximum(np.floor(pixels.min(axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(pixels.max(axis=0)).astype(int) + 1, camera.image_size)
        if (high <= low).any():
            return
        box = np.s_[low[1] : high[1], low[0] : high[0]]
        mask = np.zeros((high[1] - low[1], high[0] - low[0]), dtype=np.uint8)
        fixed = np.round((pixels - low) * (1 << _SUBPIXEL_BITS)).astype(np.int32)
        cv2.fillConvexPoly(mask, fixed, 1, shift=_SUBPIXEL_BITS)
        inverse_depth = _inverse_depth(camera, plane, low, high)
        nearness = (inverse_depth + lift).astype(np.float32)
        won = (mask > 0) & (nearness > self.nearness[box]) & ~self.touched[box]
        picture = self.picture[box]
        if layer is None:
            paint = np.array([*colour, 255.0])
        else:
            won &= layer[box][..., 3] > 0
            paint = layer[box][won]
        if opacity >= 1:
            picture[won] = np.round(paint)
            self.nearness[box][won] = nearness[won]
        else:
            picture[won] = np.round(picture[won] * (1 - opacity) + paint * opacity)
            self.touched[box] |= won


def _inverse_depth(
    camera: Camera, plane: Array, low: NDArray[np.int_], high: NDArray[np.int_]
) -> Array:
    """(H, W) 1 / z of the plane {p: plane·p = 1} in the pixels from `low` to `high` (x, y): the ray
    (x, y, 1) meets it at 1 / z = plane·(x, y, 1)."""
    x = (np.arange(low[0], high[0]) - camera.cx) / camera.fx
    y = (np.arange(low[1], high[1]) - camera.cy) / camera.fy
    return plane[0] * x + plane[2] + (plane[1] * y)[:, None]


def _paint_textured(canvas: _Canvas, shape: MeshShape) -> None:
    mesh = shape.mesh
    triangles = shape.pose.apply(mesh.vertices)[mesh.faces]
    picture, uv = _texture_of(mesh)
    face_uv = uv[mesh.faces]
    edges = face_uv[:, 1:] - face_uv[:, :1]
    printed = np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]) > 1e-9
    texel = np.clip(face_uv[:, 0].astype(int), 0, [picture.shape[1] - 1, picture.shape[0] - 1])
    colours = picture[texel[:, 1], texel[:, 0]].astype(np.float64)
    canvas.fill(triangles[~printed], colours[~printed], shape.opacity)
    if printed.any() and (triangles[printed][..., 2] > _NEAR).all():
        layer = _warped(canvas.camera, picture, face_uv[printed], triangles[printed])
        canvas.fill(triangles[printed], colours[printed], shape.opacity, layer)


@lru_cache(maxsize=8)
def _texture_of(mesh: trimesh.Trimesh) -> tuple[NDArray[np.uint8], Array]:
    """The texture (H, W, 3) RGB and each vertex's place in it (N, 2), texels from the upper
    left."""
    visual: Any = mesh.visual
    picture = np.asarray(visual.material.baseColorTexture.convert("RGB"))
    height, width = picture.shape[:2]
    return picture, np.asarray(visual.uv) * [width, -height] + [0, height]


def _warped(
    camera: Camera, picture: NDArray[np.uint8], face_uv: Array, triangles: Array
) -> NDArray[np.uint8]:
    """The flat, printed part of a mesh through the pinhole, RGBA (H, W, 4)."""
    texels, points = face_uv.reshape(-1, 2), triangles.reshape(-1, 3)
    pixels = points[:, :2] / points[:, 2:] * [camera.fx, camera.fy] + [camera.cx, camera.cy]
    # Shrink first, as a mipmap would: a warp that skips texels scatters the corners.
    texel_edges = np.linalg.norm(np.diff(face_uv, axis=1), axis=-1)
    pixel_edges = np.linalg.norm(np.diff(pixels.reshape(-1, 3, 2), axis=1), axis=-1)
    coarsest = float((texel_edges / np.maximum(pixel_edges, 1e-6)).max())
    halvings = int(np.clip(np.ceil(np.log2(max(coarsest, 1))), 0, 5))
    for _ in range(halvings):
        half = cv2.resize(picture, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        picture = np.asarray(half, dtype=np.uint8)
    # The texel origin is the edge, OpenCV's pixel origin the centre.
    source = texels / 2**halvings - 0.5
    H, _ = cv2.findHomography(source, pixels)
    if H is None:  # edge-on, it has no area
        return np.zeros((camera.height, camera.width, 4), np.uint8)
    rgba = cv2.cvtColor(picture, cv2.COLOR_RGB2RGBA)
    return np.asarray(
        cv2.warpPerspective(rgba, H, camera.image_size, flags=cv2.INTER_LINEAR), dtype=np.uint8
    )

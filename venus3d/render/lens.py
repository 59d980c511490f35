"""Lens distortion for renderers that only know pinholes. A picture is rendered through a slightly
larger ideal pinhole, then warped with `cv2.remap` by a map that is made once per camera.

No pinhole holds what a fisheye sees. Its ideal pinhole is aimed at what is drawn: the shapes are
turned before they are drawn. It holds what is within `_HALF_FIELD` of its axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import map_coordinates
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.shapes import LineShape, MeshShape

_LARGEST_RATIO = 2.0
"""If the ideal picture is wider than this many pictures, its resolution is reduced."""
_WIDE = np.radians(65)
"""A lens that sees farther from its axis than this has no single ideal pinhole."""
_HALF_FIELD = np.radians(66)
_AIM_STEP = np.radians(8)
"""Pinholes are aimed at multiples of this angle, so that few maps serve a moving board."""


@dataclass(frozen=True, eq=False)
class Lens:
    """The ideal pinhole to render with, and the map from its picture to the camera's."""

    camera: Camera
    ideal: Camera
    """No distortion; large enough to hold every ray of `camera`'s pixels, or if that is a wide one
    those within `_HALF_FIELD` of where it is aimed."""
    map_xy: NDArray[np.float32] | None
    """(H, W, 2) each pixel's position in the ideal picture; None if they are the same."""
    turn: Array | None = None
    """(3, 3) from the camera's frame to that of the ideal pinhole; None if they are the same."""

    def turned(self, shapes: Sequence[MeshShape | LineShape]) -> Sequence[MeshShape | LineShape]:
        """The shapes as the ideal pinhole is to draw them."""
        turn = self.turn
        if turn is None:
            return shapes
        return [replace(s, pose=Pose(turn @ s.pose.R, turn @ s.pose.t)) for s in shapes]

    def bend(self, picture: NDArray[np.uint8], border: tuple[int, ...]) -> NDArray[np.uint8]:
        """The ideal picture (H, W, C) as the camera sees it; `border` (C,) fills the rest."""
        if self.map_xy is None:
            return picture
        nothing: Any = None  # one map of both coordinates, which the annotations omit
        bent = cv2.remap(
            picture,
            self.map_xy,
            nothing,
            interpolation=cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=border,
        )
        return np.asarray(bent, dtype=np.uint8)


def lens_for(camera: Camera, shapes: Sequence[MeshShape | LineShape] = ()) -> Lens:
    """The lens of a camera; cached. A wide lens's pinhole is aimed at the middle of the shapes."""
    if not _is_wide(camera):
        return _narrow(camera)
    away, around = 0.0, 0.0
    if shapes:
        points = np.concatenate([_points_of(shape) for shape in shapes])
        points = points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-9)
        x, y, z = points.mean(axis=0)
        away, around = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)
    steps = round(float(away / _AIM_STEP))
    # On a small circle about the axis fewer directions will do.
    directions = max(1, round(2 * np.pi * np.sin(min(steps * _AIM_STEP, np.pi / 2)) / _AIM_STEP))
    return _aimed(camera, steps, round(float(around / (2 * np.pi) * directions)), directions)


@lru_cache(maxsize=16)
def _narrow(camera: Camera) -> Lens:
    if camera.is_pinhole:
        return Lens(camera, camera, None)
    rays = _perspective_rays(camera)
    # One coordinate at a time: numpy takes eight times as long over pairs.
    low = np.array([np.fmin.reduce(rays[..., i], axis=None) for i in range(2)])
    high = np.array([np.fmax.reduce(rays[..., i], axis=None) for i in range(2)])
    return _lens(camera, rays, low, high, None)


@lru_cache(maxsize=16)
def _aimed(camera: Camera, steps: int, direction: int, directions: int) -> Lens:
    around = 2 * np.pi * direction / directions
    axis = np.array([-np.sin(around), np.cos(around), 0.0])
    turn = Rotation.from_rotvec(-steps * _AIM_STEP * axis).as_matrix()
    x, y, z = (sum(turn[i, j] * _rays(camera)[..., j] for j in range(3)) for i in range(3))
    with np.errstate(divide="ignore", invalid="ignore"):
        rays = np.stack([x / z, y / z], axis=-1)
        rays[~(z > np.cos(_HALF_FIELD) * np.sqrt(x * x + y * y + z * z))] = np.nan
    edge = np.full(2, np.tan(_HALF_FIELD))
    return _lens(camera, rays, -edge, edge, turn)


def _lens(camera: Camera, rays: Array, low: Array, high: Array, turn: Array | None) -> Lens:
    span = (high - low) * [camera.fx, camera.fy] + 4
    scale = min(1.0, float((_LARGEST_RATIO * np.array(camera.image_size) / span).min()))
    f = np.array([camera.fx, camera.fy]) * scale
    centre = 2 - low * f  # two pixels to spare on the left and above
    width, height = (np.ceil((centre + high * f + 3) / 4) * 4).astype(int)
    map_xy = (rays * f + centre).astype(np.float32)
    map_xy[np.isnan(map_xy)] = -10
    ideal = Camera(int(width), int(height), *map(float, (*f, *centre)))
    return Lens(camera, ideal, map_xy, turn)


@lru_cache(maxsize=16)
def _is_wide(camera: Camera) -> bool:
    """Whether rays of the image lie farther than `_WIDE` from the axis, or are beyond what the lens
    model reaches, as in the corners of a fisheye's picture."""
    if camera.lens.is_perspective:
        return False
    return not (camera.unproject(camera.image_corners)[:, 2] > np.cos(_WIDE)).all()


def _points_of(shape: MeshShape | LineShape) -> Array:
    """(N, 3) in the camera's frame, metres."""
    own = shape.mesh.vertices if isinstance(shape, MeshShape) else shape.segments.reshape(-1, 3)
    return shape.pose.apply(own)


def _perspective_rays(camera: Camera) -> Array:
    """(H, W, 2) ideal normalised coordinates of every pixel; NaN where no ray comes from."""
    rays = _rays(camera)
    return rays[..., :2] / rays[..., 2:]


@lru_cache(maxsize=2)
def _rays(camera: Camera) -> Array:
    """(H, W, 3) ray of every pixel: of length 1 for a fisheye, to Z = 1 for a perspective lens; NaN
    where none comes from. `Camera.unproject` is exact but slow for a million pixels, so the smooth
    map is computed on a grid and interpolated (cubic: less than 1e-4 px off at 16 px)."""
    nodes, x, y = _unprojected_grid(camera, 16.0)
    u, v = np.arange(camera.width), np.arange(camera.height)
    if np.isfinite(nodes).all():
        planes = [RectBivariateSpline(y, x, nodes[..., i])(v, u) for i in range(3)]
    else:
        # Linear interpolation spreads the NaN of a node only to its neighbourhood.
        nodes, x, y = _unprojected_grid(camera, 4.0)
        at = np.meshgrid(v / (y[1] - y[0]), u / (x[1] - x[0]), indexing="ij")
        planes = [map_coordinates(nodes[..., i], at, order=1, mode="nearest") for i in range(3)]
    return np.stack(planes, axis=-1)


def _unprojected_grid(camera: Camera, step_px: float) -> tuple[Array, Array, Array]:
    columns, rows = (max(5, int(n / step_px) + 2) for n in camera.image_size)
    x = np.linspace(0, camera.width - 1, columns, dtype=np.float64)
    y = np.linspace(0, camera.height - 1, rows, dtype=np.float64)
    rays = camera.unproject(np.stack(np.meshgrid(x, y), axis=-1))
    return (rays / rays[..., 2:] if camera.lens.is_perspective else rays), x, y

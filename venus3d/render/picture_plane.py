"""The undistorted picture as a plane in the scene, seen from the real camera's place.

The browser's camera is a symmetric pinhole there. The plane's corners are on the real camera's
rays: so the picture is centred on the principal point and matches the 3D shapes before it in a
window of any shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.engine.geometry.undistortion import undistortion_maps

_SPARE = 1.2
"""A barrel lens sees more than its pinhole: show up to this factor farther from the centre."""


@dataclass(frozen=True)
class Plane:
    """A picture's edges at one metre from the lens, metres; +y is down."""

    left: float
    top: float
    right: float
    bottom: float

    def fov_rad(self, aspect: float) -> float:
        """The vertical field of view that shows all of it in a window of this aspect."""
        half = max(-self.top, self.bottom, max(-self.left, self.right) / max(aspect, 0.05))
        return 2 * float(np.arctan(half))


def plain_plane(image_size: tuple[int, int]) -> Plane:
    """The plane of an unmodified picture, in the middle of the window."""
    wide = image_size[0] / image_size[1]
    return Plane(-wide / 2, -0.5, wide / 2, 0.5)


@dataclass(frozen=True, eq=False)
class Undistortion:
    """Maps a camera's picture of one size to what a pinhole in its place would see."""

    plane: Plane
    maps: tuple[NDArray[Any], NDArray[Any]]
    """Maps for `cv2.remap`."""

    def straightened(self, rgb: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The picture (H, W, 3) without lens distortion."""
        return np.asarray(cv2.remap(rgb, *self.maps, cv2.INTER_LINEAR), np.uint8)


@lru_cache(maxsize=4)
def undistortion(camera: Camera) -> Undistortion:
    """For pictures of the camera's own image size; cached per camera."""
    low, high = _reach(camera)
    size = camera.image_size
    pinhole = camera.without_distortion()
    f = np.array([camera.fx, camera.fy])
    # As many pixels as the picture has, over the part shown.
    scale = np.array(size) / ((high - low) * f)
    K = np.array(pinhole.K)
    K[0, 0], K[1, 1] = f * scale
    K[:2, 2] = -low * f * scale - 0.5
    maps = undistortion_maps(camera, K, size)
    plane = Plane(float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return Undistortion(plane, maps)


def _reach(camera: Camera) -> tuple[Array, Array]:
    """Lowest and highest x, y of the picture's rays at z = 1, (2,) each."""
    w, h = camera.image_size
    centre, f = np.array([camera.cx, camera.cy]), np.array([camera.fx, camera.fy])
    corners = np.array([[-0.5, -0.5], [w - 0.5, h - 0.5]])
    ideal = (corners - centre) / f
    x, y = np.linspace(-0.5, w - 0.5, 33), np.linspace(-0.5, h - 0.5, 33)
    sides = [
        np.stack([np.full(33, -0.5), y], 1),
        np.stack([np.full(33, w - 0.5), y], 1),
        np.stack([x, np.full(33, -0.5)], 1),
        np.stack([x, np.full(33, h - 0.5)], 1),
    ]
    rays = camera.unproject(np.concatenate(sides))
    if not np.isfinite(rays).all():
        return ideal[0], ideal[1]
    # What is seen beside the lens or behind it lies beyond every plane.
    ahead = rays[:, 2:] > 1e-6
    beyond = np.copysign(np.inf, rays[:, :2])
    xy = np.where(ahead, rays[:, :2] / np.where(ahead, rays[:, 2:], 1.0), beyond)
    return (
        np.maximum(xy.min(axis=0), _SPARE * ideal[0]),
        np.minimum(xy.max(axis=0), _SPARE * ideal[1]),
    )

"""Lens distortion for renderers that only know pinholes. A picture is rendered through a slightly
larger ideal pinhole, then warped with `cv2.remap` by a map that is made once per camera."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import map_coordinates

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

_LARGEST_RATIO = 2.0
"""If the ideal picture is wider than this many pictures, its resolution is reduced."""


@dataclass(frozen=True, eq=False)
class Lens:
    """The ideal pinhole to render with, and the map from its picture to the camera's."""

    camera: Camera
    ideal: Camera
    """No distortion; large enough to hold every ray of `camera`'s pixels."""
    map_xy: NDArray[np.float32] | None
    """(H, W, 2) each pixel's position in the ideal picture; None if they are the same."""

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


@lru_cache(maxsize=16)
def lens_for(camera: Camera) -> Lens:
    """The lens of a camera; cached."""
    if not camera.distortion.any():
        return Lens(camera, camera, None)
    rays = _rays(camera)
    # One coordinate at a time: numpy takes eight times as long over pairs.
    low = np.array([np.fmin.reduce(rays[..., i], axis=None) for i in range(2)])
    high = np.array([np.fmax.reduce(rays[..., i], axis=None) for i in range(2)])
    span = (high - low) * [camera.fx, camera.fy] + 4
    scale = min(1.0, float((_LARGEST_RATIO * np.array(camera.image_size) / span).min()))
    f = np.array([camera.fx, camera.fy]) * scale
    centre = 2 - low * f  # two pixels to spare on the left and above
    width, height = (np.ceil((centre + high * f + 3) / 4) * 4).astype(int)
    map_xy = (rays * f + centre).astype(np.float32)
    map_xy[np.isnan(map_xy)] = -10
    ideal = Camera(int(width), int(height), *map(float, (*f, *centre)))
    return Lens(camera, ideal, map_xy)


def _rays(camera: Camera) -> Array:
    """(H, W, 2) ideal normalised coordinates of every pixel; NaN where no ray comes from.
    `Camera.unproject` is exact but slow for a million pixels, so the smooth map is computed on a
    grid and interpolated (cubic: less than 1e-4 px off at 16 px)."""
    nodes, x, y = _unprojected_grid(camera, 16.0)
    u, v = np.arange(camera.width), np.arange(camera.height)
    if np.isfinite(nodes).all():
        planes = [RectBivariateSpline(y, x, nodes[..., i])(v, u) for i in range(2)]
    else:
        # Linear interpolation spreads the NaN of a node only to its neighbourhood.
        nodes, x, y = _unprojected_grid(camera, 4.0)
        at = np.meshgrid(v / (y[1] - y[0]), u / (x[1] - x[0]), indexing="ij")
        planes = [map_coordinates(nodes[..., i], at, order=1, mode="nearest") for i in range(2)]
    return np.stack(planes, axis=-1)


def _unprojected_grid(camera: Camera, step_px: float) -> tuple[Array, Array, Array]:
    columns, rows = (max(5, int(n / step_px) + 2) for n in camera.image_size)
    x = np.linspace(0, camera.width - 1, columns, dtype=np.float64)
    y = np.linspace(0, camera.height - 1, rows, dtype=np.float64)
    rays = camera.unproject(np.stack(np.meshgrid(x, y), axis=-1))
    return rays[..., :2] / rays[..., 2:], x, y

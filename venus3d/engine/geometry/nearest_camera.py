"""The nearest camera without k3, for programs whose model has four coefficients."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

GRID = 30
"""Points along each side of the picture."""
_SCALE = np.array([1.0, 1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3, 1e-3])
"""Changes of the eight parameters that move pixels about as much."""


def nearest_without_k3(camera: Camera) -> tuple[Camera, float]:
    """The camera with k3 = 0 that projects most like `camera` over its picture, and the largest
    distance between the two in pixels. Raises `CalibrationError` where there is none."""
    corner = camera.image_corners[-1]
    u, v = np.meshgrid(np.linspace(0, corner[0], GRID), np.linspace(0, corner[1], GRID))
    pixels = np.stack([u.ravel(), v.ravel()], axis=-1)
    rays = camera.unproject(pixels)
    reached = np.isfinite(rays).all(axis=1)
    seen = np.ascontiguousarray(rays[reached].T)

    def errors(scaled: Array) -> Array:
        fitted = Camera.from_parameters([*scaled * _SCALE, 0.0], camera.image_size)
        return (fitted.pixels_of(seen).T - pixels[reached]).ravel()

    try:
        found = least_squares(errors, camera.parameters[:8] / _SCALE)
    except (CalibrationError, ValueError) as error:
        raise CalibrationError(
            "No camera with k1, k2, p1 and p2 alone is near this one; calibrate anew."
        ) from error
    largest = float(np.linalg.norm(errors(found.x).reshape(-1, 2), axis=1).max())
    return Camera.from_parameters([*found.x * _SCALE, 0.0], camera.image_size), largest

"""What a lens model is.

A lens maps a point (X, Y, Z) in the camera's frame to normalised image coordinates (x', y'); the
pixel is (fx x' + cx, fy y' + cy). The length of the point does not matter, only its direction. A
model has no state: its coefficients are the camera's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from venus3d.engine.geometry.pose import Array

Coefficients = Sequence[float]


class LensModel(Protocol):
    """One lens model."""

    @property
    def name(self) -> str:
        """As given to `--lens`."""
        ...

    @property
    def coefficient_names(self) -> tuple[str, ...]:
        """(p,) in the order used everywhere, OpenCV's."""
        ...

    @property
    def usual(self) -> tuple[float, ...]:
        """(p,) standard deviation of each coefficient over the lenses that there are, roughly."""
        ...

    @property
    def is_perspective(self) -> bool:
        """Whether the model is one of x = X / Z and y = Y / Z, so that Z must be positive.
        Coefficients of zero are a pinhole then."""
        ...

    @property
    def wide(self) -> tuple[float, ...] | None:
        """(p,) coefficients with which the image radius is nearly the angle; None if there are none
        for a wide field."""
        ...

    def image(self, coefficients: Coefficients, points: Array) -> Array:
        """Normalised image coordinates (2, ...) of points (3, ...), also beyond `angle_limit`."""
        ...

    def differentiate(
        self,
        coefficients: Coefficients,
        focal: tuple[float, float],
        points: Array,
        by_point: Array,
        by_focal: Array,
        by_coefficient: Array,
    ) -> None:
        """Write the derivatives of the pixels of points (N, 3, M) into arrays to be filled.

        Args:
            focal: fx and fy.
            by_point: (N, 3, 2, M) of u and v by X, Y, Z.
            by_focal: (N, 2, 2, M) by fx and fy, which is x' for u by fx and y' for v by fy. The two
                others are zero, and left alone.
            by_coefficient: (N, p, 2, M) by the lens's coefficients.
        """
        ...

    def rays(self, coefficients: Coefficients, image: Array) -> Array:
        """Unit vectors (..., 3) that have these normalised image coordinates (..., 2); NaN where
        there is none within `angle_limit`."""
        ...

    def opencv(self, coefficients: Coefficients) -> tuple[float, ...]:
        """OpenCV's `distCoeffs`, or `D` of `cv2.fisheye` for a lens that is not perspective."""
        ...

    def angle_limit(self, coefficients: Coefficients) -> float:
        """Largest angle from the optical axis, rad, up to which the image radius grows. Beyond it
        the model folds back, and points outside the view have an image inside it."""
        ...


def least_positive_root(polynomial: Sequence[float]) -> float:
    """The least positive w at which a polynomial 1 + a1 w + a2 w^2 + ... is zero; inf if there is
    none. `polynomial`: 1, a1, a2, ..."""
    # In 1/w the leading coefficient is 1 whatever the others are.
    roots = np.roots(polynomial)
    real = roots[np.abs(roots.imag) <= 1e-9 * np.abs(roots)].real
    largest = max(real, default=0.0)
    return float(1 / largest) if largest > 1e-12 else float("inf")


def inverted(lens: LensModel, coefficients: Coefficients, image: Array) -> Array:
    """(..., 2) x and y of a perspective lens whose image these coordinates (..., 2) are, by
    Newton's method; NaN where there is none within the lens's limit."""
    xy = np.array(image, dtype=np.float64)
    shape = xy.shape
    xy, wanted = xy.reshape(-1, 2), np.asarray(image, dtype=np.float64).reshape(-1, 2)
    count = len(xy)
    by_point = np.empty((1, 3, 2, count))
    at, unused = np.empty((1, 2, 2, count)), np.empty((1, len(coefficients), 2, count))
    points = np.ones((1, 3, count))
    with np.errstate(all="ignore"):
        for _ in range(30):
            points[0, :2] = xy.T
            lens.differentiate(coefficients, (1.0, 1.0), points, by_point, at, unused)
            error = np.stack([at[0, 0, 0], at[0, 1, 1]], axis=-1) - wanted
            slope = np.moveaxis(by_point[0, :2], -1, 0).swapaxes(1, 2)
            step = np.linalg.solve(slope, error[..., None])[..., 0]
            xy = xy - step
            if not np.nanmax(np.abs(step), initial=0.0) > 1e-15:
                break
        points[0, :2] = xy.T
        left = np.abs(lens.image(coefficients, points[0]) - wanted.T).max(axis=0)
        radius = np.hypot(xy[:, 0], xy[:, 1])
        good = (left < 1e-9) & (np.arctan(radius) < lens.angle_limit(coefficients))
    return np.where(good[:, None], xy, np.nan).reshape(shape)


def unit(x: Array, y: Array, z: Array) -> Array:
    """(..., 3) vectors of length 1."""
    length = np.sqrt(x * x + y * y + z * z)
    return np.stack([x / length, y / length, z / length], axis=-1)

"""OpenCV's fisheye model (Kannala and Brandt 2006): the image radius is a polynomial of the angle.

With r^2 = X^2 + Y^2 and the angle t = atan2(r, Z) from the optical axis,

    (x', y') = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) (X, Y) / r

Directions beside and behind the lens have an image as well: Z may be zero or negative.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.lenses.lens_model import Coefficients, least_positive_root
from venus3d.engine.geometry.pose import Array

_NEWTON = 20
_SETTLED = 1e-15
"""Largest last step, rad. Most settle after four or five; beyond the field none is taken."""


@dataclass(frozen=True)
class Fisheye:
    """The fisheye model with its first coefficients."""

    name: str
    coefficient_names: tuple[str, ...]
    usual: tuple[float, ...]
    is_perspective = False

    @property
    def wide(self) -> tuple[float, ...]:
        """None of the coefficients is needed for it."""
        return (0.0,) * len(self.coefficient_names)

    def image(self, coefficients: Coefficients, points: Array) -> Array:
        """See `LensModel`."""
        angle, per_radius = _angle(points[0], points[1], points[2])
        return points[:2] * (per_radius * _series(coefficients, angle * angle))

    def differentiate(
        self,
        coefficients: Coefficients,
        focal: tuple[float, float],
        points: Array,
        by_point: Array,
        by_focal: Array,
        by_coefficient: Array,
    ) -> None:
        """See `LensModel`."""
        X, Y, Z = points[:, 0], points[:, 1], points[:, 2]
        angle, per_radius = _angle(X, Y, Z)
        a2, r2 = angle * angle, X * X + Y * Y
        length2 = r2 + Z * Z
        scale = per_radius * _series(coefficients, a2)
        # d(image radius) / d(angle) over the squared length.
        slope = _series([k * (2 * i + 3) for i, k in enumerate(coefficients)], a2) / length2
        # On the axis both are 1 / Z, and X Y / r^2 does not matter.
        across = (slope * Z - scale) / np.maximum(r2, 1e-300)
        for row, (f, one) in enumerate(((focal[0], X), (focal[1], Y))):
            np.multiply(scale, one, out=by_focal[:, row, row])
            np.multiply(f * one * across, X, out=by_point[:, 0, row])
            np.multiply(f * one * across, Y, out=by_point[:, 1, row])
            by_point[:, row, row] += f * scale
            np.multiply(-f * slope, one, out=by_point[:, 2, row])
            term = f * per_radius * one
            for column in range(len(coefficients)):
                term = term * a2
                by_coefficient[:, column, row] = term

    def rays(self, coefficients: Coefficients, image: Array) -> Array:
        """See `LensModel`: Newton's method on the polynomial, within its limit."""
        x, y = image[..., 0], image[..., 1]
        radius, limit = np.hypot(x, y), self.angle_limit(coefficients)
        slopes = [k * (2 * i + 3) for i, k in enumerate(coefficients)]
        with np.errstate(all="ignore"):
            angle = np.minimum(radius, 0.99 * limit)
            for _ in range(_NEWTON):
                error = angle * _series(coefficients, angle * angle) - radius
                step = error / _series(slopes, angle * angle)
                # Near its limit the polynomial is flat, and a step would leave the field.
                before, angle = angle, np.clip(angle - step, 0.0, limit)
                if not (np.abs(angle - before) > _SETTLED).any():
                    break
            left = np.abs(angle * _series(coefficients, angle * angle) - radius)
            angle = np.where((left < 1e-9) & (angle < limit), angle, np.nan)
            over = np.where(radius > 0, np.sin(angle) / radius, 1.0)
        return np.stack([x * over, y * over, np.cos(angle)], axis=-1)

    def opencv(self, coefficients: Coefficients) -> tuple[float, ...]:
        """All four."""
        return (*coefficients, *[0.0] * (4 - len(coefficients)))

    def angle_limit(self, coefficients: Coefficients) -> float:
        """See `LensModel`; at most half a turn."""
        slopes = [1.0, *(k * (2 * i + 3) for i, k in enumerate(coefficients))]
        return float(min(np.sqrt(least_positive_root(slopes)), np.pi))


def _series(coefficients: Coefficients, a2: Array) -> Array:
    """1 + k1 a2 + k2 a2^2 + ..."""
    total = np.zeros_like(a2)
    for k in reversed(coefficients):
        total = (total + k) * a2
    return 1 + total


def _angle(X: Array, Y: Array, Z: Array) -> tuple[Array, Array]:
    """The angle from the axis, rad, and that over sqrt(X^2 + Y^2); 1 / Z on the axis."""
    radius = np.sqrt(X * X + Y * Y)
    angle = np.arctan2(radius, Z)
    with np.errstate(divide="ignore", invalid="ignore"):
        return angle, np.where(radius > 1e-9 * np.abs(Z), angle / radius, 1.0 / Z)


EQUIDISTANT = Fisheye("equidistant", (), ())
"""The image radius is the angle."""
FISHEYE = Fisheye("fisheye", ("k1", "k2", "k3", "k4"), (0.1, 0.1, 0.1, 0.1))

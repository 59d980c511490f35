"""OpenCV's rational model: a quotient of two polynomials for wide lenses, and a thin prism.

With x = X / Z, y = Y / Z, r^2 = x^2 + y^2 and
q = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6),

    x' = x q + 2 p1 x y + p2 (r^2 + 2 x^2) + s1 r^2 + s2 r^4
    y' = y q + p1 (r^2 + 2 y^2) + 2 p2 x y + s3 r^2 + s4 r^4

(`CALIB_RATIONAL_MODEL` and `CALIB_THIN_PRISM_MODEL`; Claus and Fitzgibbon 2005, Weng et al. 1992.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.lenses.lens_model import (
    Coefficients,
    inverted,
    least_positive_root,
    unit,
)
from venus3d.engine.geometry.pose import Array

_RATIONAL = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
_USUAL = (0.5, 1.0, 0.02, 0.02, 2.0, 0.5, 1.0, 2.0)
_PRISM = ("s1", "s2", "s3", "s4")


@dataclass(frozen=True)
class Rational:
    """The rational model, with a thin prism or without."""

    name: str
    coefficient_names: tuple[str, ...]
    usual: tuple[float, ...]
    is_perspective = True

    @property
    def wide(self) -> tuple[float, ...]:
        """Padé's quotient of atan(r) / r, good to 1 % up to 63° and 7 % up to 72°."""
        above, below = (7 / 9, 64 / 945), (10 / 9, 5 / 21)
        found = (*above, 0.0, 0.0, 0.0, *below, 0.0)
        return (*found, *[0.0] * (len(self.coefficient_names) - len(found)))

    def image(self, coefficients: Coefficients, points: Array) -> Array:
        """See `LensModel`."""
        k1, k2, p1, p2, k3, k4, k5, k6, *prism = coefficients
        x, y = points[:2] / points[2]
        x2, y2, xy2 = x * x, y * y, 2 * x * y
        r2 = x2 + y2
        above = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6))
        radial = above / below
        found = np.empty((2, *x.shape))
        found[0] = x * radial + p1 * xy2 + p2 * (r2 + 2 * x2)
        found[1] = y * radial + p1 * (r2 + 2 * y2) + p2 * xy2
        if prism:
            s1, s2, s3, s4 = prism
            found[0] += r2 * (s1 + r2 * s2)
            found[1] += r2 * (s3 + r2 * s4)
        return found

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
        k1, k2, p1, p2, k3, k4, k5, k6, *prism = coefficients
        s1, s2, s3, s4 = prism or (0.0, 0.0, 0.0, 0.0)
        iz = 1.0 / points[:, 2]
        x, y = points[:, 0] * iz, points[:, 1] * iz
        x2, y2, xy = x * x, y * y, x * y
        r2 = x2 + y2
        r4 = r2 * r2
        powers = (r2, r4, r2 * r4)
        below = 1.0 / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)))
        radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) * below
        ax, ay, xy2 = r2 + 2 * x2, r2 + 2 * y2, 2 * xy
        # Twice the derivative of the quotient by r^2.
        slope = k1 + r2 * (2 * k2 + 3 * k3 * r2) - radial * (k4 + r2 * (2 * k5 + 3 * k6 * r2))
        slope *= 2 * below
        by_focal[:, 0, 0] = x * radial + p1 * xy2 + p2 * ax + r2 * (s1 + r2 * s2)
        by_focal[:, 1, 1] = y * radial + p1 * ay + p2 * xy2 + r2 * (s3 + r2 * s4)
        bend_x, bend_y = 2 * (s1 + 2 * s2 * r2), 2 * (s3 + 2 * s4 * r2)
        cross = slope * xy + 2 * (p1 * x + p2 * y)
        xx = radial + slope * x2 + 2 * p1 * y + 6 * p2 * x + bend_x * x
        yy = radial + slope * y2 + 6 * p1 * y + 2 * p2 * x + bend_y * y
        for row, (f, c, a, b, one, two) in enumerate(
            (
                (focal[0], x, xx, cross + bend_x * y, xy2, ax),
                (focal[1], y, cross + bend_y * x, yy, ay, xy2),
            )
        ):
            up, fz = f * c * below, f * iz
            down = -up * radial
            for power, above_at, below_at in zip(powers, (0, 1, 4), (5, 6, 7), strict=True):
                np.multiply(up, power, out=by_coefficient[:, above_at, row])
                np.multiply(down, power, out=by_coefficient[:, below_at, row])
            np.multiply(f, one, out=by_coefficient[:, 2, row])
            np.multiply(f, two, out=by_coefficient[:, 3, row])
            if prism:
                by_coefficient[:, 8:, row] = 0.0
                np.multiply(f, r2, out=by_coefficient[:, 8 + 2 * row, row])
                np.multiply(f, r4, out=by_coefficient[:, 9 + 2 * row, row])
            gx, gy = fz * a, fz * b
            by_point[:, 0, row], by_point[:, 1, row] = gx, gy
            by_point[:, 2, row] = -(gx * x + gy * y)

    def rays(self, coefficients: Coefficients, image: Array) -> Array:
        """See `LensModel`."""
        xy = inverted(self, coefficients, image)
        return unit(xy[..., 0], xy[..., 1], np.ones(xy.shape[:-1]))

    def opencv(self, coefficients: Coefficients) -> tuple[float, ...]:
        """As they are."""
        return tuple(coefficients)

    def angle_limit(self, coefficients: Coefficients) -> float:
        """See `LensModel`; of the radial part."""
        k1, k2, _, _, k3, k4, k5, k6 = coefficients[:8]
        # Highest power first, as numpy's polynomials are; in w = r^2.
        above, below = [k3, k2, k1, 1.0], [k6, k5, k4, 1.0]
        # d/dr of r A(w) / B(w) = 0: A B + 2 w (A' B - A B') = 0. A pole ends the field as well.
        product = np.polymul(above, below)
        change = np.polysub(
            np.polymul(np.polyder(above), below), np.polymul(above, np.polyder(below))
        )
        fold = np.polyadd(product, np.polymul([2.0, 0.0], change))
        limit = min(least_positive_root(fold[::-1].tolist()), least_positive_root(below[::-1]))
        return float(np.arctan(np.sqrt(limit)))


RATIONAL = Rational("rational", _RATIONAL, _USUAL)
RATIONAL_THIN_PRISM = Rational(
    "rational-thin-prism", (*_RATIONAL, *_PRISM), (*_USUAL, *(0.02,) * len(_PRISM))
)

"""Brown's distortion of a pinhole (eqs (1) to (4); Brown 1966), with up to five coefficients.

With x = X / Z, y = Y / Z and r^2 = x^2 + y^2,

    x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
    y' = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from venus3d.engine.geometry.lenses.lens_model import (
    Coefficients,
    inverted,
    least_positive_root,
    unit,
)
from venus3d.engine.geometry.pose import Array

_NAMES = ("k1", "k2", "p1", "p2", "k3")
_USUAL = {"k1": 0.5, "k2": 1.0, "p1": 0.02, "p2": 0.02, "k3": 2.0}


@dataclass(frozen=True)
class Brown:
    """Brown's model with some of its five coefficients; the others are zero."""

    name: str
    coefficient_names: tuple[str, ...]
    is_perspective = True
    wide = None

    @property
    def usual(self) -> tuple[float, ...]:
        """(p,) standard deviation of each coefficient over the lenses that there are, roughly."""
        return tuple(_USUAL[name] for name in self.coefficient_names)

    @cached_property
    def _place(self) -> dict[str, int]:
        return {name: index for index, name in enumerate(self.coefficient_names)}

    def _five(self, coefficients: Coefficients) -> Coefficients:
        if len(coefficients) == len(_NAMES):
            return coefficients
        given = dict(zip(self.coefficient_names, coefficients, strict=True))
        return [given.get(name, 0.0) for name in _NAMES]

    def image(self, coefficients: Coefficients, points: Array) -> Array:
        """See `LensModel`."""
        k1, k2, p1, p2, k3 = self._five(coefficients)
        x, y = points[:2] / points[2]
        x2, y2, xy2 = x * x, y * y, 2 * x * y
        r2 = x2 + y2
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        found = np.empty((2, *x.shape))
        found[0] = x * radial + p1 * xy2 + p2 * (r2 + 2 * x2)
        found[1] = y * radial + p1 * (r2 + 2 * y2) + p2 * xy2
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
        k1, k2, p1, p2, k3 = self._five(coefficients)
        iz = 1.0 / points[:, 2]
        x, y = points[:, 0] * iz, points[:, 1] * iz
        x2, y2, xy = x * x, y * y, x * y
        r2 = x2 + y2
        r4 = r2 * r2
        r6 = r2 * r4
        radial = 1 + k1 * r2 + k2 * r4 + k3 * r6
        ax, ay, xy2 = r2 + 2 * x2, r2 + 2 * y2, 2 * xy
        by_focal[:, 0, 0] = x * radial + p1 * xy2 + p2 * ax
        by_focal[:, 1, 1] = y * radial + p1 * ay + p2 * xy2
        # d(x', y') / d(x, y), then the chain over x = X/Z, y = Y/Z.
        slope = 2 * (k1 + r2 * (2 * k2 + 3 * k3 * r2))
        cross = slope * xy + 2 * (p1 * x + p2 * y)
        xx = radial + slope * x2 + 2 * p1 * y + 6 * p2 * x
        yy = radial + slope * y2 + 6 * p1 * y + 2 * p2 * x
        # Memory that is given back and taken again is dearer than all of this.
        del x2, y2, xy, radial, slope
        for row, (f, c, a, b, one, two) in enumerate(
            ((focal[0], x, xx, cross, xy2, ax), (focal[1], y, cross, yy, ay, xy2))
        ):
            fc, fz = f * c, f * iz
            for name, first, second in (
                ("k1", fc, r2),
                ("k2", fc, r4),
                ("k3", fc, r6),
                ("p1", f, one),
                ("p2", f, two),
            ):
                if name in self._place:
                    np.multiply(first, second, out=by_coefficient[:, self._place[name], row])
            gx, gy = fz * a, fz * b
            by_point[:, 0, row], by_point[:, 1, row] = gx, gy
            by_point[:, 2, row] = -(gx * x + gy * y)

    def rays(self, coefficients: Coefficients, image: Array) -> Array:
        """See `LensModel`."""
        xy = inverted(self, coefficients, image)
        return unit(xy[..., 0], xy[..., 1], np.ones(xy.shape[:-1]))

    def opencv(self, coefficients: Coefficients) -> tuple[float, ...]:
        """All five."""
        return tuple(self._five(coefficients))

    def angle_limit(self, coefficients: Coefficients) -> float:
        """See `LensModel`; of the radial part."""
        k1, k2, _, _, k3 = self._five(coefficients)
        # d/dr of r(1 + k1 r^2 + k2 r^4 + k3 r^6) = 0, in r^2.
        return float(np.arctan(np.sqrt(least_positive_root([1.0, 3 * k1, 5 * k2, 7 * k3]))))


PINHOLE = Brown("pinhole", ())
BROWN3 = Brown("brown3", ("k1", "k2", "k3"))
"""Radial only: OpenCV's `CALIB_ZERO_TANGENT_DIST`."""
BROWN4 = Brown("brown4", ("k1", "k2", "p1", "p2"))
"""Kalibr's `radtan`, COLMAP's `OPENCV`."""
BROWN5 = Brown("brown5", _NAMES)
"""OpenCV's default."""

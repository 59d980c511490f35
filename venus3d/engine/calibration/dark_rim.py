"""Finds a lens's image circle in one picture, by the dark rim around it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.image_circle import ImageCircle
from venus3d.engine.geometry.pose import Array

_WIDTH = 320
"""The picture is looked at in this width, pixels."""
_DARKEST = 40
"""Grey value above which a corner of the picture is not dark: a sensor's black with its noise."""
_CONTRAST = 0.12
"""Share of the way from the dark corners to the picture's bright parts at which the rim is."""
_LEAST_RANGE = 50
"""Grey values between dark and bright: a dark room shows no rim."""
_FITS_PX, _FITTING = 1.5, 0.8
"""Least share of the rim's points that are this near to the circle, in the small picture."""
_LEAST_ARC_DEG = 90.0
"""Of the rim that must be seen, in all."""
_RADII = (0.3, 0.65)
"""Least and largest radius, as a share of the picture's diagonal."""
_TRIES = 200


def image_circle(image: NDArray[np.uint8]) -> ImageCircle | None:
    """The image circle in a picture (H, W[, 3]); None if its corners are not dark, or the border of
    the dark is no circle about the picture's middle."""
    grey = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) if image.ndim == 3 else image)
    scale = min(1.0, _WIDTH / grey.shape[1])
    size = (round(scale * grey.shape[1]), round(scale * grey.shape[0]))
    small = np.asarray(cv2.resize(grey, size, interpolation=cv2.INTER_AREA), np.uint8)
    lit = _lit(small)
    if lit is None:
        return None
    circle = _circle_through(_rim(lit))
    if circle is None or not _is_plausible(circle, lit):
        return None
    return circle.scaled(grey.shape[1] / size[0], grey.shape[0] / size[1])


def _lit(grey: NDArray[np.uint8]) -> NDArray[np.bool_] | None:
    """(h, w) what is not part of the dark in the picture's corners; None if fewer than three of
    them are dark."""
    h, w = grey.shape
    corners = [(0, 0), (w - 1, 0), (0, h - 1), (w - 1, h - 1)]
    levels = sorted(int(grey[y, x]) for x, y in corners)
    dark, bright = levels[2], float(np.percentile(grey, 90))
    if dark > _DARKEST or bright - dark < _LEAST_RANGE:
        return None
    mask = np.asarray(grey < dark + _CONTRAST * (bright - dark), np.uint8)
    _, labels = cv2.connectedComponents(mask)
    in_corners = {int(labels[y, x]) for x, y in corners} - {0}
    return ~np.isin(labels, list(in_corners))


def _rim(lit: NDArray[np.bool_]) -> Array:
    """(N, 2) where the lit part ends, seen from its middle, but for the picture's own border."""
    h, w = lit.shape
    padded = np.pad(lit, 1, mode="edge")
    beside_dark = ~(padded[:-2, 1:-1] & padded[2:, 1:-1] & padded[1:-1, :-2] & padded[1:-1, 2:])
    v, u = np.nonzero(lit & beside_dark)
    points = np.stack([u, v], axis=1).astype(np.float64)
    # The outermost in each direction: shadows within the circle are no rim.
    away = points - [(w - 1) / 2, (h - 1) / 2]
    sector = np.floor(np.degrees(np.arctan2(away[:, 1], away[:, 0]))).astype(int)
    order = np.lexsort((-np.hypot(*away.T), sector))
    _, first = np.unique(sector[order], return_index=True)
    return points[order[first]]


def _circle_through(points: Array) -> ImageCircle | None:
    """The circle that most of the points (N, 2) are on."""
    if len(points) < _LEAST_ARC_DEG:
        return None
    rng, best = np.random.default_rng(0), np.zeros(len(points), bool)
    for _ in range(_TRIES):
        x, y, radius = _least_squares(points[rng.choice(len(points), 3, replace=False)])
        near = np.abs(np.hypot(*(points - [x, y]).T) - radius) < _FITS_PX
        best = near if near.sum() > best.sum() else best
    if best.sum() < max(_FITTING * len(points), _LEAST_ARC_DEG):
        return None
    return ImageCircle(*_least_squares(points[best]).tolist())


def _least_squares(points: Array) -> Array:
    """(3,) x, y and radius by the algebraic fit (Kasa 1976): x^2 + y^2 = 2 a x + 2 b y + c is
    linear."""
    A = np.column_stack([2 * points, np.ones(len(points))])
    a, b, c = np.linalg.lstsq(A, (points**2).sum(axis=1), rcond=None)[0]
    return np.array([a, b, np.sqrt(max(c + a * a + b * b, 0.0))])


def _is_plausible(circle: ImageCircle, lit: NDArray[np.bool_]) -> bool:
    h, w = lit.shape
    diagonal = np.hypot(w, h)
    if not _RADII[0] * diagonal < circle.radius < _RADII[1] * diagonal:
        return False
    return bool(np.hypot(circle.x - w / 2, circle.y - h / 2) < 0.1 * diagonal)

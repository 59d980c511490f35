"""The image circle: what a lens lights of the sensor, where it does not light all of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.pose import Array


@dataclass(frozen=True)
class ImageCircle:
    """A circle in the image, pixels. Outside it the picture is dark. Raises `CalibrationError` for
    what is no circle."""

    x: float
    y: float
    radius: float

    def __post_init__(self) -> None:
        if not (np.isfinite([self.x, self.y, self.radius]).all() and self.radius > 0):
            raise CalibrationError("An image circle needs a finite centre and a positive radius.")

    def room(self, pixels: Array) -> Array:
        """(...) how far pixels (2, ...) are within the circle; negative outside."""
        return self.radius - np.hypot(pixels[0] - self.x, pixels[1] - self.y)

    def contains(self, pixels: Array) -> NDArray[np.bool_]:
        """Which of the pixels (..., 2) are within the circle: (...)."""
        return self.room(np.moveaxis(pixels, -1, 0)) >= 0

    def scaled(self, sx: float, sy: float) -> ImageCircle:
        """The circle in a picture that is sx times as wide and sy times as high. A pixel keeps its
        centre (`Camera.scaled`); for sx other than sy it is the smaller of both."""
        return ImageCircle(
            (self.x + 0.5) * sx - 0.5, (self.y + 0.5) * sy - 0.5, self.radius * min(sx, sy)
        )

    def border(self, image_size: tuple[int, int]) -> Array:
        """(181, 2) points of the circle, closed; NaN outside the image (width, height)."""
        turn = np.linspace(0, 2 * np.pi, 181)
        # A hair inside, where there are rays.
        radius = 0.999 * self.radius
        points = np.stack([self.x + radius * np.cos(turn), self.y + radius * np.sin(turn)], axis=-1)
        inside = np.all((points > -0.5) & (points < np.array(image_size) - 0.5), axis=1)
        return np.where(np.expand_dims(inside, 1), points, np.nan)


def common_circle(found: Iterable[ImageCircle | None]) -> ImageCircle | None:
    """The image circle of several pictures: the median of those found, if most pictures show one.
    A dark wall at one side of a picture looks like a smaller circle, and only there."""
    every = list(found)
    circles = [one for one in every if one is not None]
    if 2 * len(circles) <= len(every):
        return None
    x, y, radius = np.median([[one.x, one.y, one.radius] for one in circles], axis=0)
    return ImageCircle(float(x), float(y), float(radius))

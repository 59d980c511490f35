"""The colour scale of all maps (cividis), and the ticks of its legend. Cividis (Nuñez, Anderton and
Renslow 2018) is perceptually even and looks nearly the same with and without red-green
blindness."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.geometry.pose import Array
from venus3d.render.palette import hex_of
from venus3d.render.shapes import Colour

STOPS = 9
"""Colours named in a legend's gradient."""


@lru_cache(maxsize=1)
def colour_table() -> NDArray[np.uint8]:
    """(256, 3) RGB, from the smallest number (dark blue) to the largest (yellow)."""
    ramp = np.arange(256, dtype=np.uint8)[:, None]
    bgr = np.asarray(cv2.applyColorMap(ramp, cv2.COLORMAP_CIVIDIS), dtype=np.uint8)
    return bgr[:, 0, ::-1].copy()


def colours_of(values: ArrayLike, low: float, high: float) -> NDArray[np.uint8]:
    """RGB (..., 3) of values (...), clipped to `low` ... `high`; NaN gets the colour of `low`."""
    share = (np.asarray(values, dtype=np.float64) - low) / max(high - low, 1e-12)
    steps = np.clip(np.nan_to_num(share, nan=0.0), 0.0, 1.0) * 255
    return colour_table()[np.rint(steps).astype(np.intp)]


def colour_of(value: float, low: float, high: float) -> Colour:
    """RGB of one value."""
    r, g, b = (int(c) for c in colours_of(value, low, high))
    return (r, g, b)


def gradient_css() -> str:
    """The scale from left to right, as a CSS background."""
    ends = np.linspace(0, 255, STOPS)
    stops = ", ".join(hex_of(colour_of(float(end), 0, 255)) for end in ends)
    return f"linear-gradient(to right, {stops})"


def round_up(value: float) -> float:
    """The next higher of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten: the scale's upper end."""
    if not (np.isfinite(value) and value > 0):
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps: Array = np.array([1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0])
    return float(steps[np.searchsorted(steps, value / power * (1 - 1e-9))] * power)


def round_down(value: float) -> float:
    """The next lower of 1, 2, 5 times a power of ten: the scale's lower end."""
    if not (np.isfinite(value) and value > 0):
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(s for s in (1.0, 2.0, 5.0) if s * power <= value * (1 + 1e-9)))


def magnification(largest_px: float, room_px: float) -> float:
    """Largest factor (1, 2 or 5 times a power of ten, at least 1) by which an arrow of `largest_px`
    still fits into `room_px`."""
    if not (np.isfinite(largest_px) and largest_px > 0):
        return 1.0
    return max(1.0, round_down(room_px / largest_px))

"""Amounts as every sentence, page and picture writes them: one rounding rule.

Whole numbers are the nearest ones, halves away from zero; what differs by the last bits of a float
is the same amount. So 611 mm never stands beside 612 mm for one length.
"""

from __future__ import annotations

import math

import numpy as np

from venus3d.engine.geometry.decomposition import Step

_NOISE_DIGITS = 6
UNKNOWN = "–"


def whole(value: float) -> int:
    """The nearest whole number."""
    size = math.floor(round(abs(float(value)), _NOISE_DIGITS) + 0.5)
    return size if value > 0 else -size


def signed(value: float) -> str:
    """A whole number with its sign, with a true minus; zero has none."""
    number = whole(value)
    return f"{number:+d}".replace("-", "−") if number else "0"


def signed_tenth(value: float) -> str:
    """A number with one decimal and its sign, with a true minus; zero has none."""
    text = f"{round(value, _NOISE_DIGITS):+.1f}".replace("-", "−")
    return "0.0" if text[1:] == "0.0" else text


def degrees(angle: float) -> str:
    """An angle in whole degrees, with the direction of its turn: "+25°"."""
    return f"{signed(angle)}°"


def size_deg(angle: float) -> str:
    """An angle's size in whole degrees: "25°"."""
    return f"{abs(whole(angle))}°"


def size_mm(mm: float) -> str:
    """A length's size in whole millimetres: "120 mm"."""
    return f"{abs(whole(mm))} mm"


def step_amount(step: Step) -> str:
    """The amount of a step: "120 mm" or "−31°"."""
    if step.axis is None:
        return size_mm(1000 * float(np.linalg.norm(step.translation)))
    return degrees(step.angle_deg)


def duration(seconds: float) -> str:
    """A time: "34 ms", from a second on "1.2 s"; a dash for none."""
    if not np.isfinite(seconds):
        return UNKNOWN
    return f"{whole(1000 * seconds)} ms" if seconds < 0.9995 else f"{figure(seconds)} s"


def figure(value: float) -> str:
    """A positive number with its significant figures: 0.034, 0.42, 3.1, 12; a dash for none."""
    if not np.isfinite(value):
        return UNKNOWN
    if value == 0 or value >= 9.95:
        return str(whole(value))
    places = 1 if value >= 0.995 else 2 if value >= 0.0995 else 3
    return f"{value:.{places}f}".removesuffix(".0")

"""Amounts as all pages and pictures write them."""

from __future__ import annotations

import numpy as np

from venus3d.engine.geometry.decomposition import Step


def signed(value: float) -> str:
    """A whole number with its sign, with a true minus; zero has none."""
    whole = round(value)
    return f"{whole:+d}".replace("-", "−") if whole else "0"


def degrees(angle: float) -> str:
    """An angle in whole degrees, with the direction of its turn: "+25°"."""
    return f"{signed(angle)}°"


def step_amount(step: Step) -> str:
    """The amount of a step: "120 mm" or "−31°"."""
    if step.axis is None:
        return f"{float(np.linalg.norm(step.translation)) * 1000:.0f} mm"
    return degrees(step.angle_deg)

"""Amounts as every page and picture writes them."""

from __future__ import annotations


def signed(value: float) -> str:
    """A whole number with its sign, a minus instead of a hyphen; nothing has none."""
    whole = round(value)
    return f"{whole:+d}".replace("-", "−") if whole else "0"


def degrees(angle: float) -> str:
    """An angle in whole degrees, with the direction of its turn: "+25°"."""
    return f"{signed(angle)}°"

"""Amounts as all pages and pictures write them."""

from __future__ import annotations


def signed(value: float) -> str:
    """A whole number with its sign, with a true minus; zero has none."""
    whole = round(value)
    return f"{whole:+d}".replace("-", "−") if whole else "0"


def degrees(angle: float) -> str:
    """An angle in whole degrees, with the direction of its turn: "+25°"."""
    return f"{signed(angle)}°"

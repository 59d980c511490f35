"""Six sliders with number fields for a board's pose, in degrees and millimetres."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array
from venus3d.scene.web import pose_texts

RANGES: tuple[tuple[float, float, float], ...] = (
    (-90.0, 90.0, 0.5),
    (-90.0, 90.0, 0.5),
    (-180.0, 180.0, 0.5),
    (-300.0, 300.0, 1.0),
    (-200.0, 200.0, 1.0),
    (150.0, 1200.0, 1.0),
)
"""Lowest, highest and step of xr, yr, zr in degrees and xt, yt, zt in millimetres."""


class PosePanel:
    """The six sliders. `on_change` is called on viser's threads, only for a person's changes."""

    def __init__(
        self,
        gui: viser.GuiApi,
        on_change: Callable[[Array], object],
        vector: Sequence[float],
        *,
        ranges: Sequence[tuple[float, float, float]] = RANGES,
    ) -> None:
        """Sliders at `vector`: xr, yr, zr in degrees, xt, yt, zt in millimetres."""
        self._on_change = on_change
        self._vector = [float(value) for value in vector]
        self._sliders: list[Any] = []
        for number, (label, hint, value, (low, high, step)) in enumerate(
            zip(pose_texts.POSE_LABELS, pose_texts.POSE_HINTS, vector, ranges, strict=True)
        ):
            slider = gui.add_slider(
                label, low, high, step, float(np.clip(value, low, high)), hint=hint
            )
            slider.on_update(partial(self._moved, number))
            self._sliders.append(slider)

    @property
    def vector(self) -> Array:
        """(6,) the pose: degrees and millimetres. A slider may be unable to show its number, which
        is beyond its end or between its steps; it stays until this slider is moved."""
        return np.array(self._vector)

    def show(self, vector: Sequence[float]) -> None:
        """Set the sliders to this pose, (6,) degrees and millimetres; `on_change` is not called."""
        self._vector = [float(value) for value in vector]
        for slider, value in zip(self._sliders, vector, strict=True):
            nearest = float(np.clip(round(value / slider.step) * slider.step, *_ends(slider)))
            if slider.value != nearest:
                slider.value = nearest

    def enable(self, free: Sequence[bool]) -> None:
        """Enable only the free ones of the six."""
        for slider, on in zip(self._sliders, free, strict=True):
            slider.disabled = not on

    def _moved(self, number: int, event: Any) -> None:
        # Values set by the program come back without a client.
        if event.client is not None:
            self._vector[number] = float(event.target.value)
            self._on_change(self.vector)


def _ends(slider: Any) -> tuple[float, float]:
    return float(slider.min), float(slider.max)

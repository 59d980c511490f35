"""Six sliders with number fields for a board's pose: what a person sets a pose with.

Shows and tells pose vectors in degrees and millimetres; what they mean is left to the page.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array
from venus3d.scene.web.pose_texts import POSE_HINTS, POSE_LABELS

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
    """The six sliders. `on_change` is called on viser's threads, only for what a person did."""

    def __init__(
        self,
        gui: viser.GuiApi,
        on_change: Callable[[Array], object],
        vector: Sequence[float],
        *,
        ranges: Sequence[tuple[float, float, float]] = RANGES,
    ) -> None:
        """Sliders that stand at `vector`: xr, yr, zr in degrees, xt, yt, zt in millimetres."""
        self._on_change = on_change
        self._sliders: list[Any] = []
        for label, hint, value, (low, high, step) in zip(
            POSE_LABELS, POSE_HINTS, vector, ranges, strict=True
        ):
            slider = gui.add_slider(
                label, low, high, step, float(np.clip(value, low, high)), hint=hint
            )
            slider.on_update(self._moved)
            self._sliders.append(slider)

    @property
    def vector(self) -> Array:
        """(6,) what the sliders say: degrees and millimetres."""
        return np.array([float(slider.value) for slider in self._sliders])

    def show(self, vector: Sequence[float]) -> None:
        """Let the sliders stand at this pose, (6,) degrees and millimetres; asks nobody."""
        for slider, value in zip(self._sliders, vector, strict=True):
            nearest = float(np.clip(round(value / slider.step) * slider.step, *_ends(slider)))
            if slider.value != nearest:
                slider.value = nearest

    def enable(self, free: Sequence[bool]) -> None:
        """Which of the six a person may move."""
        for slider, on in zip(self._sliders, free, strict=True):
            slider.disabled = not on

    def _moved(self, event: Any) -> None:
        # Values that the program sets come back without a client.
        if event.client is not None:
            self._on_change(self.vector)


def _ends(slider: Any) -> tuple[float, float]:
    return float(slider.min), float(slider.max)

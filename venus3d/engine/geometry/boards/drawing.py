"""What is printed of a board, as shapes, and those shapes as a picture."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array

_FINE = 8
"""Rows of a disc's pixels are measured at so many heights each."""


@dataclass(frozen=True, eq=False)
class BoardDrawing:
    """Dark shapes on a light ground, none over another; in the board's frame, metres."""

    rectangles: Array = field(default_factory=lambda: np.empty((0, 4)))
    """(N, 4) left, top, width, height."""
    discs: Array = field(default_factory=lambda: np.empty((0, 3)))
    """(N, 3) centre x, y and radius."""


def painted(drawing: BoardDrawing, size: tuple[float, float], scale: float) -> NDArray[np.uint8]:
    """Grey picture of a drawing about the middle of `size`, metres, at `scale` pixels per metre:
    each pixel is as grey as the share of it that is dark."""
    width, height = (round(side * scale) for side in size)
    dark = np.zeros((height, width))
    middle = np.array([width, height]) / 2
    for left, top, wide, high in drawing.rectangles * scale:
        x, across = _covered(left + middle[0], left + wide + middle[0], width)
        y, down = _covered(top + middle[1], top + high + middle[1], height)
        dark[y : y + down.size, x : x + across.size] += np.outer(down, across)
    for x, y, radius in drawing.discs * scale:
        x, y = middle + np.array([x, y])
        rows, columns = (
            _touched(y - radius, y + radius, height),
            _touched(x - radius, x + radius, width),
        )
        heights = rows[:, None] + (np.arange(_FINE) + 0.5) / _FINE - y
        halves = np.sqrt(np.maximum(0, radius**2 - heights**2))[..., None]
        across = np.minimum(x + halves, columns + 1) - np.maximum(x - halves, columns)
        dark[np.ix_(rows, columns)] += np.maximum(0, across).mean(axis=1)
    return np.asarray(np.rint(255 * (1 - np.clip(dark, 0, 1))), dtype=np.uint8)


def _covered(low: float, high: float, count: int) -> tuple[int, Array]:
    """The first of `count` pixels that an interval touches, and the share covered of each."""
    low, high = max(0.0, low), min(float(count), high)
    first, last = int(low), max(int(low), int(np.ceil(high - 1e-9)))
    edges = np.clip(np.arange(first, last + 1), low, high)
    return first, np.diff(edges)


def _touched(low: float, high: float, count: int) -> NDArray[np.intp]:
    """Which of `count` pixels an interval touches."""
    return np.arange(max(0, int(np.floor(low))), min(count, int(np.ceil(high))))


def marker_cells(
    dictionary: Any, number: int, left: float, top: float, side: float, border: int = 1
) -> list[tuple[float, float, float, float]]:
    """The dark cells of a marker as rectangles, those side by side as one."""
    cells = dictionary.markerSize + 2 * border
    dark = np.asarray(dictionary.generateImageMarker(number, cells, borderBits=border)) < 128
    size = side / cells
    found: list[tuple[float, float, float, float]] = []
    for row in range(cells):
        edges = np.flatnonzero(np.diff(np.pad(dark[row].astype(np.int8), 1)))
        for begin, end in edges.reshape(-1, 2):
            found.append((left + begin * size, top + row * size, (end - begin) * size, size))
    return found

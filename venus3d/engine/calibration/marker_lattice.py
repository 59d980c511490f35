"""How markers lie: side by side, or on every second square, and in which row and column each is."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.marker_reading import Markers
from venus3d.engine.geometry.pose import Array

Arrangement = Literal["chessboard", "grid"]

_FEWEST = 4
"""Markers of one dictionary in place that rule out a chance detection."""
_NEAR = 0.3
"""Largest deviation from a place, in squares, as seen from a neighbour."""
_UPRIGHT = 0.8
"""Cosine of the largest angle between two markers of one board."""
_STEPS = 2


@dataclass(frozen=True, eq=False)
class Lattice:
    """Markers of one board in one image."""

    arrangement: Arrangement
    """On every second square as on a ChArUco board, or side by side."""
    ids: NDArray[np.intp]
    """(N,)"""
    places: NDArray[np.intp]
    """(N, 2) column and row, counted from the leftmost and the topmost marker seen."""
    quads: Array
    """(N, 4, 2) corners in pixels."""
    marker_share: float
    """Side of a marker over the distance from one place to the next."""
    H: Array
    """(3, 3) homography from places to pixels."""

    @property
    def columns(self) -> int:
        """Number of columns seen."""
        return int(self.places[:, 0].max()) + 1

    @property
    def rows(self) -> int:
        """Number of rows seen."""
        return int(self.places[:, 1].max()) + 1


def lattices_of(markers: Markers) -> list[Lattice]:
    """The boards that the markers lie on, the one with the most markers first."""
    if markers.ids.size < _FEWEST:
        return []
    seen = _seen_from_each(markers.quads)
    spacing = _spacing(seen)
    if spacing is None:
        return []
    arrangement, step = spacing
    found = [
        _lattice(markers, members, places, arrangement)
        for members, places in _connected(seen / step, arrangement, markers.quads)
        if len(members) >= _FEWEST
    ]
    whole = [lattice for lattice in found if lattice is not None]
    return sorted(whole, key=lambda lattice: -lattice.ids.size)


def _seen_from_each(quads: Array) -> Array:
    """(N, N, 2) centre of marker k in the frame of marker n, whose side is 1."""
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], dtype=np.float32)
    centres = quads.mean(axis=1)[None]
    return np.array(
        [
            cv2.perspectiveTransform(
                centres, cv2.getPerspectiveTransform(quad.astype(np.float32), square)
            )[0]
            for quad in quads
        ]
    )


def _spacing(seen: Array) -> tuple[Arrangement, float] | None:
    """How a marker's nearest neighbour lies, and the distance from square to square, in sides of a
    marker: diagonally on a ChArUco board."""
    distances = np.linalg.norm(seen, axis=2) + np.diag(np.full(len(seen), np.inf))
    nearest = np.abs(seen[np.arange(len(seen)), distances.argmin(axis=1)])
    long, short = nearest.max(axis=1), nearest.min(axis=1)
    diagonal, straight = short > 0.6 * long, short < 0.35 * long
    if diagonal.sum() > 0.6 * len(seen):
        return "chessboard", float(np.median((long + short)[diagonal] / 2))
    if straight.sum() > 0.6 * len(seen):
        return "grid", float(np.median(long[straight]))
    return None


def _connected(
    steps: Array, arrangement: Arrangement, quads: Array
) -> list[tuple[list[int], list[tuple[int, int]]]]:
    """Sets of markers that lead to each other over neighbours, and their places."""
    whole = np.rint(steps)
    near = (np.abs(steps - whole).max(axis=2) < _NEAR) & (np.abs(whole).max(axis=2) <= _STEPS)
    near &= whole.any(axis=2)
    if arrangement == "chessboard":
        near &= whole.sum(axis=2) % 2 == 0
    across = quads[:, 1] - quads[:, 0] + quads[:, 2] - quads[:, 3]
    across /= np.linalg.norm(across, axis=1)[:, None]
    near &= across @ across.T > _UPRIGHT
    free = set(range(len(steps)))
    found: list[tuple[list[int], list[tuple[int, int]]]] = []
    while free:
        first = max(free, key=lambda n: int(near[n].sum()))
        free.discard(first)
        places = {first: (0, 0)}
        taken = {(0, 0)}
        queue = deque([first])
        while queue:
            n = queue.popleft()
            for k in sorted(free & set(map(int, np.flatnonzero(near[n])))):
                column, row = (int(v) for v in np.array(places[n]) + whole[n, k])
                if (column, row) not in taken:
                    places[k] = (column, row)
                    taken.add((column, row))
                    free.discard(k)
                    queue.append(k)
        found.append((list(places), list(places.values())))
    return found


def _lattice(
    markers: Markers,
    members: list[int],
    placed: list[tuple[int, int]],
    arrangement: Arrangement,
) -> Lattice | None:
    places = np.array(placed, dtype=np.intp)
    places -= places.min(axis=0)
    quads = markers.quads[members]
    if np.unique(places, axis=0).shape[0] < _FEWEST or min(np.ptp(places, axis=0)) < 1:
        return None
    H, _ = cv2.findHomography(places.astype(np.float64), quads.mean(axis=1))
    if H is None:
        return None
    try:
        back = np.linalg.inv(np.asarray(H, dtype=np.float64))
    except np.linalg.LinAlgError:
        return None
    return Lattice(
        arrangement,
        markers.ids[members],
        places,
        quads,
        side_of(quads, np.asarray(back, dtype=np.float64)),
        np.asarray(H, dtype=np.float64),
    )


def side_of(quads: Array, H: Array) -> float:
    """The side of markers (N, 4, 2 pixels) on the plane that a homography H takes pixels to.

    Found from outlines through the centres of a marker's outermost pixels, they are a pixel short.
    """
    flat = cv2.perspectiveTransform(quads.reshape(1, -1, 2), H).reshape(-1, 4, 2)
    sides = np.linalg.norm(flat - np.roll(flat, 1, axis=1), axis=2)
    pixels = np.linalg.norm(quads - np.roll(quads, 1, axis=1), axis=2)
    return float(np.median(sides * (1 + 1 / np.maximum(pixels, 1.0))))

"""Finds grids of circles, symmetric and asymmetric ones, of a known size and of any.

`cv2.findCirclesGrid` must be told the size, and took minutes for some pictures with noise. Here the
centres of round blobs are walked through from neighbour to neighbour, which gives each a place in a
lattice; the outline of the places tells the kind. In an asymmetric grid every second row is shifted
by half a step: its nearest neighbours lie diagonally, and the places fill a rectangle once they are
turned by 45°.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]
_Place = tuple[int, int]

_FEWEST, _FEWEST_CIRCLES, _MOST_CIRCLES = 3, 12, 400
_LEAST_AREA, _LEAST_PIXELS = 20.0, 2000
_ELLIPTIC, _AROUND = 0.98, 0.6
"""See `_ellipticity`: drawn circles have 1.000, what is in the squares of small boards up to 0.96.
It is looked at up to this share of the way to the nearest neighbour."""
_ROUND = 0.82
"""Circularity of a blob: a square has 0.79, an ellipse twice as long as wide 0.84."""
_NEAR = 0.35
"""A neighbour is at most this share of a step away from where it is expected."""
_ACROSS = 0.5
"""Least sine of the angle between the two steps."""
_FILLED, _PLACED = 0.9, 0.6
"""Shares of the outline's places that have a circle, and of the circles that have a place."""
_STRAY = 1.2
"""How many times as many as the board's circles may be in the lattice: what lies beside them."""
_STARTS = 6
"""Circles from which the walk begins, as one may lie beside the board."""
_TURNED = np.array([[1, 1], [1, -1]])
_BASES = [
    np.array(rows).reshape(2, 2)
    for rows in product((0, 1, -1), repeat=4)
    if abs(rows[0] * rows[3] - rows[1] * rows[2]) == 1
]


@dataclass(frozen=True)
class CircleGrid:
    """A grid of circles in an image."""

    columns: int
    rows: int
    """The longer side first; of an asymmetric grid, the circles in a row and the rows."""
    asymmetric: bool
    white: bool = False
    """Whether they are white on a dark ground."""


def find_circles(grey: Grey) -> CircleGrid | None:
    """The grid of black or white circles in an image (H, W); None if there is none."""
    if grey.size < _LEAST_PIXELS:
        return None
    parameters = cv2.SimpleBlobDetector.Params()
    parameters.filterByCircularity, parameters.minCircularity = True, _ROUND
    parameters.minArea, parameters.maxArea = _LEAST_AREA, grey.size / 50
    for white in (False, True):
        picture = np.asarray(255 - grey, dtype=np.uint8) if white else grey
        for centres in alike_blobs(cv2.SimpleBlobDetector.create(parameters).detect(picture)):
            if _FEWEST_CIRCLES <= len(centres) <= _MOST_CIRCLES:
                found = _arranged(centres)
                if found is not None and _ellipticity(picture, centres) > _ELLIPTIC:
                    return replace(found, white=white)
    return None


def grids_of(centres: Array, columns: int, rows: int, stride: int) -> list[Array]:
    """The ways to number circles (N, 2) as a grid (rows, columns, 2) that is seen from the front;
    none if they are no such grid. Other circles may be beside it.

    Args:
        stride: 2 if the circles of a row are two squares apart and every second row is shifted.
    """
    nearest = np.argsort(np.linalg.norm(centres - np.median(centres, axis=0), axis=1))
    for first in nearest[:_STARTS]:
        placed = _placed(centres, int(first))
        if columns * rows <= len(placed) <= _STRAY * columns * rows:
            places, found = np.array(list(placed)), centres[list(placed.values())]
            return list(_numberings(places, found, columns, rows, stride))
    return []


def _numberings(
    places: NDArray[np.intp], found: Array, columns: int, rows: int, stride: int
) -> Iterator[Array]:
    for basis in _BASES:
        at = places @ basis @ _TURNED if stride == 2 else places @ basis
        board = _in_full_lines(at)
        if board.sum() != columns * rows:
            continue
        at = at[board] - at[board].min(axis=0)
        order = np.lexsort((at[:, 0], at[:, 1]))
        filled = tuple(at.max(axis=0)) == (stride * columns - 1, rows - 1)
        if not filled or at[order[0], 0] != 0:
            continue
        grid = found[board][order].reshape(rows, columns, 2)
        right, down = grid[0, -1] - grid[0, 0], grid[-1, 0] - grid[0, 0]
        if right[0] * down[1] - right[1] * down[0] > 0:
            yield grid


def _in_full_lines(at: NDArray[np.intp]) -> NDArray[np.bool_]:
    """(N,) which of the places (N, 2) are in rows and columns that have half as many as others: the
    mark for the top of a printed board and its QR code lie where other circles would."""
    full = np.ones(len(at), dtype=bool)
    for line in at.T:
        _, which, counts = np.unique(line, return_inverse=True, return_counts=True)
        full &= (2 * counts >= counts.max())[which]
    return full


def _ellipticity(grey: Grey, centres: Array) -> float:
    """How much the dark blobs at most centres (N, 2) are ellipses: their area by that of the
    ellipse with the same second moments. 1 for an ellipse, 0.955 for a square, however seen."""
    apart = np.linalg.norm(centres[:, None] - centres, axis=2)
    radii = _AROUND * np.sort(apart, axis=1)[:, 1]
    found: list[float] = []
    for (x, y), radius in zip(centres, radii, strict=True):
        side = 2 * int(np.ceil(radius)) + 1
        cut: Any = cv2.getRectSubPix(grey, (side, side), (float(x), float(y)))
        patch: Any = cv2.resize(cut, None, fx=4, fy=4, interpolation=cv2.INTER_CUBIC)
        dark = (patch < (float(patch.min()) + float(patch.max())) / 2).astype(np.uint8)
        labels = np.asarray(cv2.connectedComponents(dark)[1])
        middle = labels[len(labels) // 2, len(labels) // 2]
        if middle == 0:
            continue
        m = cv2.moments((labels == middle).astype(np.uint8), binaryImage=True)
        spread = m["mu20"] * m["mu02"] - m["mu11"] ** 2
        if spread > 0:
            found.append(m["m00"] ** 2 / (4 * np.pi * np.sqrt(spread)))
    return float(np.median(found)) if 2 * len(found) > len(centres) else 0.0


def alike_blobs(blobs: Any, spread: float = 2.0) -> list[Array]:
    """(N, 2) centres of the blobs of about the same size: up to `spread` times the
    median one's; then likewise by the blob at half of their areas, if those are others: letters
    and what is in a QR code can be more than the circles, but are smaller."""
    sizes = np.sort(np.array([blob.size for blob in blobs]))
    if not sizes.size:
        return []
    areas = np.cumsum(sizes**2)
    half = float(sizes[np.searchsorted(areas, areas[-1] / 2)])
    found: list[Array] = []
    for middle in (float(np.median(sizes)), half):
        alike = [one.pt for one in blobs if middle / spread < one.size < middle * spread]
        if not found or len(alike) != len(found[0]):
            found.append(np.array(alike, dtype=np.float64).reshape(-1, 2))
    return found


def _arranged(centres: Array) -> CircleGrid | None:
    """The grid in which most of the centres (N, 2) lie."""
    middle = int(np.argmin(np.linalg.norm(centres - centres.mean(axis=0), axis=1)))
    placed = np.array(list(_placed(centres, middle)))
    if len(placed) < max(_FEWEST_CIRCLES, _PLACED * len(centres)):
        return None
    # Seen from the side, the nearest neighbours may be others: any basis of the lattice is tried.
    for fits in (_symmetric, _asymmetric):
        for basis in _BASES:
            found = fits(placed @ basis)
            if found is not None:
                return found
    return None


def _symmetric(places: NDArray[np.intp]) -> CircleGrid | None:
    columns, rows = (int(n) for n in np.ptp(places, axis=0) + 1)
    if min(columns, rows) < _FEWEST or len(places) < _FILLED * columns * rows:
        return None
    return CircleGrid(max(columns, rows), min(columns, rows), False)


def _asymmetric(places: NDArray[np.intp]) -> CircleGrid | None:
    across, down = (int(n) for n in np.ptp(places @ _TURNED, axis=0) + 1)
    # One side has the circles of a row and the gaps between them: an even number of places.
    sizes = [(n // 2, m) for n, m in ((across, down), (down, across)) if n % 2 == 0]
    if not sizes or 2 * len(places) < _FILLED * across * down:
        return None
    columns, rows = min(sizes, key=lambda size: abs(size[0] - size[1]))
    return CircleGrid(columns, rows, True) if min(columns, rows) >= _FEWEST else None


def _placed(centres: Array, first: int) -> dict[_Place, int]:
    """The index of the circle at each place of the lattice around one of the centres."""
    steps = _steps(centres, first)
    if steps is None:
        return {}
    placed: dict[_Place, int] = {(0, 0): first}
    waiting = deque([((0, 0), steps)])
    while waiting:
        place, (right, down) = waiting.popleft()
        here = centres[placed[place]]
        for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1)):
            step = sign * (right if axis == 0 else down)
            near = int(np.argmin(np.linalg.norm(centres - here - step, axis=1)))
            found = centres[near] - here
            limit = _NEAR * min(np.linalg.norm(right), np.linalg.norm(down))
            next_place = (place[0] + sign, place[1]) if axis == 0 else (place[0], place[1] + sign)
            if next_place in placed or np.linalg.norm(found - step) > limit:
                continue
            placed[next_place] = near
            # The steps change with perspective and lens: as they were measured last.
            waiting.append(
                (next_place, (sign * found, down) if axis == 0 else (right, sign * found))
            )
    return placed


def _steps(centres: Array, index: int) -> tuple[Array, Array] | None:
    """From a circle to its nearest neighbour, and to the nearest in another direction."""
    away = np.delete(centres, index, axis=0) - centres[index]
    away = away[np.argsort(np.linalg.norm(away, axis=1))]
    unit = away / np.linalg.norm(away, axis=1, keepdims=True)
    sine = abs(unit[0, 0] * unit[:, 1] - unit[0, 1] * unit[:, 0])
    others = np.flatnonzero(sine > _ACROSS)
    return (away[0], away[others[0]]) if others.size else None

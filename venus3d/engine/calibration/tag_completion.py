"""Reads the tags of a grid that the detector of markers missed, where the ones around say they are.

OpenCV outlines each tag by itself and compares its cells in black and white. Of small tags, or of
those that black squares touch, the outlines are a pixel off, and the cells with them. Seen from the
tags around it, a missing tag's place is known better than that, its corners can be refined, and one
pattern only is to be expected: it is looked for by its correlation with the grey values.
"""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_reader import Grey
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

_NEAR = 2
"""Columns and rows within which tags say where another one is: beyond, a wide lens bends more than
a homography follows."""
_ALIKE = 0.7
"""Correlation of the inner cells with the tag's: of others 0 +- 0.25 (16 cells), 0.17 (36)."""
_IN_CELL = np.array([-0.25, 0.0, 0.25])
"""Places in a cell, in cells from its middle, in each direction."""

Refine = Callable[[Array], Array]
"""Outlines (N, 4, 2) to the tags' corners near them, pixels."""


def completed(
    grey: Grey, board: Board, border: int, tags: NDArray[np.intp], quads: Array, refine: Refine
) -> tuple[NDArray[np.intp], Array]:
    """The tags (N,) and their corners (N, 4, 2) in an image, and those besides them that it shows.

    Args:
        grey: (H, W).
        border: width of the tags' black border, in cells.
    """
    found = dict(zip(tags.tolist(), quads, strict=True))
    places = board.of_kind.lattice(board).reshape(-1, 4, 2).min(axis=1) // 2
    points = board.of_kind.points(board).reshape(-1, 4, 2)
    tried: dict[int, int] = {}
    while True:
        guesses = _beside(places, points, found, tried)
        guesses = {tag: quad for tag, quad in guesses.items() if _is_within(quad, grey)}
        if not guesses:
            break
        wave, corners = list(guesses), refine(np.array(list(guesses.values())))
        seen = [_is_within(quad, grey) for quad in corners]
        seen &= _shown(grey, board, border, wave, corners)
        found |= {wave[i]: corners[i] for i in np.flatnonzero(seen)}
    every = np.array(sorted(found), dtype=np.intp)
    return every, np.array([found[tag] for tag in every.tolist()]).reshape(-1, 4, 2)


def _is_within(quad: Array, grey: Grey) -> bool:
    return bool((quad > 1).all() and (quad < np.array(grey.shape[::-1]) - 2.0).all())


def _beside(
    places: NDArray[np.intp], points: Array, found: dict[int, Array], tried: dict[int, int]
) -> dict[int, Array]:
    """Where missing tags should be (4, 2), by the tags found around them. `tried`: by how many of
    them each was looked for last; again only by twice as many."""
    known = np.array(list(found), dtype=np.intp)
    guesses: dict[int, Array] = {}
    for tag in set(range(len(places))) - set(found):
        away = np.abs(places[known] - places[tag]).max(axis=1)
        near = known[away <= _NEAR]
        if near.size < 2 * tried.get(tag, 0) or away.min() > 1:
            continue
        tried[tag] = near.size
        image = np.concatenate([found[k] for k in near.tolist()])
        H, _ = cv2.findHomography(points[near].reshape(-1, 2), image)
        if H is not None:
            guess = cv2.perspectiveTransform(points[tag][None], H)[0]
            guesses[tag] = np.asarray(guess, dtype=np.float64)
    return guesses


def _shown(
    grey: Grey, board: Board, border: int, tags: list[int], quads: Array
) -> NDArray[np.bool_]:
    """(N,) whether the tags lie at the corners (N, 4, 2): their cells, all of the border black and
    all around it white."""
    size = int(board.cv_dictionary.markerSize)
    values = _cells(grey, quads, size + 2 * border)
    edge = np.ones(values.shape[1:], dtype=bool)
    edge[2:-2, 2:-2] = False
    around = edge.copy()
    edge[[0, -1]] = edge[:, [0, -1]] = False
    around[1:-1, 1:-1] = False
    around[[0, 0, -1, -1], [0, -1, 0, -1]] = False  # black squares, or not
    black, white = values[:, edge], values[:, around]
    middle = (np.median(black, axis=1) + np.median(white, axis=1)) / 2
    is_framed = (black.max(axis=1) < middle) & (white.min(axis=1) > middle)
    inner = slice(border + 1, -border - 1)
    cells = values[:, inner, inner].reshape(len(tags), -1)
    bits = np.array([_bits(board, tag, size) for tag in tags]).reshape(len(tags), -1)
    cells = cells - cells.mean(axis=1, keepdims=True)
    bits = bits - bits.mean(axis=1, keepdims=True)
    norms = np.linalg.norm(cells, axis=1) * np.linalg.norm(bits, axis=1)
    alike = (cells * bits).sum(axis=1) / np.maximum(norms, 1e-9)
    return np.asarray(is_framed & (alike > _ALIKE))


def _cells(grey: Grey, quads: Array, cells: int) -> Array:
    """(N, cells + 2, cells + 2) mean grey of the tags' cells and of those around them."""
    middles = (np.arange(-1, cells + 1)[:, None] + 0.5 + _IN_CELL).reshape(-1) / cells
    u, v = np.meshgrid(middles, middles)
    flat = np.stack([u.ravel(), v.ravel()], axis=1)[None]
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    places = np.array(
        [
            cv2.perspectiveTransform(flat, cv2.getPerspectiveTransform(square, quad))[0]
            for quad in quads.astype(np.float32)
        ],
        dtype=np.float32,
    )
    values = cv2.remap(
        grey, places[..., 0], places[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    n, k = cells + 2, len(_IN_CELL)
    return np.asarray(values, dtype=np.float64).reshape(len(quads), n, k, n, k).mean(axis=(2, 4))


def _bits(board: Board, tag: int, size: int) -> Array:
    """(size, size) 1 where the tag is white."""
    entry = board.cv_dictionary.bytesList[tag : tag + 1]
    return np.asarray(cv2.aruco.Dictionary.getBitsFromByteList(entry, size), dtype=np.float64)

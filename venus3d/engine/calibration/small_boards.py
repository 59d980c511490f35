"""Recognises a board that is too small to be read, in pictures where detection failed.

In an enlarged picture its markers have enough pixels to be read. What is read so is no measurement:
the corners between pixels that small are worth little.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_diagnoses import small_board_diagnosis
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.legibility import legible_square_px, square_px
from venus3d.engine.calibration.marker_reading import family_of, read_markers
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board

Grey = NDArray[np.uint8]

_TIMES = 3
_MOST_PIXELS = 30_000_000  # of an enlarged picture; above, it is enlarged less, or not at all
_FEWEST, _FEWEST_OF_4X4 = 2, 4
"""Markers that are there by no chance; of 4 x 4 cells one of 16 random squares is one."""


def small_board(
    board: Board,
    pictures: Iterable[Grey],
    detect: Callable[[Grey], Observation],
) -> Diagnosis | None:
    """That the grey images (H, W) show `board` too small; None if they do not.

    Args:
        detect: of a detector of the board.
    """
    needed = legible_square_px(board)
    found: list[float] = []
    for picture in pictures:
        times = min(_TIMES, int(np.sqrt(_MOST_PIXELS / picture.size)))
        if times < 2:
            continue
        enlarged = cv2.resize(picture, None, fx=times, fy=times, interpolation=cv2.INTER_CUBIC)
        grey = np.asarray(enlarged, dtype=np.uint8)
        seen = detect(grey)
        width = square_px(board, seen) if seen.count else _by_markers(board, grey)
        if width is not None:
            found.append(width / times)
    if not found or max(found) >= needed:
        return None
    return small_board_diagnosis(max(found), needed)


def _by_markers(board: Board, grey: Grey) -> float | None:
    """The side of a square by single markers of the board's, where they give no corners; None if
    there are too few."""
    if not board.has("marker"):
        return None
    own = family_of(board.dictionary)
    read = next((m for m in read_markers(grey)[0] if family_of(m.dictionary) == own), None)
    if read is None or read.distinct < (_FEWEST_OF_4X4 if "4X4" in own else _FEWEST):
        return None
    sides = np.linalg.norm(read.quads - np.roll(read.quads, 1, axis=1), axis=2)
    return float(np.median(sides.min(axis=1))) * board.square / board.marker

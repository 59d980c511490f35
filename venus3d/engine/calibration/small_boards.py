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
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board

_TIMES = 3
_MOST_PIXELS = 30_000_000  # of an enlarged picture; above, it is enlarged less, or not at all


def small_board(
    board: Board,
    pictures: Iterable[NDArray[np.uint8]],
    detect: Callable[[NDArray[np.uint8]], Observation],
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
        seen = detect(np.asarray(enlarged, dtype=np.uint8))
        if seen.count:
            found.append(square_px(board, seen) / times)
    if not found or max(found) >= needed:
        return None
    return small_board_diagnosis(max(found), needed)

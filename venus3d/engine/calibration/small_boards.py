"""Recognises a board that is too small to be read, in pictures where detection failed.

In an enlarged picture its markers have enough pixels to be read; smaller ones are lost, but the
grid of its squares is seen. What is read so is no measurement: the corners between pixels that
small are worth little.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.corner_grids import is_even
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.refusals import legible_square_px, square_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.sentences import Sentence

_TIMES = 3
_BLUR = 0.67  # of a pixel: without it the squares' markers spoil their grid
_MOST_PIXELS = 30_000_000  # of an enlarged picture; above, it is enlarged less, or not at all


_OF_SQUARES = ("charuco", "chessboard")


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
    unread: list[NDArray[np.uint8]] = []
    for picture in pictures:
        times = min(_TIMES, int(np.sqrt(_MOST_PIXELS / picture.size)))
        if times < 2:
            continue
        seen = detect(_enlarged(picture, times))
        if seen.count:
            found.append(square_px(board, seen) / times)
        else:
            unread.append(picture)
    if not found and board.kind in _OF_SQUARES:
        seen_as_grids = (_grid_px(board, picture) for picture in unread)
        found += next(([width] for width in seen_as_grids if width), [])
    if not found or max(found) >= needed:
        return None
    return Diagnosis(
        "small-board",
        Sentence(
            "The board is in the picture, but too small to be read: its squares are {width} px "
            "wide, and {needed} px are needed."
        ).format(width=f"{max(found):.0f}", needed=f"{needed:.0f}"),
        Sentence("Bring it nearer, take pictures with more pixels, or print larger squares."),
    )


def _enlarged(picture: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
    found = cv2.resize(picture, None, fx=times, fy=times, interpolation=cv2.INTER_CUBIC)
    return np.asarray(found, dtype=np.uint8)


def _grid_px(board: Board, picture: NDArray[np.uint8]) -> float | None:
    """The narrow side of the squares of a grid with as many inner corners as the board, pixels."""
    columns, rows = (board.lattice.max(axis=0) + 1).tolist()
    for times in range(min(_TIMES, int(np.sqrt(_MOST_PIXELS / picture.size))), 1, -1):
        blurred = cv2.GaussianBlur(_enlarged(picture, times), (0, 0), _BLUR * times)
        flags = cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE
        found, corners = cv2.findChessboardCornersSB(blurred, (columns, rows), flags=flags)
        grid = np.asarray(corners, dtype=np.float64).reshape(rows, columns, 2) if found else None
        if grid is not None and is_even(grid):
            steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=2) for axis in (0, 1)]
            return min(float(np.median(step)) for step in steps) / times
    return None

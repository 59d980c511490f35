"""Reads checkerboards: found as a whole by `cv2.findChessboardCornersSB`, then followed from image
to image by optical flow, which takes a tenth of the time.

A checkerboard does not say which way up it is. Where a half turn exchanges its colours they tell;
else the reading nearest to the last image's is taken, and in the first image the upright one.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_reader import NOTHING, BoardReader, Grey, Read, Region
from venus3d.engine.calibration.corner_grids import contrast_of, is_even, turned
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

# NORMALIZE_IMAGE lost 9 of 13 boards of a real recording, and ACCURACY, three times as slow, gained
# none. EXHAUSTIVE finds 22 instead of 20 of 24 in a fisheye's, and is slow where there is none.
_LIVE, _THOROUGH = 0, cv2.CALIB_CB_EXHAUSTIVE
_FLOW_WINDOW, _FLOW_LEVELS = (15, 15), 3
_UPRIGHT = np.array([1.0, 0.0])


class ChessboardReader(BoardReader):
    """The whole board, or nothing."""

    def __init__(self, board: Board) -> None:
        """Nothing seen yet."""
        super().__init__(board)
        self._last: tuple[Grey, Array] | None = None
        self._across = _UPRIGHT

    def copy(self) -> ChessboardReader:
        """Without a last image."""
        other = super().copy()
        other._last, other._across = None, _UPRIGHT
        return other

    def read(self, grey: Grey, region: Region, quick: bool) -> Read:
        """All inner corners or none; `quick` only follows those of the last image."""
        found = self._followed(grey, region) if quick else self._found(grey, region)
        if self.is_copy:
            return NOTHING if found is None else _numbered(found)
        if found is None:
            self._last = None
            return NOTHING
        self._last, self._across = (grey, found), _direction(found)
        return _numbered(found)

    def _found(self, grey: Grey, region: Region) -> Array | None:
        x0, y0, x1, y1 = region
        size = (self.board.columns - 1, self.board.rows - 1)
        flags = _THOROUGH if self.is_copy else _LIVE
        part = np.ascontiguousarray(grey[y0:y1, x0:x1])
        try:
            seen, corners = cv2.findChessboardCornersSB(part, size, flags=flags)
        except cv2.error:  # of images that are hardly larger than a few pixels
            return None
        if not seen:
            return None
        grid = np.asarray(corners, dtype=np.float64).reshape(size[1], size[0], 2)
        readings = turned(grid + np.array([x0, y0]))
        coloured = [one for one in readings if contrast_of(grey, one) > 0]
        return max(coloured or readings, key=lambda one: float(_direction(one) @ self._across))

    def _followed(self, grey: Grey, region: Region) -> Array | None:
        if self._last is None or self._last[0].shape != grey.shape:
            return None
        (before, grid), (x0, y0, x1, y1) = self._last, region
        start = (grid.reshape(-1, 1, 2) - [x0, y0]).astype(np.float32)
        parts: list[Any] = [np.ascontiguousarray(g[y0:y1, x0:x1]) for g in (before, grey)]
        moved, status, _ = cv2.calcOpticalFlowPyrLK(
            parts[0], parts[1], start, start.copy(), winSize=_FLOW_WINDOW, maxLevel=_FLOW_LEVELS
        )
        if moved is None or not np.all(status):
            return None
        now = np.asarray(moved, dtype=np.float64).reshape(grid.shape) + np.array([x0, y0])
        if not (is_even(now) and contrast_of(grey, now) * contrast_of(before, grid) > 0):
            return None
        return now


def _numbered(grid: Array) -> Read:
    ids: NDArray[np.intp] = np.arange(grid.shape[0] * grid.shape[1], dtype=np.intp)
    return ids, grid.reshape(-1, 2)


def _direction(grid: Array) -> Array:
    """(2,) the rows' direction in the image, a unit vector."""
    along = (grid[:, -1] - grid[:, 0]).sum(axis=0)
    return along / max(float(np.linalg.norm(along)), 1e-9)

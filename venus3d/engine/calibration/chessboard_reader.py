"""Reads checkerboards: found as a whole by `cv2.findChessboardCornersSB`, then followed from image
to image by optical flow, which takes a tenth of the time.

Of a whole board found, each corner is the mean of two measurements: SB's own, which is off by up to
0.3 px where squares are small and seen at an angle (docs/method.md), and cornerSubPix's, which is
noisier in blurred and grainy pictures. One followed has cornerSubPix's alone.

A checkerboard does not say which way up it is. Where a half turn exchanges its colours they tell;
else the reading nearest to the last image's is taken, and in the first image the upright one.
"""

from __future__ import annotations

import cv2
import numpy as np

from venus3d.engine.calibration.board_reader import NOTHING, Grey, Read, Region, WholeBoardReader
from venus3d.engine.calibration.corner_grids import (
    contrast_of,
    is_even,
    numbered,
    row_direction,
    turned,
)
from venus3d.engine.calibration.following import flowed
from venus3d.engine.calibration.refinement import (
    by_corner_sub_pix,
    local_scales,
    refinement_windows,
)
from venus3d.engine.geometry.pose import Array

# NORMALIZE_IMAGE lost 9 of 13 boards of a real recording, and ACCURACY, three times as slow, gained
# none. EXHAUSTIVE finds 22 instead of 20 of 24 in a fisheye's, and is slow where there is none.
_LIVE, _THOROUGH = 0, cv2.CALIB_CB_EXHAUSTIVE


class ChessboardReader(WholeBoardReader):
    """The whole board, or nothing."""

    def read(self, grey: Grey, region: Region, quick: int) -> Read:
        """All inner corners or none; `quick` only follows those of the last image."""
        found = self._followed(grey, region) if quick else self._found(grey, region)
        if self.is_copy:
            return NOTHING if found is None else numbered(found)
        if found is None:
            self._last = None
            return NOTHING
        self._last, self._across = (grey, found), row_direction(found)
        return numbered(found)

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
        grid = grid + np.array([x0, y0])
        readings = turned((grid + self._refined(grey, grid)) / 2)
        coloured = [one for one in readings if contrast_of(grey, one) > 0]
        return max(coloured or readings, key=lambda one: float(row_direction(one) @ self._across))

    def _followed(self, grey: Grey, region: Region) -> Array | None:
        if self._last is None:
            return None
        before, grid = self._last
        now = flowed(before, grey, grid, region)
        if now is None or not is_even(now):
            return None
        same = contrast_of(grey, now) * contrast_of(before, grid) > 0
        return self._refined(grey, now) if same else None

    def _refined(self, grey: Grey, grid: Array) -> Array:
        """Corners (R, C, 2) as cornerSubPix measures them."""
        ids, corners = numbered(grid)
        windows = refinement_windows(self.board, local_scales(self.board, ids, corners), corners)
        return by_corner_sub_pix(grey, corners, windows).reshape(grid.shape)

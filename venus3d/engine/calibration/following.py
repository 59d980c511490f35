"""Where a board's points are in the next image, by optical flow."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_reader import Grey, Read, Region
from venus3d.engine.geometry.pose import Array

_WINDOW = (15, 15)
_IN_A_ROW = 3
"""Images followed before the board is searched again: what comes into view waits no longer."""
_FEWEST = 12
_SHRUNK_PX = 25.0
"""Distance of neighbouring points in the images compared: larger ones are halved."""
_FARTHEST = 0.3
"""Largest median motion, as a share of that distance; a board moved farther may be mistaken for
itself, one square on."""
_OFF_PX = 1.0
"""Largest distance of a point from where all together went, pixels."""


class Follower:
    """Follows the points of one board from image to image. Used by one thread."""

    def __init__(self, each: int = 1) -> None:
        """Nothing seen yet. `each`: points of one tag, which come one after the other."""
        self._each = each
        self._last: tuple[Grey, NDArray[np.intp], Array] | None = None
        self._in_a_row = 0
        self._lately = 0

    def found(self, grey: Grey, ids: NDArray[np.intp], points: Array) -> None:
        """Points (N, 2) that a search has found in an image, pixels. Where they are fewer than
        lately, the next image is searched too: blur hides some in one alone."""
        fewer = len(ids) < self._lately
        self._lately = max(len(ids), self._lately - 1)
        self._last = (grey, ids, points) if len(ids) >= _FEWEST else None
        self._in_a_row = _IN_A_ROW if fewer else 0

    def followed(self, grey: Grey, region: Region) -> Read | None:
        """The same points in the next image, within a region; None if it must be searched: a point
        is lost, hidden or has left the region, all have moved far, or it is time.

        Between two images a board's points move as a quadratic of their place, whatever the lens.
        That smooth motion is what is given: it is steadier than each point's own, but only near to
        where each point is. Measure it there, and tell by `measured`.
        """
        if self._last is None or self._in_a_row >= _IN_A_ROW:
            return None
        before, ids, points = self._last
        one = points[:: self._each]
        apart = np.linalg.norm(one[:, None] - one, axis=2) + np.diag(np.full(len(one), 1e9))
        spacing = float(np.median(apart.min(axis=1)))
        shrink = 2 ** max(0, int(np.log2(spacing / _SHRUNK_PX)))
        moved = flowed(before, grey, points, region, shrink=shrink)
        if moved is None:
            return None
        motion = moved - points
        x, y = ((points - points.mean(axis=0)) / max(float(np.ptp(points)), 1.0)).T
        A = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
        smooth = A @ np.linalg.lstsq(A, motion, rcond=None)[0]
        now = points + smooth
        far = float(np.median(np.linalg.norm(smooth, axis=1))) > _FARTHEST * spacing
        off = float(np.linalg.norm(motion - smooth, axis=1).max())
        x0, y0, x1, y1 = region
        inside = ((now > [x0, y0]) & (now < [x1 - 1, y1 - 1])).all()
        if far or off > _OFF_PX or not inside:
            return None
        return ids, now

    def measured(self, grey: Grey, ids: NDArray[np.intp], points: Array) -> None:
        """Where the points that were followed are, pixels."""
        self._last = (grey, ids, points)
        self._in_a_row += 1


def flowed(
    before: Grey, grey: Grey, points: Array, region: Region, *, shrink: int = 1, levels: int = 3
) -> Array | None:
    """Where the points (..., 2) of an image are in the next one, within a region; None if one of
    them is lost.

    Args:
        shrink: by how much smaller the images are that are compared.
        levels: how often they are halved.
    """
    if before.shape != grey.shape:
        return None
    x0, y0, x1, y1 = region
    width, height = (x1 - x0) // shrink * shrink, (y1 - y0) // shrink * shrink
    if not width or not height:
        return None
    parts: list[Any] = [
        np.ascontiguousarray(picture[y0 : y0 + height, x0 : x0 + width])
        for picture in (before, grey)
    ]
    if shrink > 1:  # by a whole number: OpenCV's mean over areas takes four times as long otherwise
        size = (width // shrink, height // shrink)
        parts = [cv2.resize(part, size, interpolation=cv2.INTER_AREA) for part in parts]
    start = ((points.reshape(-1, 1, 2) - [x0, y0] + 0.5) / shrink - 0.5).astype(np.float32)
    moved, status, _ = cv2.calcOpticalFlowPyrLK(
        parts[0], parts[1], start, start.copy(), winSize=_WINDOW, maxLevel=levels
    )
    if moved is None or not np.all(status):
        return None
    now = (np.asarray(moved, dtype=np.float64).reshape(points.shape) + 0.5) * shrink - 0.5
    return now + np.array([x0, y0])

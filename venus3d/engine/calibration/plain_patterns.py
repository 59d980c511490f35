"""Recognises calibration patterns without markers: checkerboards and grids of circles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

_SEARCHED_PX = 1000
"""Images are searched at this size: finding a pattern of unknown size takes its time."""
_FEWEST = 3
"""Corners or circles along each side."""
_FEWEST_CIRCLES, _MOST_CIRCLES = 12, 400


@dataclass(frozen=True)
class Pattern:
    """A pattern in an image."""

    kind: Literal["checkerboard", "circles", "unread"]
    """"unread": a checkerboard with something printed in its white squares."""
    columns: int
    rows: int
    """Inner corners, or circles, along both sides; the longer side comes first."""


def find_pattern(grey: Grey) -> Pattern | None:
    """The checkerboard or grid of circles in an image (H, W); None if there is none."""
    scale = _SEARCHED_PX / max(grey.shape)
    if scale < 1:
        small: Any = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        grey = np.asarray(small, dtype=np.uint8)
    return _checkerboard(grey) or _circles(grey)


def _checkerboard(grey: Grey) -> Pattern | None:
    flags = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_EXHAUSTIVE
    found: tuple[bool, Any, Any] = (False, None, None)
    for side in (5, _FEWEST):  # it grows from there: from 5 x 5 more often to the whole board
        found = cv2.findChessboardCornersSBWithMeta(grey, (side, side), flags)
        if found[0]:
            break
    else:
        return None
    rows, columns = np.asarray(found[2]).shape[:2]
    corners = np.asarray(found[1], dtype=np.float64).reshape(rows, columns, 2)
    kind = "unread" if _is_printed_on(grey, corners) else "checkerboard"
    return Pattern(kind, max(rows, columns), min(rows, columns))


def _is_printed_on(grey: Grey, corners: Array) -> bool:
    """Whether one colour of a checkerboard's squares (R, C, 2 corners) is not plain."""
    square = np.array([[0, 0], [32, 0], [32, 32], [0, 32]], dtype=np.float32)
    spreads: tuple[list[float], list[float]] = ([], [])
    contrast: list[float] = []
    for row in range(corners.shape[0] - 1):
        for column in range(corners.shape[1] - 1):
            quad = corners[[row, row, row + 1, row + 1], [column, column + 1, column + 1, column]]
            H = cv2.getPerspectiveTransform(quad.astype(np.float32), square)
            patch = np.asarray(cv2.warpPerspective(grey, H, (32, 32)), dtype=np.float64)
            middle = patch[8:24, 8:24]
            spreads[(row + column) % 2].append(float(middle.std()))
            contrast.append(float(np.ptp(patch)))
    printed = max(float(np.median(each)) if each else 0.0 for each in spreads)
    return printed > 0.12 * float(np.median(contrast))


def _circles(grey: Grey) -> Pattern | None:
    parameters = cv2.SimpleBlobDetector.Params()
    parameters.filterByCircularity, parameters.minCircularity = True, 0.75
    parameters.minArea, parameters.maxArea = 20.0, grey.size / 50
    for picture in (grey, np.asarray(255 - grey, dtype=np.uint8)):
        blobs = cv2.SimpleBlobDetector.create(parameters).detect(picture)
        centres = _alike(blobs)
        if _FEWEST_CIRCLES <= len(centres) <= _MOST_CIRCLES:
            found = _arranged(centres)
            if found is not None:
                return found
    return None


def _alike(blobs: Any) -> NDArray[np.float32]:
    """(N, 2) centres of the blobs of about the same size."""
    sizes = np.array([blob.size for blob in blobs])
    if not sizes.size:
        return np.zeros((0, 2), np.float32)
    alike = (sizes > 0.5 * np.median(sizes)) & (sizes < 2 * np.median(sizes))
    return np.array([blob.pt for blob in blobs], dtype=np.float32)[alike]


def _arranged(centres: NDArray[np.float32]) -> Pattern | None:
    count = len(centres)
    for rows in range(_FEWEST, int(np.sqrt(count)) + 1):
        columns, rest = divmod(count, rows)
        if rest:
            continue
        for size in ((columns, rows), (rows, columns)):
            for grid in (cv2.CALIB_CB_SYMMETRIC_GRID, cv2.CALIB_CB_ASYMMETRIC_GRID):
                find: Any = cv2.findCirclesGrid  # its stubs know no search among given points
                answer = find(centres.reshape(-1, 1, 2), size, None, grid, None)
                if answer[0]:
                    return Pattern("circles", max(size), min(size))
    return None

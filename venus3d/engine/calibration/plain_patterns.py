"""Recognises calibration patterns without markers: checkerboards and grids of circles
(`circle_grids`)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.circle_grids import CircleGrid, find_circles
from venus3d.engine.calibration.corner_grids import is_even, without_outline
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

_SEARCHED_PX, _QUICKLY_PX = 1000, 640
"""Images are searched at this size: finding a pattern of unknown size takes its time."""
_SMALL_PX, _TIMES = 10.0, 3
"""Squares up to this side may be the gaps of circles, which are found in a picture so many times as
large."""
_FEWEST = 3
"""Corners along each side."""
_LEAST_CONTRAST = 15.0
"""Grey levels between dark and light squares."""


@dataclass(frozen=True)
class Pattern:
    """A pattern in an image."""

    kind: Literal["checkerboard", "circles", "asymmetric circles", "unread"]
    """"unread": a checkerboard with something printed in its white squares."""
    columns: int
    rows: int
    """Inner corners, or circles, along both sides; the longer side comes first. Of an asymmetric
    grid, the circles in a row and the rows, as OpenCV counts them."""
    corners: Array | None = field(default=None, compare=False)
    """(R, C, 2) the inner corners, pixels."""
    white: bool = False
    """Whether circles are white on a dark ground."""


def find_pattern(grey: Grey, *, quick: bool = False) -> Pattern | None:
    """The checkerboard or grid of circles in an image (H, W); None if there is none. `quick`: in a
    quarter of the time, of squares that are not small."""
    scale = min((_QUICKLY_PX if quick else _SEARCHED_PX) / max(grey.shape), 1.0)
    if scale < 1:
        small: Any = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        grey = np.asarray(small, dtype=np.uint8)
    # Circles first: the gaps of an asymmetric grid look like a checkerboard.
    circles = find_circles(grey)
    if circles is not None:
        return _of_circles(circles)
    try:
        found = _checkerboard(grey, quick)
    except cv2.error:  # OpenCV's search for an unknown size is not made for every picture
        return None
    if found is None or found.corners is None:
        return None
    gaps = found.kind == "checkerboard" and _circles_around(grey, found.corners)
    if gaps:
        return _of_circles(gaps)
    return replace(found, corners=(found.corners + 0.5) / scale - 0.5)


def _of_circles(grid: CircleGrid) -> Pattern:
    kind = "asymmetric circles" if grid.asymmetric else "circles"
    return Pattern(kind, grid.columns, grid.rows, white=grid.white)


def _circles_around(grey: Grey, corners: Array) -> CircleGrid | None:
    """The circles whose gaps were taken for small squares between corners (R, C, 2): too small to
    be found unless enlarged."""
    step = float(np.linalg.norm(np.diff(corners, axis=0), axis=2).mean())
    if step > _SMALL_PX:
        return None
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    around = float((high - low).max())  # perhaps a part of them alone
    x0, y0 = np.maximum(np.floor(low - around), 0).astype(int)
    x1, y1 = np.ceil(high + around).astype(int)
    large: Any = cv2.resize(
        grey[y0:y1, x0:x1], None, fx=_TIMES, fy=_TIMES, interpolation=cv2.INTER_CUBIC
    )
    return find_circles(np.asarray(large, dtype=np.uint8))


def _checkerboard(grey: Grey, quick: bool) -> Pattern | None:
    flags = cv2.CALIB_CB_LARGER | cv2.CALIB_CB_NORMALIZE_IMAGE
    flags |= 0 if quick else cv2.CALIB_CB_EXHAUSTIVE
    found: tuple[bool, Any, Any] = (False, None, None)
    cv2.setRNGSeed(
        0
    )  # its search draws random numbers: the same picture shall always give the same
    for side in (5, _FEWEST):  # it grows from there: from 5 x 5 more often to the whole board
        found = cv2.findChessboardCornersSBWithMeta(grey, (side, side), flags)
        if found[0]:
            break
    else:
        return None
    rows, columns = np.asarray(found[2]).shape[:2]
    corners = np.asarray(found[1], dtype=np.float64).reshape(rows, columns, 2)
    corners = without_outline(grey, corners)
    rows, columns = corners.shape[:2]
    colours = _squares(grey, corners)
    if not (is_even(corners) and _alternates(colours)):
        return None
    kind = "unread" if _is_printed_on(colours) else "checkerboard"
    return Pattern(kind, max(rows, columns), min(rows, columns), corners)


def _squares(grey: Grey, corners: Array) -> tuple[list[Array], list[Array]]:
    """The squares between corners (R, C, 2), (32, 32) greys each, in the order of the two colours:
    the darker ones first."""
    square = np.array([[0, 0], [32, 0], [32, 32], [0, 32]], dtype=np.float32)
    colours: tuple[list[Array], list[Array]] = ([], [])
    for row in range(corners.shape[0] - 1):
        for column in range(corners.shape[1] - 1):
            quad = corners[[row, row, row + 1, row + 1], [column, column + 1, column + 1, column]]
            H = cv2.getPerspectiveTransform(quad.astype(np.float32), square)
            patch: Any = cv2.warpPerspective(grey, H, (32, 32))
            colours[(row + column) % 2].append(np.asarray(patch, dtype=np.float64))
    dark, light = sorted(colours, key=lambda of: float(np.mean(of)))
    return dark, light


def _alternates(colours: tuple[list[Array], list[Array]]) -> bool:
    """Whether nearly all dark squares are darker than nearly all light ones near them, and all are
    plain but for what is printed on the light ones."""
    dark, light = (np.array([patch.mean() for patch in of]) for of in colours)
    contrast = float(light.mean() - dark.mean())
    plain = np.median([patch[8:24, 8:24].std() for patch in colours[0]])
    middle = (light.mean() + dark.mean()) / 2
    right = (dark < middle).sum() + (light > middle).sum()
    return contrast > _LEAST_CONTRAST and bool(
        right >= 0.8 * (len(dark) + len(light)) and plain < 0.2 * contrast
    )


def _is_printed_on(colours: tuple[list[Array], list[Array]]) -> bool:
    """Whether the light squares are not plain."""
    spread = float(np.median([patch[8:24, 8:24].std() for patch in colours[1]]))
    contrast = float(np.median([np.ptp(patch) for patch in colours[1]]))
    return spread > 0.12 * contrast

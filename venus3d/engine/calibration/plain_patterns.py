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
_UNEVEN = 0.5
"""Largest change of a step from one corner to the next, as a share of it: less in a fisheye."""
_LEAST_CONTRAST = 15.0
"""Grey levels between dark and light squares."""
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
    try:
        return _checkerboard(grey) or _circles(grey)
    except cv2.error:  # OpenCV's search for an unknown size is not made for every picture
        return None


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
    colours = _squares(grey, corners)
    if not (_is_even(corners) and _alternates(colours)):
        return None
    kind = "unread" if _is_printed_on(colours) else "checkerboard"
    return Pattern(kind, max(rows, columns), min(rows, columns))


def _is_even(corners: Array) -> bool:
    """Whether corners (R, C, 2) are about evenly spaced along both directions."""
    for along in (corners, corners.transpose(1, 0, 2)):
        steps = np.diff(along, axis=1)
        uneven = np.linalg.norm(np.diff(steps, axis=1), axis=2)
        if (uneven > _UNEVEN * np.linalg.norm(steps[:, 1:], axis=2)).any():
            return False
    return True


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
    """The numbers of rows and columns in which the centres (N, 2) lie, if they do."""
    apart = np.linalg.norm(centres[:, None] - centres, axis=2) + np.diag(np.full(len(centres), 1e9))
    radius = int(min(8, 0.35 * apart.min()))
    if radius < 2:
        return None
    dots = _drawn(centres, radius)
    for rows in range(_FEWEST, int(np.sqrt(len(centres))) + 1):
        columns, rest = divmod(len(centres), rows)
        for size in () if rest else ((columns, rows), (rows, columns)):
            for grid in (cv2.CALIB_CB_SYMMETRIC_GRID, cv2.CALIB_CB_ASYMMETRIC_GRID):
                if cv2.findCirclesGrid(dots, size, flags=grid)[0]:
                    return Pattern("circles", max(size), min(size))
    return None


def _drawn(centres: NDArray[np.float32], radius: int) -> Grey:
    """Plain dots on white: OpenCV looks for a grid in an image only, and for each size anew."""
    width, height = (centres.max(axis=0) + 20).astype(int)
    image = np.full((2 * height, 2 * width), 255, np.uint8)
    for x, y in centres:
        cv2.circle(image, (round(2 * float(x)), round(2 * float(y))), 2 * radius, 0, -1)
    return image

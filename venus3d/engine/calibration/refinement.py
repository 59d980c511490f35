"""Subpixel corners: cornerSubPix in a window that follows the size of a square."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

# cornerSubPix's half-window as a share of the distance to the nearest marker edge: 0.106 of a
# square on a frontal board with markers of 3/4 of a square, less where it is foreshortened.
_WINDOW = 0.85
_SMALLEST_WINDOW = 2
_LARGEST_WINDOW = 30
_REFINE_CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 40, 0.001)


def local_scales(board: Board, ids: NDArray[np.intp], corners: Array) -> Array:
    """(N, 2, 2) derivatives of the image by the board's x, y at each corner, pixels per metre. From
    a homography through all corners; distortion changes the scale of a square only a little."""
    points = board.points_of(ids)[:, :2]
    H, _ = cv2.findHomography(points, corners)
    if H is None:
        return np.zeros((ids.size, 2, 2))
    H = np.asarray(H, dtype=np.float64)
    depth = (points @ H[2, :2] + H[2, 2])[:, None]
    image = (points @ H[:2, :2].T + H[:2, 2]) / depth
    with np.errstate(all="ignore"):
        scales = (H[:2, :2] - image[:, :, None] * H[2, :2]) / depth[:, :, None]
    return np.nan_to_num(scales, nan=0.0, posinf=0.0, neginf=0.0)


def refinement_windows(board: Board, scales: Array) -> NDArray[np.intp]:
    """(N,) half-windows that stay clear of the markers around each corner, pixels."""
    gap = (board.square - board.marker) / 2
    along = np.linspace(gap, board.square / 2, 5)
    edge = np.stack([np.full_like(along, gap), along])
    mirror = np.array([[-1.0], [1.0]])
    # The two marker edges that face the corner, in both diagonal directions: which two of the four
    # squares hold a marker depends on the layout, and the other two are symmetrical.
    edges = np.hstack([edge, edge[::-1], mirror * edge, mirror * edge[::-1]])
    room = np.abs(scales @ edges).max(axis=1).min(axis=1)
    return np.minimum(np.floor(_WINDOW * room), _LARGEST_WINDOW).astype(np.intp)


def refine_corners(grey: Grey, corners: Array, windows: NDArray[np.intp]) -> Array:
    """Corners (N, 2) after cornerSubPix in half-windows (N,); unchanged where under 2 px."""
    better = corners.copy()
    for window in np.unique(windows[windows >= _SMALLEST_WINDOW]):
        members = windows == window
        half = (int(window), int(window))
        start = corners[members].astype(np.float32).reshape(-1, 1, 2)
        moved = cv2.cornerSubPix(grey, start.copy(), half, (-1, -1), _REFINE_CRITERIA)
        moved = np.asarray(moved, dtype=np.float64).reshape(-1, 2)
        # A corner that moves far has found another edge.
        near = np.linalg.norm(moved - corners[members], axis=1) <= max(1.0, window / 2)
        better[members] = np.where(near[:, None], moved, corners[members])
    return better


def edge_sharpness(grey: Grey, corners: Array, squares: Array) -> float:
    """Contrast of the board's edges per pixel, 0 ... 1.

    The steepest grey step per pixel around a corner over the contrast there: 1 for a step within
    one pixel, 1/w for one over w pixels. Median over the corners.
    """
    height, width = grey.shape
    values: list[float] = []
    for (x, y), square in zip(corners, squares, strict=True):
        half = int(np.clip(0.3 * square, 3, 20))
        column, row = round(float(x)), round(float(y))
        if not (half <= column < width - half and half <= row < height - half):
            continue
        patch = grey[row - half : row + half + 1, column - half : column + half + 1].astype(
            np.int16
        )
        contrast = float(np.ptp(patch))
        if contrast > 0:
            steps = np.abs(np.diff(patch, axis=1)).max(), np.abs(np.diff(patch, axis=0)).max()
            values.append(float(max(steps)) / contrast)
    return float(np.median(values)) if values else 0.0

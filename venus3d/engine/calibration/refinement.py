"""Subpixel corners: cornerSubPix in a window that follows the size of a square.

A refined corner is a second opinion. It must be near the plain one, and must fit its neighbours on
the board no worse: glare, a hand or dirt in the window pulls it away.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

# cornerSubPix's half-window as a share of the distance to the nearest marker edge: 0.094 of a
# square on a frontal board with markers of 3/4 of a square, less where it is foreshortened.
_WINDOW = 0.75
_SMALLEST_WINDOW = 2
_LARGEST_WINDOW = 30
# The largest half-window as a share of the distance to the nearest corner found.
_OF_NEAREST = 0.3
# The farthest that a corner is moved, pixels. On real recordings 99 % move by less than 0.5 px, and
# those that move farther have found another edge.
_FARTHEST_PX = 1.5
# Of a smaller move, which of the two places fits better says nothing.
_TELLS_PX = 0.1
# All corners of a picture stay if together they fit their neighbours worse by this. Glare: 1.03 to
# 1.13 in six pictures of seven; simulated pictures, whose refined corners are the truer: 1.01.
_GLARE = 1.02
_ENOUGH = 80
"""Corners, at most, whose median tells the sharpness."""
_REFINE_CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 40, 0.001)
# A corner is predicted from those within so many squares along both axes, if they are this many:
# two more than a quadratic has coefficients.
_REACH, _FEWEST_NEIGHBOURS = 2, 8
# A corner is astray at so many medians of what corners are off their neighbours, and beyond
# `_FARTHEST_PX`; at most so many of a picture's.
_ASTRAY, _MOST_ASTRAY = 5.0, 0.1


def local_scales(board: Board, ids: NDArray[np.intp], corners: Array) -> Array:
    """(N, 2, 2) derivatives of the image by the board's x, y at each corner, pixels per metre.

    Measured between a corner and its neighbours along each axis. A corner that has none takes those
    of the nearest corner that has; a homography through all corners serves if no corner has any.
    """
    places, points = board.lattice[ids], board.corners[ids, :2]
    stride = board.of_kind.stride
    wide, high = board.lattice.max(axis=0) + 1 + 2 * stride
    grid = np.full((wide, high, 4), np.nan)
    grid[places[:, 0] + stride, places[:, 1] + stride] = here = np.hstack([corners, points])
    scales = np.zeros((ids.size, 2, 2))
    for axis, step in enumerate(stride * np.eye(2, dtype=np.intp)):
        after, before = places + stride + step, places + stride - step
        steps = np.stack(
            [grid[after[:, 0], after[:, 1]] - here, here - grid[before[:, 0], before[:, 1]]]
        )
        known = np.isfinite(steps[:, :, 0])
        measured = np.flatnonzero(known.any(axis=0))
        if not measured.size:
            scales[:, :, axis] = _homography_scales(board.points_of(ids)[:, :2], corners)[
                :, :, axis
            ]
            continue
        sums = np.where(known[:, measured, None], steps[:, measured], 0.0).sum(axis=0)
        mean = sums / known[:, measured].sum(axis=0)[:, None]
        nearest = np.arange(ids.size)
        if measured.size < ids.size:
            distances = np.linalg.norm(places[:, None] - places[measured], axis=2)
            nearest = np.argmin(distances, axis=1)
        scales[:, :, axis] = mean[nearest, :2] / mean[nearest, 2 + axis, None]
    return scales


def _homography_scales(points: Array, corners: Array) -> Array:
    """(N, 2, 2) the derivatives of a homography from points (N, 2) to corners (N, 2)."""
    H, _ = cv2.findHomography(points, corners)
    if H is None:
        return np.zeros((len(points), 2, 2))
    H = np.asarray(H, dtype=np.float64)
    depth = (points @ H[2, :2] + H[2, 2])[:, None]
    image = (points @ H[:2, :2].T + H[:2, 2]) / depth
    with np.errstate(all="ignore"):
        scales = (H[:2, :2] - image[:, :, None] * H[2, :2]) / depth[:, :, None]
    return np.nan_to_num(scales, nan=0.0, posinf=0.0, neginf=0.0)


def refinement_windows(board: Board, scales: Array, corners: Array) -> NDArray[np.intp]:
    """(N,) half-windows that stay clear of other edges around each corner (N, 2), pixels."""
    gap = board.of_kind.clearance(board)
    along = np.linspace(gap, board.square / 2, 5)
    edge = np.stack([np.full_like(along, gap), along])
    mirror = np.array([[-1.0], [1.0]])
    # The two marker edges that face the corner, in both diagonal directions: which two of the four
    # squares hold a marker depends on the layout, and the other two are symmetrical.
    edges = np.hstack([edge, edge[::-1], mirror * edge, mirror * edge[::-1]])
    room = np.abs(scales @ edges).max(axis=1).min(axis=1)
    apart = np.linalg.norm(corners[:, None] - corners, axis=2) + np.diag(np.full(len(corners), 1e9))
    largest = np.minimum(_LARGEST_WINDOW, _OF_NEAREST * apart.min(axis=1))
    return np.minimum(np.floor(_WINDOW * room), largest).astype(np.intp)


def refine_corners(
    board: Board, ids: NDArray[np.intp], grey: Grey, corners: Array, windows: NDArray[np.intp]
) -> Array:
    """(N, 2) corners, each refined in its half-window (N,) if that makes it better.

    A corner whose window is too small or that would move far stays as it is; so does one that then
    fits its neighbours worse, and worse than is usual in this image. All stay if together they fit
    worse. Moves of less than 0.1 px are not judged.
    """
    refined = by_corner_sub_pix(grey, corners, windows)
    smoother = _smoother(board, ids.tobytes())
    if not (smoother.any(axis=1) & _moved(refined, corners)).any():
        return refined
    # One corner on glare, off by several pixels, outweighs what all others gain.
    counted = ~_astray(board, ids, corners)
    better = refined.copy()
    better[counted] = _judged(board, ids[counted], corners[counted], refined[counted])
    return better


def _judged(board: Board, ids: NDArray[np.intp], corners: Array, refined: Array) -> Array:
    """(N, 2) the refined corners, or the plain ones where these fit their neighbours better."""
    smoother = _smoother(board, ids.tobytes())
    judged = smoother.any(axis=1)
    far = judged & _moved(refined, corners)
    if not far.any():
        return refined
    # Perspective bends a near board more than a quadratic does, by a pixel: without it, what
    # remains is the lens and the errors that are to be compared.
    flat = _as_seen(board.points_of(ids)[:, :2], corners)
    plain, better = corners - flat, refined - flat
    predicted = smoother @ better
    after = np.linalg.norm(better - predicted, axis=1)
    usual = np.sqrt((after[judged] ** 2).mean())
    before = np.sqrt(((plain - smoother @ plain)[judged] ** 2).sum(axis=1).mean())
    if usual > _GLARE * before:
        return corners
    worse = after > np.maximum(usual, np.linalg.norm(plain - predicted, axis=1))
    return np.where((far & worse)[:, None], corners, refined)


def _moved(refined: Array, corners: Array) -> NDArray[np.bool_]:
    """(N,) whether a move is large enough to be judged."""
    return np.linalg.norm(refined - corners, axis=1) > _TELLS_PX


def _astray(board: Board, ids: NDArray[np.intp], corners: Array) -> NDArray[np.bool_]:
    """(N,) corners far from where their neighbours have them: on glare, on a finger. One by one,
    the worst first, since it moves where its neighbours are expected."""
    astray = np.zeros(ids.size, dtype=bool)
    for _ in range(int(_MOST_ASTRAY * ids.size)):
        rest = np.flatnonzero(~astray)
        smoother = _smoother(board, ids[rest].tobytes())
        judged = smoother.any(axis=1)
        if not judged.any():
            break
        bent = corners[rest] - _as_seen(board.points_of(ids[rest])[:, :2], corners[rest])
        off = np.where(judged, np.linalg.norm(bent - smoother @ bent, axis=1), 0.0)
        worst = int(np.argmax(off))
        if off[worst] <= max(_FARTHEST_PX, _ASTRAY * float(np.median(off[judged]))):
            break
        astray[rest[worst]] = True
    return astray


def _as_seen(points: Array, corners: Array) -> Array:
    """(N, 2) where a homography between all puts these points; zeros if there is none."""
    H, _ = cv2.findHomography(points, corners)
    if H is None:
        return np.zeros_like(corners)
    image = np.column_stack([points, np.ones(len(points))]) @ np.asarray(H, dtype=np.float64).T
    with np.errstate(all="ignore"):
        return np.nan_to_num(image[:, :2] / image[:, 2:])


def by_corner_sub_pix(grey: Grey, corners: Array, windows: NDArray[np.intp]) -> Array:
    """(N, 2) corners after cornerSubPix in half-windows (N,); those that would move too far stay,
    and those whose window is too small."""
    better = corners.copy()
    for window in np.unique(windows[windows >= _SMALLEST_WINDOW]):
        members = np.flatnonzero(windows == window)
        half = (int(window), int(window))
        start = corners[members].astype(np.float32).reshape(-1, 1, 2)
        moved = cv2.cornerSubPix(grey, start.copy(), half, (-1, -1), _REFINE_CRITERIA)
        moved = np.asarray(moved, dtype=np.float64).reshape(-1, 2)
        near = np.linalg.norm(moved - corners[members], axis=1) <= _FARTHEST_PX
        better[members] = np.where(near[:, None], moved, corners[members])
    return better


@lru_cache(maxsize=64)
def _smoother(board: Board, ids: bytes) -> Array:
    """(N, N) matrix that predicts corners from their neighbours.

    Row n holds the weights of a quadratic fit around corner n, without itself, at its place (a
    quadratic over five squares: perspective and a lens's distortion bend them hardly more). Zero
    for corners with too few neighbours. The same corners come in many frames, hence the cache.
    """
    numbers = np.frombuffer(ids, dtype=np.intp)
    lattice, flat = board.lattice[numbers], board.of_kind.points(board)[numbers] / board.square
    ring = np.abs(lattice - lattice[:, None]).max(axis=2)
    d = np.round(flat - flat[:, None], 9)
    near = (ring > 0) & (ring <= _REACH)
    x, y = d[..., 0], d[..., 1]
    A = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2) * near[..., None]
    normal = np.einsum("kni,knj->kij", A, A)
    values = np.linalg.eigvalsh(normal)
    fits = (near.sum(axis=1) >= _FEWEST_NEIGHBOURS) & (values[:, 0] > 1e-6 * values[:, -1])
    weights = np.zeros(ring.shape)
    if fits.any():
        # The fit's value at the corner itself is its first coefficient.
        weights[fits] = np.einsum("kj,knj->kn", np.linalg.inv(normal[fits])[:, 0], A[fits])
    return weights


def edge_sharpness(grey: Grey, corners: Array, squares: Array) -> float:
    """Contrast of the board's edges per pixel, 0 ... 1.

    The steepest grey step per pixel around a corner over the contrast there: 1 for a step within
    one pixel, 1/w for one over w pixels. Median over the corners, of many every second or third.
    """
    height, width = grey.shape
    every = max(1, -(-len(corners) // _ENOUGH))
    corners, squares = corners[::every], squares[::every]
    halves = np.clip(0.3 * squares, 3, 20).astype(np.intp)
    column, row = np.rint(corners).astype(np.intp).T
    inside = (column >= halves) & (column < width - halves)
    inside &= (row >= halves) & (row < height - halves)
    values: list[NDArray[np.float64]] = []
    for half in np.unique(halves[inside]):
        members = inside & (halves == half)
        around = np.arange(-half, half + 1)
        patches = grey[
            row[members, None, None] + around[:, None], column[members, None, None] + around
        ].astype(np.int16)
        contrast = patches.max(axis=(1, 2)) - patches.min(axis=(1, 2))
        steps = np.maximum(
            np.abs(np.diff(patches, axis=2)).max(axis=(1, 2)),
            np.abs(np.diff(patches, axis=1)).max(axis=(1, 2)),
        )
        values.append(steps[contrast > 0] / contrast[contrast > 0])
    all_values = np.concatenate(values) if values else np.zeros(0)
    return float(np.median(all_values)) if all_values.size else 0.0

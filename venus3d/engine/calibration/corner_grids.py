"""Grids of points in an image: evenness, a checkerboard's colours, ways to read them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_reader import Grey, Read
from venus3d.engine.geometry.pose import Array

_UNEVEN = 0.5
"""Largest change of a step from one corner to the next, as a share of it: less in a fisheye."""
_FEWEST = 3
"""Corners along a side that are left."""
_GOES_ON = 0.75
"""Share of the squares beyond a line of corners that are of the other colour than those within; of
a margin half are."""
_LEAST_CONTRAST = 10.0
"""Grey levels between neighbouring squares."""


def is_even(corners: Array) -> bool:
    """Whether corners (R, C, 2) are about evenly spaced along both directions."""
    for along in (corners, corners.transpose(1, 0, 2)):
        steps = np.diff(along, axis=1)
        uneven = np.linalg.norm(np.diff(steps, axis=1), axis=2)
        if (uneven > _UNEVEN * np.linalg.norm(steps[:, 1:], axis=2)).any():
            return False
    return True


def without_outline(grey: Grey, corners: Array) -> Array:
    """Corners (R, C, 2) of a checkerboard without lines of them that run along its outer edge: a
    search for any size takes those of the outermost squares as well, and OpenCV finds them at
    times. Beyond a true line the colours go on alternating, beyond these all is margin."""
    for _ in range(4):  # each side once, and back as it was
        if corners.shape[1] > _FEWEST and not _goes_on(grey, corners):
            corners = corners[:, 1:]
        corners = np.rot90(corners)
    return corners


def _goes_on(grey: Grey, corners: Array) -> bool:
    """Whether the colours alternate beyond the first column of corners (R, C, 2), too; also where
    the image ends before."""
    middles = (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]) / 4
    first, second = middles[:, 0], middles[:, 1]
    places = np.stack([2 * first - second, first, second])
    x, y = np.rint(places).astype(int).transpose(2, 0, 1)
    if (x < 0).any() or (y < 0).any() or (x >= grey.shape[1]).any() or (y >= grey.shape[0]).any():
        return True
    beyond, within, next_one = grey[y, x].astype(np.float64)
    step = within - next_one
    return bool(np.mean((within - beyond) * np.sign(step) > 0.5 * np.abs(step)) > _GOES_ON)


def contrast_of(grey: Grey, corners: Array) -> float:
    """By how much the second square of a row is lighter than the first one, between corners
    (R, C, 2), grey levels; 0 unless the squares' colours alternate all over the grid."""
    middles = (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]) / 4
    height, width = grey.shape
    x, y = np.rint(middles).astype(int).transpose(2, 0, 1)
    if (x < 1).any() or (y < 1).any() or (x >= width - 1).any() or (y >= height - 1).any():
        return 0.0
    around = [grey[y + j, x + i].astype(np.float64) for j in (-1, 0, 1) for i in (-1, 0, 1)]
    tones = np.mean(around, axis=0)
    rows, columns = tones.shape
    sign = 1 - 2 * (np.indices((rows, columns)).sum(axis=0) % 2)
    across = sign[:, :-1] * np.diff(tones, axis=1)
    down = sign[:-1] * np.diff(tones, axis=0)
    steps = np.concatenate([across.ravel(), down.ravel()])
    lightest = float(np.median(steps))
    if abs(lightest) < _LEAST_CONTRAST or (np.sign(lightest) * steps <= 0).any():
        return 0.0
    return lightest


def turned(corners: Array) -> list[Array]:
    """The ways to number corners (R, C, 2) as seen from the front: two, of a square board four."""
    right, down = corners[0, 1] - corners[0, 0], corners[1, 0] - corners[0, 0]
    if right[0] * down[1] - right[1] * down[0] < 0:
        corners = corners[:, ::-1]
    square = corners.shape[0] == corners.shape[1]
    return [np.rot90(corners, k) for k in ((0, 1, 2, 3) if square else (0, 2))]


def numbered(grid: Array) -> Read:
    """The points (R, C, 2) row by row, with their ids."""
    ids: NDArray[np.intp] = np.arange(grid.shape[0] * grid.shape[1], dtype=np.intp)
    return ids, grid.reshape(-1, 2)


def row_direction(grid: Array) -> Array:
    """(2,) the rows' direction in the image, a unit vector."""
    along = (grid[:, -1] - grid[:, 0]).sum(axis=0)
    return along / max(float(np.linalg.norm(along)), 1e-9)

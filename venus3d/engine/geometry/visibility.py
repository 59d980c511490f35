"""A board's outline under many poses: distances, pixels, sizes of squares.
Poses are the last axis: minima and maxima of few points are fast along the first axis only."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, rotations_of


@dataclass(frozen=True, eq=False)
class Visibility:
    """16 points of a board (corners, mid-edges, squares) as a camera sees them under N poses."""

    R: Array
    """(3, 3, N) rotations, `T_camera_board`."""
    cosine: Array
    """(N,) of the tilt, between the board's normal and the line of sight to its centre."""
    depth: Array
    """(16, N) along the optical axis, metres."""
    near: Array
    """(N,) distance of the board's nearest corner from the lens, metres."""
    closest: Array
    """(N,) of its nearest point, if the lens is wide, which may see the corners of a board whose
    middle nearly touches it; else as `near`."""
    far: Array
    """(N,) distance of the farthest, metres."""
    pixels: Array
    """(2, 16, N); meaningless where the board is not `seen`."""
    low: Array
    """(2, N) smallest x and y of the pixels."""
    high: Array
    """(2, N) largest x and y of the pixels."""
    side: Array
    """(N,) the shortest side of the squares in the board's corners, pixels."""
    seen: NDArray[np.bool_]
    """(N,) whether all of the board is in front of the lens and within the lens model's reach."""

    def of(self, chosen: NDArray[np.intp]) -> Visibility:
        """A subset of the poses, by their indices (K,)."""
        return Visibility(*(getattr(self, field.name).take(chosen, -1) for field in fields(self)))


def visibility_of(camera: Camera, board: Board, vectors: Array) -> Visibility:
    """The board under pose vectors (N, 6)."""
    t = np.ascontiguousarray(vectors[:, 3:].T)
    R = np.ascontiguousarray(rotations_of(vectors).transpose(1, 2, 0))
    across, down = _probe(board)
    points = R[:, 0, None] * across + R[:, 1, None] * down + t[:, None]
    corners = points[:, :4]
    # A search may try absurd distances; what overflows is beyond every limit.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        squares = np.sum(corners * corners, axis=0)
        cosine = np.sum(R[:, 2] * t, axis=0) / np.sqrt(np.sum(t * t, axis=0))
        pixels = camera.pixels_of(points)
        seen = np.asarray(camera.reaches(points).all(axis=0))
        # For each of the four corners, the square's neighbours along x and y.
        sides = pixels[:, 4:12].reshape(2, 2, 4, -1) - pixels[:, None, :4]
        side = np.sqrt(np.min(np.sum(sides * sides, axis=0), axis=(0, 1)))
    near = np.sqrt(squares.min(axis=0))
    return Visibility(
        R=R,
        cosine=cosine,
        depth=points[2],
        near=near,
        closest=near if camera.lens.is_perspective else _closest(board, R, t),
        far=np.sqrt(squares.max(axis=0)),
        pixels=pixels,
        low=pixels.min(axis=1),
        high=pixels.max(axis=1),
        side=side,
        seen=seen,
    )


def _closest(board: Board, R: Array, t: Array) -> Array:
    """(N,) distance of the board's nearest point: the foot of the lens's perpendicular on its
    plane, or where the outline is nearest to that."""
    half = np.array([board.width, board.height]) / 2
    with np.errstate(over="ignore", invalid="ignore"):
        x, y = (np.clip(-np.sum(R[:, k] * t, axis=0), -half[k], half[k]) for k in (0, 1))
        return np.asarray(np.linalg.norm(R[:, 0] * x + R[:, 1] * y + t, axis=0))


@lru_cache(maxsize=8)
def _probe(board: Board) -> Array:
    """(2, 16, 1) x and y of the board points that decide, metres. The outline, its neighbours a
    square along x and y, and the mid-edges, as distortion bows a straight edge outwards."""
    outline = board.outline[:, :2]
    inward = -np.sign(outline) * board.square
    middles = (outline + np.roll(outline, -1, axis=0)) / 2
    x_next, y_next = outline + inward * [1, 0], outline + inward * [0, 1]
    points = np.concatenate([outline, x_next, y_next, middles])
    return np.ascontiguousarray(points.T)[:, :, None]

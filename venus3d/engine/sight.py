"""Where the decisive points of a board are under many poses: distances, pixels, sizes of squares.

What is allowed of them is said by `limits`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.pose import Array, rotations_of


@dataclass(frozen=True, eq=False)
class Sight:
    """A board under N poses, as a camera sees 16 points of it: its corners, mid-edges, squares."""

    R: Array
    """(N, 3, 3) rotations, `T_camera_board`."""
    cosine: Array
    """(N,) of the tilt: between the board's normal and the line of sight to its centre."""
    depth: Array
    """(N, 16) along the optical axis, metres."""
    near: Array
    """(N,) the board's corner nearest to the lens, metres."""
    far: Array
    """(N,) and the farthest."""
    pixels: Array
    """(N, 2, 16); nonsense where a point is not `seen`."""
    low: Array
    """(N, 2) smallest x and y of the pixels."""
    high: Array
    """(N, 2) largest x and y of the pixels."""
    side: Array
    """(N,) the shortest side of the squares in the board's corners, pixels."""
    seen: Array
    """(N,) bool: all of the board is in front of the lens and within the model's radius."""

    def of(self, chosen: NDArray[np.bool_]) -> Sight:
        """Of some of the poses, by a mask (N,)."""
        return Sight(*(getattr(self, field.name)[chosen] for field in fields(self)))


def sight_of(camera: Camera, board: Board, vectors: Array) -> Sight:
    """The board under pose vectors (N, 6)."""
    R, t = rotations_of(vectors), vectors[:, 3:]
    points = R[:, :, :2] @ _probe(board) + t[:, :, None]
    corners = points[:, :, :4]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        squares = np.sum(corners * corners, axis=1)
        cosine = np.einsum("ni,ni->n", R[:, :, 2], t) / np.sqrt(np.einsum("ni,ni->n", t, t))
        xy = points[:, :2] / points[:, 2:]
        pixels = camera.distorted_pixels(xy)
        seen = points[:, 2].min(axis=1) > 0
        if np.isfinite(camera.radius_limit):
            seen &= np.sum(xy * xy, axis=1).max(axis=1) < camera.radius_limit**2
        # A square's neighbour along x, and the one along y, of each of the four corners.
        across = pixels[:, :, 4:12].reshape(-1, 2, 2, 4) - pixels[:, :, None, :4]
        side = np.sqrt(np.min(np.sum(across * across, axis=1), axis=(1, 2)))
    return Sight(
        R=R,
        cosine=cosine,
        depth=points[:, 2],
        near=np.sqrt(squares.min(axis=1)),
        far=np.sqrt(squares.max(axis=1)),
        pixels=pixels,
        low=pixels.min(axis=2),
        high=pixels.max(axis=2),
        side=side,
        seen=seen,
    )


@lru_cache(maxsize=8)
def _probe(board: Board) -> Array:
    """(2, 16) board points that decide: outline, its neighbours a square along x and y, mid-edges.

    The mid-edges are there because distortion bows a straight edge outwards.
    """
    outline = board.outline[:, :2]
    inward = -np.sign(outline) * board.square
    middles = (outline + np.roll(outline, -1, axis=0)) / 2
    x_next, y_next = outline + inward * [1, 0], outline + inward * [0, 1]
    return np.ascontiguousarray(np.concatenate([outline, x_next, y_next, middles]).T)

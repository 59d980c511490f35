"""How well lit the board is in a picture: its black, its white, and where glare washes it out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.refinement import local_scales
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

_NEAR = np.linspace(-0.3, 0.3, 9)
_GRID = np.stack(np.meshgrid(_NEAR, _NEAR), axis=-1).reshape(-1, 2)
"""(81, 2) where a corner's surroundings are looked at, in squares."""
_QUADRANTS = np.array(
    [(np.sign(_GRID) == side).all(axis=1) for side in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
) & (np.abs(_GRID).min(axis=1) > 0.07)
_PARTS = np.vstack([_QUADRANTS, np.abs(_GRID).max(axis=1) < 0.1])
"""(5, 81) which of these lie well within each of a corner's four squares, and within a disc."""
_OF_RADIUS = 5.3
"""`_GRID`'s unit in radii of a disc, so that the grid reaches 1.6 of them from its centre."""
_TEXTURE_PX = 20
_BENT = 0.1
"""Of a square: how far corners may be from a homography's before it predicts none."""
WASHED_OUT = 0.4
"""Black that is brighter than this share of the way from the board's black to its white is washed
out. On photographs without glare it is at most 0.34, where a gloss is seen up to 0.6."""

LEAST_SHARPNESS = 0.24
"""In pictures up to 1280 px wide (docs/operations.md)."""
_SHARP_WIDTH = 1280


@dataclass(frozen=True)
class PictureQuality:
    """The board's light in one picture, in grey values 0 ... 255."""

    black: float
    """Grey value of its black, the median over the corners that were found."""
    white: float
    """The same of its white."""
    washed_out: float
    """0 ... 1: share of the board's corners in the picture whose black is washed out."""

    @property
    def contrast(self) -> float:
        """White minus black."""
        return self.white - self.black


def picture_quality(
    image: NDArray[np.uint8], board: Board, seen: Observation
) -> PictureQuality | None:
    """The light on the board seen in `image` (H, W[, 3]); None where that cannot be told.

    A corner's black is the brighter of the two plain black squares there, its white the brightest
    tenth around it. Glare hides corners from the detection, so those that were not found are looked
    at as well, where a homography has them.
    """
    if seen.count < 4:
        return None
    homography, _ = cv2.findHomography(board.points_of(seen.ids)[:, :2], seen.corners)
    if homography is None:
        return None
    inside, blacks, whites = _tones(image, board, seen, homography)
    found = np.isin(inside, seen.ids)
    if not found.any():
        return None
    black, white = float(np.median(blacks[found])), float(np.median(whites[found]))
    washed_out = blacks > black + WASHED_OUT * (white - black)
    return PictureQuality(black, white, float(washed_out.mean()))


def _tones(
    image: NDArray[np.uint8], board: Board, seen: Observation, homography: Any
) -> tuple[NDArray[np.intp], Array, Array]:
    """(K,) ids of the corners in the picture, (K,) their black, (K,) their white."""
    flat = board.corners[:, :2]
    around = flat[:, None] + _reach(board) * _GRID
    flat_px = cv2.perspectiveTransform(flat[None], homography)[0]
    at = cv2.perspectiveTransform(around.reshape(1, -1, 2), homography).reshape(around.shape)
    # The homography knows no distortion; where a corner was found, its surroundings go with it.
    at[seen.ids] += (seen.corners - flat_px[seen.ids])[:, None]
    is_bent = _is_bent(board, seen, flat_px[seen.ids])
    if is_bent:  # nor does it know how large they are
        scales = local_scales(board, seen.ids, seen.corners).swapaxes(1, 2)
        at[seen.ids] = seen.corners[:, None] + _reach(board) * _GRID @ scales
    at = np.rint(at).astype(int)
    height, width = image.shape[:2]
    inside = ((at >= 0) & (at < [width, height])).all(axis=(1, 2))
    if is_bent:
        inside &= np.isin(np.arange(len(flat)), seen.ids)
    pixels = image[at[inside][..., 1], at[inside][..., 0]].astype(np.float64)
    if pixels.ndim == 3:
        pixels = pixels @ [0.114, 0.587, 0.299]
    pixels /= 257.0 if image.dtype == np.uint16 else 1.0
    parts = pixels @ (_PARTS / _PARTS.sum(axis=1, keepdims=True)).T
    blacks = np.where(_plain_black(board)[inside], parts, -np.inf).max(axis=1)
    return np.flatnonzero(inside), blacks, np.percentile(pixels, 90, axis=1)


def _is_bent(board: Board, seen: Observation, flat_px: Array) -> bool:
    """Whether a wide lens bends the board so much that no homography tells where the corners are
    that were not found; `flat_px` (N, 2): where it has those that were."""
    points = board.points_of(seen.ids)
    apart_px, apart = (np.linalg.norm(p[:, None] - p, axis=2) for p in (seen.corners, points))
    square_px = board.square * float(np.median(apart_px[apart > 0] / apart[apart > 0]))
    off = np.linalg.norm(seen.corners - flat_px, axis=1)
    return bool(np.sqrt((off**2).mean()) > _BENT * square_px)


def _reach(board: Board) -> float:
    """`_GRID`'s unit on a board, metres."""
    radius = board.of_kind.radius(board)
    return _OF_RADIUS * radius if radius > 0 else board.square


@lru_cache(maxsize=4)
def _plain_black(board: Board) -> NDArray[np.bool_]:
    """(N, 5) which of the parts around each point are printed plain black."""
    texture = board.texture(_TEXTURE_PX)
    origin = np.array([board.width, board.height]) / 2
    around = (board.corners[:, None, :2] + _reach(board) * _GRID + origin) / board.square
    last = np.array(texture.shape[::-1]) - 1
    at = np.clip(np.floor(around * _TEXTURE_PX).astype(int), 0, last)
    printed = texture[at[..., 1], at[..., 0]] < 128
    return np.asarray((printed[:, None] | ~_PARTS).all(axis=2), dtype=np.bool_)


def least_sharpness(width: int) -> float:
    """The sharpness (`Observation.sharpness`) that pictures of this width need: in wider ones the
    same blur as a share of the picture."""
    return LEAST_SHARPNESS * min(1.0, _SHARP_WIDTH / width)

"""How large a board's squares are in the pictures, and whether that is enough to read it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.calibration.refinement import local_scales
from venus3d.engine.geometry.board import Board


def legible_square_px(board: Board) -> float:
    """The least side of a square in the picture for the board to be read, pixels."""
    return board.of_kind.legible_square_px(board)


def square_px(board: Board, seen: Observation) -> float:
    """The narrow side of an observation's squares, pixels: the median over its corners."""
    scales = local_scales(board, seen.ids, seen.corners)
    return float(np.median(np.linalg.norm(scales, axis=1).min(axis=1)) * board.square)


def squares_px(board: Board, observations: Sequence[Observation]) -> list[float]:
    """`square_px` of the observations that determine one."""
    fixed = [o for o in observations if determines_homography(board.points_of(o.ids))]
    return [square_px(board, seen) for seen in fixed]


def too_small_px(board: Board, observations: Sequence[Observation]) -> float | None:
    """The median side of a square, if it is too small to be read reliably: corners are then few
    and wrong by tenths of a pixel, which other lenses and crops explain better than the truth."""
    found = squares_px(board, observations)
    middle = float(np.median(found)) if found else float("inf")
    return middle if middle < legible_square_px(board) else None

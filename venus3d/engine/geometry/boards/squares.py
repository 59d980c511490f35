"""Boards of squares: a checkerboard, with markers in its white squares or without."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.boards.kind import BoardKind, row_major
from venus3d.engine.geometry.pose import Array

if TYPE_CHECKING:
    from venus3d.engine.geometry.board import Board


class SquareBoard(BoardKind):
    """Inner corners, where four squares meet, numbered row by row from the top left."""

    unit = "squares"

    def size(self, board: Board) -> tuple[float, float]:
        """All squares."""
        return board.columns * board.square, board.rows * board.square

    def lattice(self, board: Board) -> NDArray[np.intp]:
        """Row by row."""
        return row_major(board.columns - 1, board.rows - 1)

    def points(self, board: Board) -> Array:
        """The inner corners."""
        x = (np.arange(1, board.columns) - board.columns / 2) * board.square
        y = (np.arange(1, board.rows) - board.rows / 2) * board.square
        return np.stack([np.tile(x, y.size), np.repeat(y, x.size)], axis=1).astype(np.float64)

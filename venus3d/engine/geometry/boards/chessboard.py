"""The checkerboard: black and white squares and nothing else, read only as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.boards.drawing import BoardDrawing
from venus3d.engine.geometry.boards.squares import SquareBoard

if TYPE_CHECKING:
    from venus3d.engine.geometry.board import Board

_FEWEST_SQUARES = 4
"""`cv2.findChessboardCornersSB` needs three corners along each side."""
_CLEARANCE = 0.4
_LEGIBLE_PX = 10.0
"""Sides of a square from which it is found in the simulated camera's noise and blur."""


class Chessboard(SquareBoard):
    """The square in the top left corner is black."""

    name = "checkerboard"
    fields = ()
    partial = False

    def quarter_turns(self, board: Board) -> tuple[int, ...]:
        """Those that put black on black: all of a square board with an odd number of rows."""
        if board.columns == board.rows and board.rows % 2:
            return (1, 2, 3)
        return () if (board.columns + board.rows) % 2 else (2,)

    def check(self, board: Board) -> None:
        """Raises `BoardError` if the squares are too few."""
        if board.columns < _FEWEST_SQUARES or board.rows < _FEWEST_SQUARES:
            raise BoardError(
                f"A checkerboard of {board.columns} x {board.rows} squares is too small to be "
                "found; use at least 4 columns and 4 rows. Squares are counted, not inner corners: "
                "9 x 6 corners are 10 x 7 squares."
            )

    def clearance(self, board: Board) -> float:
        """Less than half of a square, where the edges of the next corner begin to count."""
        return _CLEARANCE * board.square

    def legible_square_px(self, board: Board) -> float:
        """Plain squares are seen when they are small."""
        return _LEGIBLE_PX

    def drawing(self, board: Board) -> BoardDrawing:
        """The black squares."""
        row, column = np.nonzero(np.indices((board.rows, board.columns)).sum(axis=0) % 2 == 0)
        places = np.stack([column, row], axis=1) * board.square - np.array(self.size(board)) / 2
        return BoardDrawing(np.hstack([places, np.full_like(places, board.square)]))

    def texture(self, board: Board, square_px: int) -> NDArray[np.uint8]:
        """(rows * square_px, columns * square_px)."""
        white = np.indices((board.rows, board.columns)).sum(axis=0) % 2
        squares = np.asarray(255 * white, dtype=np.uint8)
        return np.kron(squares, np.ones((square_px, square_px), dtype=np.uint8))

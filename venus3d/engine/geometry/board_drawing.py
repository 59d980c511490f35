"""What is printed of a board, as shapes: for true scale at any resolution."""

from __future__ import annotations

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.boards.drawing import BoardDrawing

__all__ = ["BoardDrawing", "draw_board"]


def draw_board(board: Board) -> BoardDrawing:
    """The board's dark shapes; of an inverted board those that are light."""
    return board.of_kind.drawing(board)

"""What makes a kind of board: its points, its picture, and what can be seen of it.

All that differs between a ChArUco board and a checkerboard is here and in the readers of
`calibration`; the rest of the program knows points with ids. Coordinates are metres from the
board's centre, x along the columns, y along the rows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.boards.drawing import BoardDrawing, painted
from venus3d.engine.geometry.pose import Array

if TYPE_CHECKING:
    from venus3d.engine.geometry.board import Board


class BoardKind(ABC):
    """A kind of board. Every method takes a `Board` of this kind. What is not abstract is as most
    kinds have it: corners, and none of what only markers bring along."""

    name: str
    """What it is called in a sentence."""
    unit: str
    """What `columns` and `rows` count."""
    fields: tuple[str, ...]
    """The board's fields that this kind has, besides `columns`, `rows` and `square`."""
    partial: bool
    """Whether it is read where a part of it is hidden or outside the picture."""
    stride: int = 1
    """Places of the lattice from a point to the next one along a row or a column."""

    def quarter_turns(self, board: Board) -> tuple[int, ...]:
        """After how many quarter turns in its plane, 1 to 3, the board looks as it did before: none
        where each marker is another one."""
        return ()

    @abstractmethod
    def check(self, board: Board) -> None:
        """Raises `BoardError`, with cause and cure, for fields that make no such board."""

    @abstractmethod
    def size(self, board: Board) -> tuple[float, float]:
        """Width and height of what is printed, metres."""

    @abstractmethod
    def lattice(self, board: Board) -> NDArray[np.intp]:
        """(M, 2) column and row of each point, in order of the ids."""

    @abstractmethod
    def points(self, board: Board) -> Array:
        """(M, 2) the flat board's points, in order of their ids."""

    def radius(self, board: Board) -> float:
        """Of the discs whose centres are the points; 0 for corners."""
        return 0.0

    @abstractmethod
    def clearance(self, board: Board) -> float:
        """Half the side of the square around a point in which it has no other edge than its own."""

    def by_marker(self, board: Board, points: Array) -> Array | None:
        """(..., 3) shift of points (..., 3) of the flat board by one metre more of `marker`; None
        where the markers' size moves no point."""
        return None

    @abstractmethod
    def legible_square_px(self, board: Board) -> float:
        """The least side of a square in the picture with which the board is read, pixels."""

    def marker_count(self, board: Board) -> int:
        """Number of markers; 0 for a kind without."""
        return 0

    def cv_board(self, board: Board) -> Any:
        """OpenCV's object for the board, its origin in the top left corner; None if it has none."""
        return None

    @abstractmethod
    def drawing(self, board: Board) -> BoardDrawing:
        """The dark shapes on the light ground; of an inverted board the light ones."""

    def texture(self, board: Board, square_px: int) -> NDArray[np.uint8]:
        """(height, width) grey picture of what is printed, without a margin, black on white."""
        return painted(self.drawing(board), self.size(board), square_px / board.square)


CELL_PX = 2.4
"""Pixels that a marker's cell needs on its short side. On 110 valid poses of the simulated camera
with its noise and blur, 41 % of the default board's corners are found where the smallest square is
18-21 px wide (2.1 px a cell), 73 % at 21-25 px, 96 % at 25-30 px, all above."""


def row_major(columns: int, rows: int) -> NDArray[np.intp]:
    """(columns * rows, 2) column and row, row by row."""
    across, down = np.tile(np.arange(columns), rows), np.repeat(np.arange(rows), columns)
    return np.stack([across, down], axis=1).astype(np.intp)

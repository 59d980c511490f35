"""Grids of circles: in rows and columns, or OpenCV's asymmetric grid, every second row shifted.

A board's `square` is the distance from one row to the next, and its `marker` a circle's diameter.
In the asymmetric grid the circles of a row are two squares apart, and every second row is shifted
to the right by one: the circle of column j in row i is at ((2 j + i mod 2) square, i square).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.boards.drawing import BoardDrawing
from venus3d.engine.geometry.boards.kind import BoardKind, row_major
from venus3d.engine.geometry.pose import Array

if TYPE_CHECKING:
    from venus3d.engine.geometry.board import Board

_FEWEST = 3
_LEGIBLE_PX = 12.0
"""Diameter of a circle on its short side, pixels."""


@dataclass(frozen=True)
class CircleGrid(BoardKind):
    """A grid of circles, read only as a whole."""

    name: str
    stride: int
    """Squares from one circle of a row to the next: 1, or 2 where every second row is shifted."""
    fields = ("marker", "inverted")
    partial = False
    unit = "circles"

    def quarter_turns(self, board: Board) -> tuple[int, ...]:
        """A half turn, but where the last row is shifted as the first one is; of a square grid
        all."""
        if self.stride == 2:
            return (2,) if board.rows % 2 == 0 else ()
        return (1, 2, 3) if board.columns == board.rows else (2,)

    def check(self, board: Board) -> None:
        """Raises `BoardError` if the circles are too few, or touch one another."""
        if board.columns < _FEWEST or board.rows < _FEWEST:
            raise BoardError(
                f"A grid of {board.columns} x {board.rows} circles is too small to be found; use "
                "at least 3 columns and 3 rows."
            )
        if board.marker >= self._nearest(board):
            raise BoardError(
                f"Circles of {board.marker * 1000:g} mm touch one another where the rows are "
                f"{board.square * 1000:g} mm apart; are the two swapped?"
            )

    def _nearest(self, board: Board) -> float:
        """From one circle's centre to the nearest other one."""
        return board.square * (1.0 if self.stride == 1 else float(np.sqrt(2)))

    def size(self, board: Board) -> tuple[float, float]:
        """The circles, and around their centres half a square or their radius."""
        across, down = self.lattice(board).max(axis=0) * board.square
        beside = max(board.square, board.marker)
        return float(across) + beside, float(down) + beside

    def lattice(self, board: Board) -> NDArray[np.intp]:
        """Row by row; a row's circles are `stride` places apart."""
        places = row_major(board.columns, board.rows)
        if self.stride == 2:
            places[:, 0] = 2 * places[:, 0] + places[:, 1] % 2
        return places

    def points(self, board: Board) -> Array:
        """The circles' centres."""
        places = self.lattice(board)
        return (places - places.max(axis=0) / 2) * board.square

    def radius(self, board: Board) -> float:
        """Of the circles."""
        return board.marker / 2

    def clearance(self, board: Board) -> float:
        """Half of the way to the nearest circle's centre."""
        return self._nearest(board) / 2

    def legible_square_px(self, board: Board) -> float:
        """By the circles' diameter."""
        return _LEGIBLE_PX * board.square / board.marker

    def drawing(self, board: Board) -> BoardDrawing:
        """The circles."""
        points = self.points(board)
        return BoardDrawing(
            discs=np.column_stack([points, np.full(len(points), self.radius(board))])
        )


CIRCLES = CircleGrid("grid of circles", stride=1)
ASYMMETRIC_CIRCLES = CircleGrid("asymmetric grid of circles", stride=2)

"""The ChArUco board: a checkerboard with markers in its white squares, read from any part."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.boards.drawing import BoardDrawing, marker_cells
from venus3d.engine.geometry.boards.kind import CELL_PX
from venus3d.engine.geometry.boards.squares import SquareBoard

if TYPE_CHECKING:
    from venus3d.engine.geometry.board import Board


class Charuco(SquareBoard):
    """Its markers tell the corners apart."""

    name = "ChArUco"
    fields = ("marker", "dictionary", "legacy", "inverted", "first_id")
    partial = True

    def check(self, board: Board) -> None:
        """Raises `BoardError` if the squares are too few or the markers do not fit them."""
        if board.columns < 3 or board.rows < 3:
            raise BoardError(
                f"A board of {board.columns} x {board.rows} squares has too few inner corners to "
                "calibrate with; use at least 3 columns and 3 rows."
            )
        if board.marker >= board.square:
            raise BoardError(
                f"The marker ({board.marker * 1000:g} mm) must be smaller than the square "
                f"({board.square * 1000:g} mm); are the two swapped?"
            )

    def clearance(self, board: Board) -> float:
        """Up to the markers."""
        return (board.square - board.marker) / 2

    def legible_square_px(self, board: Board) -> float:
        """A marker has its dictionary's cells and a border of one cell around them."""
        cells = int(board.cv_dictionary.markerSize) + 2
        return CELL_PX * cells * board.square / board.marker

    def marker_count(self, board: Board) -> int:
        """On every second square."""
        return board.columns * board.rows // 2

    def cv_board(self, board: Board) -> Any:
        """OpenCV's `CharucoBoard`."""
        made = cv2.aruco.CharucoBoard(
            (board.columns, board.rows), board.square, board.marker, board.cv_dictionary
        )
        made.setLegacyPattern(board.legacy)
        return made

    def drawing(self, board: Board) -> BoardDrawing:
        """The markers' dark cells, and the black squares."""
        squares = {(column, row) for column in range(board.columns) for row in range(board.rows)}
        found: list[tuple[float, float, float, float]] = []
        for number, corners in enumerate(np.asarray(board.cv_board.getObjPoints())):
            left, top = corners[:, :2].min(axis=0)
            column, row = ((corners[:, :2].mean(axis=0)) / board.square).astype(int)
            squares.remove((int(column), int(row)))
            found += marker_cells(
                board.cv_dictionary, number, float(left), float(top), board.marker
            )
        size = board.square
        found += [(column * size, row * size, size, size) for column, row in sorted(squares)]
        rectangles = np.array(found)
        rectangles[:, :2] -= np.array(self.size(board)) / 2
        return BoardDrawing(rectangles)

    def texture(self, board: Board, square_px: int) -> NDArray[np.uint8]:
        """Drawn by OpenCV: (rows * square_px, columns * square_px)."""
        size = (board.columns * square_px, board.rows * square_px)
        return np.asarray(board.cv_board.generateImage(size, marginSize=0), dtype=np.uint8)

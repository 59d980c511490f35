"""Grids of square tags side by side: Kalibr's AprilGrid, and OpenCV's grid of ArUco markers.

A board's `square` is the cell of one tag: the tag and the gap to the next one. A tag's four corners
are points, numbered as OpenCV gives them: 4 n + k for corner k of the board's tag n.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.boards.drawing import BoardDrawing, marker_cells
from venus3d.engine.geometry.boards.kind import CELL_PX, BoardKind, row_major
from venus3d.engine.geometry.pose import Array

if TYPE_CHECKING:
    from venus3d.engine.geometry.board import Board

_JOINED_CELL_PX = 2.7
"""Pixels that a tag's cell needs where black squares touch the tag's corners: below, its outline
runs into them. On 60 renders through three lenses, with noise and blur, 25 % of the AprilGrid's
tags are found where the distance from one to the next is 21-24 px on its short side, 62 % at
27-30 px, 82 % at 33-36 px, 92 % at 39-42 px, 99 % above 45 px."""
_CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
"""Column and row of a tag's corners, clockwise from its top left."""


@dataclass(frozen=True)
class TagGrid(BoardKind):
    """A grid of tags, read from any part of it."""

    name: str
    border: int
    """Width of the tags' black border, in cells."""
    joints: bool
    """Whether there are black squares between the tags' corners, and tag 0 is the lower left one,
    upside down by OpenCV's reckoning: Kalibr's layout (`kalibr_create_target_pdf`)."""
    fields = ("marker", "dictionary", "first_id")
    partial = True
    unit = "tags"

    def check(self, board: Board) -> None:
        """Raises `BoardError` if the tags are too few, or larger than their cells."""
        if board.columns * board.rows < 4 or min(board.columns, board.rows) < 1:
            raise BoardError(
                f"A grid of {board.columns} x {board.rows} tags is too small to calibrate with; "
                "use at least 2 columns and 2 rows."
            )
        if board.marker >= board.square:
            raise BoardError(
                f"The tag ({board.marker * 1000:g} mm) must be smaller than the distance from one "
                f"to the next ({board.square * 1000:g} mm); are the two swapped?"
            )

    def size(self, board: Board) -> tuple[float, float]:
        """From the first tag's edge to the last one's, with the joints around them."""
        gap = board.square - board.marker
        beside = gap if self.joints else -gap
        return board.columns * board.square + beside, board.rows * board.square + beside

    def lattice(self, board: Board) -> NDArray[np.intp]:
        """Two columns and two rows of corners a tag."""
        places = 2 * self._places(board)[:, None] + self._corners()
        return places.reshape(-1, 2).astype(np.intp)

    def points(self, board: Board) -> Array:
        """The tags' corners."""
        middle = np.array([board.columns - 1, board.rows - 1]) / 2
        centres = (self._places(board) - middle) * board.square
        corners = (self._corners() - 0.5) * board.marker
        return (centres[:, None] + corners).reshape(-1, 2).astype(np.float64)

    def _places(self, board: Board) -> NDArray[np.intp]:
        """(N, 2) column and row of each tag, from the top left."""
        places = row_major(board.columns, board.rows)
        if self.joints:
            places[:, 1] = board.rows - 1 - places[:, 1]
        return places

    def _corners(self) -> NDArray[np.intp]:
        return (np.roll(_CORNERS, 2, axis=0) if self.joints else _CORNERS).astype(np.intp)

    def by_marker(self, board: Board, points: Array) -> Array:
        """Away from the middle of the nearest tag."""
        last = np.array([board.columns, board.rows]) - 1
        place = np.clip(np.rint(points[..., :2] / board.square + last / 2), 0, last)
        shift = np.zeros(points.shape)
        shift[..., :2] = (points[..., :2] - (place - last / 2) * board.square) / board.marker
        return shift

    def clearance(self, board: Board) -> float:
        """Up to the tag's cells inside, and to the next tag outside."""
        cell = board.marker / self._cells(board)
        return min(self.border * cell, board.square - board.marker)

    def _cells(self, board: Board) -> int:
        return int(board.cv_dictionary.markerSize) + 2 * self.border

    def legible_square_px(self, board: Board) -> float:
        """By the pixels of a tag's cell."""
        cell_px = _JOINED_CELL_PX if self.joints else CELL_PX
        return cell_px * self._cells(board) * board.square / board.marker

    def marker_count(self, board: Board) -> int:
        """One in each cell."""
        return board.columns * board.rows

    def cv_board(self, board: Board) -> Any:
        """OpenCV's `Board`."""
        flat = self.points(board) + np.array(self.size(board)) / 2
        points = np.column_stack([flat, np.zeros(len(flat))]).reshape(-1, 4, 3).astype(np.float32)
        return cv2.aruco.Board(
            list(points), board.cv_dictionary, np.arange(len(points), dtype=np.int32)
        )

    def drawing(self, board: Board) -> BoardDrawing:
        """The tags' dark cells, and the joints."""
        corners, gap = self.points(board).reshape(-1, 4, 2), board.square - board.marker
        found: list[tuple[float, float, float, float]] = []
        for number, (left, top) in enumerate(corners.min(axis=1)):
            cells = marker_cells(
                board.cv_dictionary, number, 0.0, 0.0, board.marker, border=self.border
            )
            if self.joints:  # upside down
                cells = [(board.marker - x - w, board.marker - y - h, w, h) for x, y, w, h in cells]
            found += [(float(left) + x, float(top) + y, w, h) for x, y, w, h in cells]
        if self.joints:
            middle = np.array([board.columns, board.rows]) / 2
            places = row_major(board.columns + 1, board.rows + 1) - middle
            found += [
                (float(x) - gap / 2, float(y) - gap / 2, gap, gap) for x, y in places * board.square
            ]
        return BoardDrawing(np.array(found))


APRILGRID = TagGrid("AprilGrid", border=2, joints=True)
ARUCO_GRID = TagGrid("grid of markers", border=1, joints=False)

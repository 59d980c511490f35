"""What is printed of a board, as shapes: for true scale at any resolution."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array


@dataclass(frozen=True, eq=False)
class BoardDrawing:
    """Dark shapes on a light ground, none over another; in the board's frame, metres."""

    rectangles: Array
    """(N, 4) left, top, width, height."""
    discs: Array = field(default_factory=lambda: np.empty((0, 3)))
    """(N, 3) centre x, y and radius."""


def draw_board(board: Board) -> BoardDrawing:
    """The board's dark shapes; of an inverted board those that are light."""
    squares = {(column, row) for column in range(board.columns) for row in range(board.rows)}
    found: list[tuple[float, float, float, float]] = []
    layout: Any = board.cv_board
    for number, corners in enumerate(np.asarray(layout.getObjPoints())):
        left, top = corners[:, :2].min(axis=0)
        column, row = ((corners[:, :2].mean(axis=0)) / board.square).astype(int)
        squares.remove((int(column), int(row)))
        found += _marker(board.cv_dictionary, number, float(left), float(top), board.marker)
    size = board.square
    found += [(column * size, row * size, size, size) for column, row in sorted(squares)]
    rectangles = np.array(found)
    rectangles[:, :2] -= [board.width / 2, board.height / 2]
    return BoardDrawing(rectangles)


def _marker(
    dictionary: Any, number: int, left: float, top: float, side: float
) -> list[tuple[float, float, float, float]]:
    """The dark cells of a marker, those side by side as one."""
    cells = dictionary.markerSize + 2
    dark = np.asarray(dictionary.generateImageMarker(number, cells, borderBits=1)) < 128
    size = side / cells
    found: list[tuple[float, float, float, float]] = []
    for row in range(cells):
        edges = np.flatnonzero(np.diff(np.pad(dark[row].astype(np.int8), 1)))
        for begin, end in edges.reshape(-1, 2):
            found.append((left + begin * size, top + row * size, (end - begin) * size, size))
    return found

"""Notices that a board's first id is off by whole rows: what both have is read as a part of it.

Such a part differs from one of the right board by the markers beside it alone, whose ids the reader
does not know. They are looked for as long as no picture has shown the first row or the last one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_recognition import best_finding
from venus3d.engine.geometry.board import Board

Grey = NDArray[np.uint8]

_FRAMES_AT_MOST = 12
"""Pictures with the board after which another first id is only told: views of the part that is
read may have been captured."""


class ShiftedRows:
    """What pictures have shown of a board's first and last row."""

    def __init__(self) -> None:
        """Nothing seen yet."""
        self._frames = 0
        self._not_seen: frozenset[int] | None = None

    @property
    def are_possible(self) -> bool:
        """Whether the board was seen, but its first row or its last one in no picture so far."""
        return bool(self._not_seen)

    @property
    def are_looked_for(self) -> bool:
        """Whether the board may still be read with another first id."""
        return self.are_possible and self._frames < _FRAMES_AT_MOST

    def seen(self, board: Board, ids: NDArray[np.intp]) -> None:
        """The points (N,) of a picture in which the board was found."""
        self._frames += 1
        if self._not_seen is None or self._not_seen:
            missing = rows_missing(board, ids)
            self._not_seen = missing if self._not_seen is None else self._not_seen & missing


def rows_missing(board: Board, ids: NDArray[np.intp]) -> frozenset[int]:
    """Which of the first and the last row, by their places, a picture's points (N,) lack; none of a
    board without markers."""
    if not board.has("dictionary"):
        return frozenset()
    rows = board.lattice[:, 1]
    return frozenset({int(rows.min()), int(rows.max())} - set(rows[ids].tolist()))


def shifted_board(board: Board, grey: Grey) -> Board | None:
    """The board as an image (H, W) shows it, with all rows and columns, if its ids begin some rows
    before or after the ones asked for; 25 ms at 720p. A board of other ids is another one."""
    finding = best_finding(board, [grey], plain=False)
    other = None if finding is None else finding.board
    if other is None or not 0 < abs(other.first_id - board.first_id) < board.marker_count:
        return None
    return other

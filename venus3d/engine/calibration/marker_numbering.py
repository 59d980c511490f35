"""How the markers of a board are numbered, from how they lie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.marker_lattice import Lattice
from venus3d.engine.geometry.board import Board

_MOST_COLUMNS = 40
IN_PLACE = 0.8
"""Share of the markers that must be where a layout has them; one may be misread."""


@dataclass(frozen=True)
class Numbering:
    """How the markers of a board are numbered."""

    columns: tuple[int, ...]
    """The numbers of columns that fit."""
    whole: bool
    """Whether all columns are in the picture."""
    rows: int
    """Number of rows seen."""
    first_id: int
    """Of the row seen that the numbers begin with, the topmost unless they count from below; right
    if `whole`."""


def numbering_of(lattice: Lattice) -> Numbering:
    """Markers are numbered row by row on every second square: id = first + ⌊(n row + column) / 2⌋
    for n columns, in either layout."""
    column, row = lattice.places[:, 0], lattice.places[:, 1]
    fitting: list[int] = []
    for n in range(max(3, lattice.columns), _MOST_COLUMNS + 1):
        doubled = 2 * lattice.ids - n * row - column  # twice the first id, or one less
        values, counts = np.unique(doubled, return_counts=True)
        pairs = counts + np.where(np.isin(values + 1, values), np.append(counts[1:], 0), 0)
        if pairs.max() >= IN_PLACE * lattice.ids.size:
            fitting.append(n)
    whole = len(fitting) >= 1 and fitting[0] == lattice.columns
    n = fitting[0] if fitting else 0
    firsts, counts = np.unique(lattice.ids - (n * row + column) // 2, return_counts=True)
    first = int(firsts[counts.argmax()])
    return Numbering(tuple(fitting), whole, lattice.rows, first)


def tag_numbering_of(lattice: Lattice, from_below: bool) -> Numbering:
    """Tags side by side are numbered row by row: id = first + n row + column for n columns.

    Args:
        from_below: as Kalibr numbers them, from the lower left. OpenCV takes its tags for upside
            down, so that rows count up as they should, and columns down.
    """
    fits = [(n, *_in_order(lattice, n, from_below)) for n in _columns_of(lattice)]
    fitting = [
        (n, first)
        for n, first, count in fits
        if first >= 0 and count >= IN_PLACE * lattice.ids.size
    ]
    columns = tuple(n for n, _ in fitting)
    first = fitting[0][1] if fitting else int(lattice.ids.min())
    return Numbering(columns, columns == (lattice.columns,), lattice.rows, first)


def numbered_otherwise(board: Board, lattice: Lattice) -> int:
    """How many more tags of a grid are in order by another number of columns, or begun at another
    id, than by `board`'s. The lattice's ids count from the board's first tag."""
    from_below = board.kind == "aprilgrid"
    row, column = np.divmod(lattice.ids, board.columns)
    across = board.columns - 1 - column if from_below else column
    shifts = np.stack([across, row], axis=1) - lattice.places
    as_given = int(np.unique(shifts, axis=0, return_counts=True)[1].max())
    best = max(_in_order(lattice, n, from_below)[1] for n in _columns_of(lattice))
    return best - as_given if best >= IN_PLACE * lattice.ids.size else 0


def _columns_of(lattice: Lattice) -> range:
    return range(lattice.columns, max(_MOST_COLUMNS, lattice.columns) + 1)


def _in_order(lattice: Lattice, columns: int, from_below: bool) -> tuple[int, int]:
    """The first id of the tags seen by which most are in order, and how many are."""
    column, row = lattice.places.T
    across = lattice.columns - 1 - column if from_below else column
    firsts, counts = np.unique(lattice.ids - columns * row - across, return_counts=True)
    return int(firsts[counts.argmax()]), int(counts.max())

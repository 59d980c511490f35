"""How the markers of a ChArUco board are numbered, from how they lie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.marker_lattice import Lattice

_MOST_COLUMNS = 40
IN_PLACE = 0.8
"""Share of the markers that must be where a layout has them; one may be misread."""


@dataclass(frozen=True)
class Numbering:
    """How the markers of a ChArUco board are numbered."""

    columns: tuple[int, ...]
    """The numbers of columns that fit."""
    whole: bool
    """Whether all columns are in the picture."""
    rows: int
    """Number of rows seen."""
    first_id: int
    """Of the topmost row seen; right if `whole`."""


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

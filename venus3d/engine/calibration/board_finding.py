"""Finds out which boards pictures show, with nothing known of them: kind, size, markers, layout."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_recognition import grid_kind
from venus3d.engine.calibration.marker_lattice import Lattice, lattices_of
from venus3d.engine.calibration.marker_numbering import numbering_of, tag_numbering_of
from venus3d.engine.calibration.marker_reading import Markers, family_of, read_markers, size_key
from venus3d.engine.calibration.plain_patterns import Pattern, find_pattern
from venus3d.engine.geometry.board import DICTIONARIES, KINDS
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]

_FEWEST_PLACED = 6
"""Markers that tell a board: fewer may be anything."""
_LIKELY = 0.25
"""Share of the pictures with a pattern without markers that must agree on its size."""
_PROFILE = np.linspace(0.0, 1.0, 201)
_PLAIN = {
    "checkerboard": "chessboard",
    "circles": "circles",
    "asymmetric circles": "asymmetric-circles",
}


@dataclass(frozen=True)
class FoundBoard:
    """A board as pictures show it."""

    kind: str
    """As in `--board.kind`; "unknown" for markers in no order that a kind has."""
    columns: int
    """Squares, tags or circles from left to right; without markers the longer side."""
    rows: int
    dictionary: str = ""
    """The smallest of its family that has all the markers; "" without markers."""
    first_id: int = 0
    legacy: bool = False
    inverted: bool = False
    """Of circles: white ones on a dark ground."""
    whole: bool = True
    """Whether all columns were in the picture; if not, `columns` and `first_id` are guesses."""
    markers: int = 0
    """Number of markers seen."""
    share: float = float("nan")
    """Side of a marker over that of a square, or over the distance from one tag to the next."""
    pictures: int = 1
    """In how many of the pictures it is seen."""

    @property
    def options(self) -> str:
        """The options to copy; those of lengths are the person's to measure."""
        given = f"--board.kind {self.kind} --board.columns {self.columns} --board.rows {self.rows}"
        if self.dictionary:
            given += f" --board.dictionary {self.dictionary}"
        if self.first_id:
            given += f" --board.first-id {self.first_id}"
        return given + " --board.legacy" * self.legacy + " --board.inverted" * self.inverted


def find_boards(pictures: Iterable[Grey]) -> list[FoundBoard]:
    """The boards in grey images (H, W), the one with the most markers first; about 0.2 s each at
    720p. Two boards side by side, or of other ids, are two; each is told as it was seen best."""
    marked: list[FoundBoard] = []
    unmarked: list[Grey] = []
    for grey in pictures:
        here = marked_boards(grey)
        if not here:
            unmarked.append(grey)
        for _, one in here:
            _merge(marked, one)
    best = sorted(marked, key=lambda one: (-one.markers, one.first_id))
    return [*best, *plain_boards(unmarked)]


def marked_boards(grey: Grey) -> list[tuple[Lattice, FoundBoard]]:
    """The boards with markers in a grey image (H, W), and how their markers lie."""
    upright, _ = read_markers(grey)
    return [
        (lattice, _of_lattice(grey, markers, lattice))
        for markers in upright
        for lattice in lattices_of(markers)
        if lattice.ids.size >= _FEWEST_PLACED
    ]


def plain_boards(pictures: Iterable[Grey], *, quick: bool = False) -> list[FoundBoard]:
    """The boards without markers that enough of the grey images (H, W) agree on; `quick`: see
    `find_pattern`."""
    patterns = [find_pattern(grey, quick=quick) for grey in pictures]
    return _agreed([one for one in patterns if one is not None and one.kind in _PLAIN])


def _merge(known: list[FoundBoard], one: FoundBoard) -> None:
    """Add what a picture shows to the same board in others: the best view of it tells."""
    for index, other in enumerate(known):
        if _is_part(one, other) or _is_part(other, one):
            best = max(
                other, one, key=lambda board: (board.kind in KINDS, board.whole, board.markers)
            )
            known[index] = replace(best, pictures=other.pictures + 1)
            return
    known.append(one)


def _is_part(one: FoundBoard, other: FoundBoard) -> bool:
    """Whether one may be a view of a part of the other; without an order, a bad view of it."""
    each = other.columns * other.rows // (2 if other.kind == "charuco" else 1)
    begun = other.first_id <= one.first_id < other.first_id + each
    if not begun or family_of(one.dictionary) != family_of(other.dictionary):
        return False
    if one.kind == "unknown":
        return True
    return one.kind == other.kind and one.columns <= other.columns and one.rows <= other.rows


def _of_lattice(grey: Grey, markers: Markers, lattice: Lattice) -> FoundBoard:
    if lattice.arrangement == "chessboard":
        return _charuco(markers, lattice)
    kind = grid_kind(grey, markers.dictionary, lattice)
    numbering = tag_numbering_of(lattice, kind == "aprilgrid")
    return FoundBoard(
        kind if numbering.columns else "unknown",
        numbering.columns[0] if numbering.columns else lattice.columns,
        lattice.rows,
        dictionary_with(family_of(markers.dictionary), int(lattice.ids.max()) + 1),
        numbering.first_id if numbering.whole else int(lattice.ids.min()),
        whole=numbering.whole,
        markers=int(lattice.ids.size),
        share=_tag_share(grey, lattice),
    )


def _charuco(markers: Markers, lattice: Lattice) -> FoundBoard:
    numbering = numbering_of(lattice)
    columns = numbering.columns[0] if numbering.columns else lattice.columns
    rows = lattice.rows
    first = 0 if numbering.columns else int(lattice.ids.min())
    first = numbering.first_id if numbering.whole else first
    # Since OpenCV 4.6 the upper left square is dark; before, it had a marker if the rows are even.
    top = lattice.places[lattice.places[:, 1] == 0, 0]
    legacy = numbering.whole and rows % 2 == 0 and bool(np.median(top % 2) == 0)
    needed = max(int(lattice.ids.max()) + 1, first + columns * rows // 2)
    return FoundBoard(
        "charuco" if numbering.columns else "unknown",
        columns,
        rows,
        dictionary_with(family_of(markers.dictionary), needed),
        first,
        legacy,
        whole=numbering.whole,
        markers=int(lattice.ids.size),
        share=lattice.marker_share,
    )


def dictionary_with(family: str, markers: int) -> str:
    """The smallest dictionary of a family (`DICT_5X5`) that has so many markers; the larger ones
    begin with the same. "" if none has."""
    own = sorted((name for name in DICTIONARIES if family_of(name) == family), key=size_key)
    if own and not own[0].rpartition("_")[2].isdigit():
        return own[0]
    return next((name for name in own if int(name.rpartition("_")[2]) >= markers), "")


def _tag_share(grey: Grey, lattice: Lattice) -> float:
    """Side of a tag over the distance to the next: one less the light part of the way between the
    centres of neighbours in a row. NaN if no gap is seen."""
    at = {(int(c), int(r)): n for n, (c, r) in enumerate(lattice.places)}
    centres = lattice.quads.mean(axis=1)
    gaps: list[float] = []
    for (column, row), index in at.items():
        beside = at.get((column + 1, row))
        if beside is not None:
            gap = _light_part(grey, centres[index], centres[beside])
            gaps += [] if gap is None else [gap]
    return 1 - float(np.median(gaps)) if gaps else float("nan")


def _light_part(grey: Grey, one: Array, other: Array) -> float | None:
    """The share of a way in the image that is light around its middle."""
    x, y = np.rint(one + (other - one) * _PROFILE[:, None]).astype(int).T
    if min(x.min(), y.min()) < 0 or x.max() >= grey.shape[1] or y.max() >= grey.shape[0]:
        return None
    tones = grey[y, x].astype(np.float64)
    light, dark = tones[90:111].max(), tones[40:161].min()
    is_light = tones > (light + dark) / 2
    if not is_light[100]:
        return None
    before = np.flatnonzero(~is_light[:100])
    after = np.flatnonzero(~is_light[100:])
    if not before.size or not after.size:
        return None
    return float((100 + after[0] - before[-1] - 1) / 200)


def _agreed(patterns: list[Pattern]) -> list[FoundBoard]:
    """The boards that enough patterns are of."""
    counts = Counter((one.kind, one.columns, one.rows, one.white) for one in patterns)
    found: list[FoundBoard] = []
    for (kind, columns, rows, white), count in counts.most_common(2):
        if count < _LIKELY * len(patterns) or any(one.kind == _PLAIN[kind] for one in found):
            continue
        more = 1 if kind == "checkerboard" else 0  # squares, not inner corners
        size = columns + more, rows + more
        found.append(FoundBoard(_PLAIN[kind], *size, inverted=white, pictures=count))
    return found

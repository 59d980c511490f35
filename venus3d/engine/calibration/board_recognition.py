"""Recognises what images show in which the expected board was not found.

OpenCV finds no corners if rows and columns are swapped or the dictionary is wrong, and gives no
reason. Here all markers are read (`marker_reading`), mirrored ones too, and how they lie tells the
kind of board (`marker_lattice`); patterns without markers: `plain_patterns`. Another layout is
handled by `detection`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.marker_lattice import Lattice, lattices_of
from venus3d.engine.calibration.marker_reading import Markers, family_of, read_markers
from venus3d.engine.calibration.plain_patterns import Pattern, find_pattern
from venus3d.engine.calibration.thin_borders import thin_border
from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.board import KINDS, Board
from venus3d.engine.sentences import Sentence

Grey = NDArray[np.uint8]

# Frames without the board before the first try, between tries, and after one with a result.
_PATIENCE, _EVERY, _PAUSE = 8, 4, 60
# Patterns without markers take longer to find: every so many tries.
_PLAIN_EVERY = 8
_FEWEST_MARKERS = 4
"""Different markers of one dictionary that rule out a chance detection."""
_FEWEST_PLACED = 6
"""Markers needed to judge their arrangement."""
_FEWEST_UNORDERED = 10
"""Markers needed to say that no number of columns explains how they are numbered."""
_MOST_COLUMNS = 40
OTHER_MARKER = 0.2
"""Markers measured this far from the size given, by a share of it, are read in the size measured:
it is measured to some 5 %, and corners are found in their places up to some 30 %."""
_IN_PLACE = 0.8
"""Share of the markers that must be where a layout has them; one may be misread."""

_NOT_READ = Sentence(
    "Such a pattern is not read: print a board (venus3d board) and take the pictures with it."
)
_READ_IT = Sentence(
    "If that is your board, start with {options}; venus3d board --find tells the rest."
)


@dataclass(frozen=True)
class Finding:
    """What an image shows instead of the board."""

    diagnosis: Diagnosis
    board: Board | None = None
    """The board that can be read instead."""
    weight: float = 0.0
    """Number of markers it rests on; less than one if there are none."""


class BoardRecognition:
    """Looks for other boards in images where the board was missed. Used by one thread."""

    def __init__(self, board: Board) -> None:
        self._board = board
        self._misses = 0
        self._tries = 0
        self._finding: Finding | None = None

    @property
    def diagnosis(self) -> Diagnosis | None:
        """What the images show instead of the board; None if unknown."""
        return None if self._finding is None else self._finding.diagnosis

    @property
    def readable(self) -> Board | None:
        """The board to read instead of the one given, if the images show that."""
        return None if self._finding is None else self._finding.board

    def found(self) -> None:
        """The board was found: discards whatever else was seen."""
        self._misses, self._tries, self._finding = 0, 0, None

    def missed(self, grey: Grey) -> None:
        """The board was not found in this whole image (H, W); looks for others now and then."""
        self._misses += 1
        if self._misses >= _PATIENCE and self._misses % _EVERY == 0:
            self.examine(grey, plain=self._tries % _PLAIN_EVERY == 0)

    def examine(self, grey: Grey, *, plain: bool = True) -> bool:
        """Look at an image (H, W), with `plain` for patterns without markers too. True if this
        identifies what it shows."""
        self._tries += 1
        self._finding = _finding_of(self._board, grey, plain)
        if self._finding is not None:
            self._misses = -_PAUSE
        return self._finding is not None


def recognise_board(board: Board, pictures: Iterable[Grey]) -> Diagnosis | None:
    """What the grey images (H, W) show instead of `board`; None if nothing can be said, or if they
    show it. About 0.1 s each at 720p, without markers 0.3 s."""
    finding = best_finding(board, pictures)
    return None if finding is None else finding.diagnosis


def some_mirrored(board: Board, pictures: Iterable[Grey]) -> Diagnosis | None:
    """Whether one of the grey images (H, W) without the board is a mirror image of it, where other
    images of the set show it upright; 0.1 s each at 720p."""
    if all(_mirrored_markers(board, *read_markers(one)) is None for one in pictures):
        return None
    return Diagnosis(
        "mirrored",
        Sentence(
            "Some pictures are mirrored: the board is found in them only after they are flipped "
            "left to right. They are left out."
        ),
        Sentence(
            "Flip them back, or calibrate them by themselves with --flip if the camera or its "
            "program mirrors what it shows."
        ),
    )


def best_finding(board: Board, pictures: Iterable[Grey]) -> Finding | None:
    """The finding in the image that shows the most markers; a board that can be read first."""
    found = [f for f in (_finding_of(board, picture, True) for picture in pictures) if f]
    return max(found, key=lambda f: (f.board is not None, f.weight), default=None)


def _finding_of(board: Board, grey: Grey, plain: bool) -> Finding | None:
    upright, mirrored = read_markers(grey)
    flipped = _mirrored_markers(board, upright, mirrored)
    if flipped is not None:
        named = _mirrored(_name(board, flipped), flipped.distinct)
        return Finding(named, weight=flipped.distinct)
    seen = _likeliest(board, upright)
    if seen is not None and seen.distinct >= _FEWEST_MARKERS:
        return _of_markers(board, grey, seen)
    pattern = find_pattern(grey) if plain else None
    thin = None if pattern is None else _thin(board, grey, pattern)
    if thin is not None:
        return Finding(thin, weight=0.5)
    if seen is not None and family_of(seen.dictionary) == family_of(board.dictionary):
        return None  # perhaps a board that is small or hidden
    if pattern is not None:
        other = _plain(board, pattern)
        weight = pattern.columns * pattern.rows / 1000
        return None if other is None else Finding(other, weight=weight)
    return (
        None
        if seen is None or not board.has("dictionary")
        else Finding(_single(board, seen), weight=seen.distinct)
    )


def _mirrored_markers(
    board: Board, upright: list[Markers], mirrored: list[Markers]
) -> Markers | None:
    """The markers of a mirror image; None if it is none. A few are others in the mirror image."""
    seen, flipped = _likeliest(board, upright), _likeliest(board, mirrored)
    fewest = max(_FEWEST_MARKERS, 1 + 2 * (0 if seen is None else seen.distinct))
    return flipped if flipped is not None and flipped.distinct >= fewest else None


def _likeliest(board: Board, read: list[Markers]) -> Markers | None:
    """The dictionary of the most markers, of equals the board's own. Of 4 x 4 cells chance makes
    some: they count from `_FEWEST_MARKERS` on."""
    own = family_of(board.dictionary)
    sure = [m for m in read if m.distinct >= _FEWEST_MARKERS or "4X4" not in m.dictionary]
    return max(sure, key=lambda m: (m.distinct, family_of(m.dictionary) == own), default=None)


def _of_markers(board: Board, grey: Grey, markers: Markers) -> Finding | None:
    boards = lattices_of(markers)
    own = family_of(markers.dictionary) == family_of(board.dictionary)
    largest = boards[0] if boards and boards[0].ids.size >= _FEWEST_PLACED else None
    if largest is not None and largest.arrangement == "grid":
        grid = _grid(board, grey, markers.dictionary, largest)
        return None if grid is None else Finding(grid, weight=largest.ids.size)
    if board.kind != "charuco":
        return None if largest is None else _squares_with_markers(markers, largest)
    if own:
        if largest is None:
            return None
        return _misplaced(board, largest)
    size = None if largest is None else numbering_of(largest)
    return Finding(_wrong_dictionary(board, markers, size), weight=markers.distinct)


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
        if pairs.max() >= _IN_PLACE * lattice.ids.size:
            fitting.append(n)
    whole = len(fitting) >= 1 and fitting[0] == lattice.columns
    n = fitting[0] if fitting else 0
    firsts, counts = np.unique(lattice.ids - (n * row + column) // 2, return_counts=True)
    first = int(firsts[counts.argmax()])
    return Numbering(tuple(fitting), whole, lattice.rows, first)


def _misplaced(board: Board, lattice: Lattice) -> Finding | None:
    """What is wrong with the arrangement of markers of the right dictionary; None if nothing."""
    numbering = numbering_of(lattice)
    weight = int(lattice.ids.size)
    if board.columns in numbering.columns:
        return _read_otherwise(board, numbering, lattice)
    if not numbering.columns and weight < _FEWEST_UNORDERED:
        return None
    asked = Sentence("not as on the board of {columns} columns and {rows} rows asked for").format(
        columns=board.columns, rows=board.rows
    )
    first = numbering.first_id if numbering.whole else 0
    if board.rows in numbering.columns:
        cause = Sentence(
            "The markers lie as on a board of {columns} columns, {asked}: the two are swapped."
        ).format(columns=board.rows, asked=asked)
        cure = _start_with(board, board.rows, board.columns, first)
    elif len(numbering.columns) == 1:
        columns = numbering.columns[0]
        cause = Sentence("The markers lie as on a board of {columns} columns, {asked}.").format(
            columns=columns, asked=asked
        )
        cure = (
            _start_with(board, columns, numbering.rows, first)
            if numbering.whole
            else Sentence(
                "Count the rows of squares as well and start with --board.columns {columns} "
                "--board.rows ROWS."
            ).format(columns=columns)
        )
    else:
        cause = Sentence("Markers of {dictionary} are seen, but they lie {asked}.").format(
            dictionary=board.dictionary, asked=asked
        )
        cure = Sentence(
            "Count the squares along both sides and start with --board.columns and --board.rows."
        )
    return Finding(Diagnosis("swapped-size", cause, cure), weight=weight)


def _start_with(board: Board, columns: int, rows: int, first_id: int) -> Sentence:
    if first_id == board.first_id:
        return Sentence("Start with --board.columns {columns} --board.rows {rows}.").format(
            columns=columns, rows=rows
        )
    return Sentence(
        "Start with --board.columns {columns} --board.rows {rows} --board.first-id {first}."
    ).format(columns=columns, rows=rows, first=first_id)


def _read_otherwise(board: Board, numbering: Numbering, lattice: Lattice) -> Finding | None:
    """The board with another first id, or another size of the markers."""
    weight = int(lattice.ids.size)
    marker = round(2000 * lattice.marker_share * board.square) / 2000  # to half a millimetre
    if abs(marker / board.marker - 1) > OTHER_MARKER and 0 < marker < board.square:
        other = replace(board, marker=marker)
        return Finding(marker_size_diagnosis(board, other), other, weight)
    # With other rows than asked for it is a part of the board, or one that is read all the same.
    if not numbering.whole or numbering.first_id == board.first_id or numbering.rows != board.rows:
        return None
    try:
        other = replace(board, first_id=numbering.first_id)
    except BoardError:
        return None
    return Finding(first_id_diagnosis(other), other, weight)


def marker_size_diagnosis(asked: Board, board: Board) -> Diagnosis:
    """The markers have another size than asked for, and are read in that."""
    values = {"found": board.marker * 1000, "square": board.square * 1000}
    return Diagnosis(
        "wrong-marker-size",
        Sentence(
            "In the pictures the markers are about {found:g} mm wide where a square is {square:g} "
            "mm, not {given:g} mm; they are read that way."
        ).format(**values, given=asked.marker * 1000),
        Sentence(
            "Measure a marker and a square and give both: --board.marker-mm {found:g} "
            "--board.square-mm {square:g}, if that is right."
        ).format(**values),
    )


def two_boards_diagnosis() -> Diagnosis:
    """Two equal boards in view."""
    return Diagnosis(
        "two-boards",
        Sentence("The picture shows the same markers twice, on two equal boards."),
        Sentence("Cover one of the boards, or take it away."),
    )


def first_id_diagnosis(board: Board) -> Diagnosis:
    """The markers start at another id than asked for, and are read."""
    return Diagnosis(
        "other-first-id",
        Sentence(
            "The markers of the board of {columns} x {rows} squares start at id {first}; it is "
            "read that way."
        ).format(columns=board.columns, rows=board.rows, first=board.first_id),
        Sentence("Start with --board.first-id {first} to be sure.").format(first=board.first_id),
    )


def _wrong_dictionary(board: Board, markers: Markers, size: Numbering | None) -> Diagnosis:
    cure = Sentence("Start with --board.dictionary {name}.").format(name=markers.dictionary)
    if size is not None and size.whole and len(size.columns) == 1:
        columns, rows = size.columns[0], size.rows
        if (columns, rows) != (board.columns, board.rows):
            cure = Sentence(
                "Start with --board.columns {columns} --board.rows {rows} --board.dictionary "
                "{name}."
            ).format(columns=columns, rows=rows, name=markers.dictionary)
    return Diagnosis(
        "wrong-dictionary",
        Sentence(
            "The picture shows markers of {name} ({count} different ones), not of {asked}."
        ).format(name=markers.dictionary, count=markers.distinct, asked=board.dictionary),
        cure,
    )


def _name(board: Board, markers: Markers) -> str:
    """The board's own dictionary if it is of the same family."""
    own = family_of(markers.dictionary) == family_of(board.dictionary)
    return board.dictionary if own else markers.dictionary


def _mirrored(name: str, count: int) -> Diagnosis:
    return Diagnosis(
        "mirrored",
        Sentence(
            "The pictures are mirrored: flipped left to right, they show {count} markers of {name}."
        ).format(count=count, name=name),
        Sentence(
            "Switch mirroring off in the camera's program, or start with --flip; the camera file "
            "then holds for pictures that are flipped back."
        ),
    )


def _squares_with_markers(markers: Markers, lattice: Lattice) -> Finding:
    """A ChArUco board where another kind is asked for."""
    numbering = numbering_of(lattice)
    columns = numbering.columns[0] if numbering.columns else lattice.columns
    cause = Sentence(
        "The picture shows a ChArUco board of {columns} x {rows} squares, {name}: not the board "
        "asked for."
    ).format(columns=columns, rows=lattice.rows, name=markers.dictionary)
    cure = _options("charuco", columns, lattice.rows, markers.dictionary)
    return Finding(Diagnosis("other-pattern", cause, cure), weight=markers.distinct)


def _options(kind: str, columns: int, rows: int, dictionary: str = "", first_id: int = 0) -> str:
    """How to have a board read as what it is, if its kind is read."""
    if kind not in KINDS:
        return _NOT_READ
    options = f"--board.kind {kind} --board.columns {columns} --board.rows {rows}"
    options += f" --board.dictionary {dictionary}" if dictionary else ""
    options += f" --board.first-id {first_id}" if first_id else ""
    return _READ_IT.format(options=options)


def _grid(board: Board, grey: Grey, dictionary: str, lattice: Lattice) -> Diagnosis | None:
    """That the picture shows a grid of tags; None if it may be a part of the one asked for."""
    values = {"columns": lattice.columns, "rows": lattice.rows}
    april, _, tags = dictionary.partition("APRILTAG_")
    joints = april == "DICT_" and has_dark_joints(grey, lattice)
    kind = "aprilgrid" if joints else "aruco-grid"
    part = lattice.columns <= board.columns and lattice.rows <= board.rows
    if board.kind == kind and part and family_of(dictionary) == family_of(board.dictionary):
        return None
    if joints:
        cause = Sentence(
            "The picture shows an AprilGrid of {columns} x {rows} tags, {tags}: not the board "
            "asked for."
        ).format(**values, tags=tags)
    else:
        cause = Sentence(
            "The picture shows a grid of {columns} x {rows} markers of {name}: not the board "
            "asked for."
        ).format(**values, name=dictionary)
    first = int(lattice.ids.min())
    cure = _options(kind, lattice.columns, lattice.rows, dictionary, first)
    return Diagnosis("other-pattern", cause, cure)


def has_dark_joints(grey: Grey, lattice: Lattice) -> bool:
    """Whether there are dark squares between four tags, as on Kalibr's AprilGrid."""
    inner = np.stack(
        np.meshgrid(np.arange(lattice.columns - 1), np.arange(lattice.rows - 1)), axis=-1
    ).reshape(-1, 2)
    joints, gaps = inner + 0.5, inner + np.array([0.5, 0.0])
    dark, light = (_greys(grey, lattice, places) for places in (joints, gaps))
    return bool(dark.size and np.median(dark) < 0.6 * np.median(light))


def _greys(grey: Grey, lattice: Lattice, places: NDArray[np.float64]) -> NDArray[np.float64]:
    pixels = cv2.perspectiveTransform(places.reshape(1, -1, 2).astype(np.float64), lattice.H)[0]
    x, y = np.rint(pixels.T).astype(int)
    inside = (x >= 0) & (y >= 0) & (x < grey.shape[1]) & (y < grey.shape[0])
    return grey[y[inside], x[inside]].astype(np.float64)


def _single(board: Board, markers: Markers) -> Diagnosis:
    return Diagnosis(
        "other-pattern",
        Sentence(
            "The picture shows {count} single markers of {name}: not the board of {asked} asked "
            "for."
        ).format(count=markers.distinct, name=markers.dictionary, asked=board.dictionary),
        _NOT_READ,
    )


_KIND_OF = {
    "checkerboard": "chessboard",
    "circles": "circles",
    "asymmetric circles": "asymmetric-circles",
}
_PLAIN = {
    "checkerboard": Sentence(
        "The picture shows a checkerboard of {columns} x {rows} inner corners, without markers: "
        "not the board asked for."
    ),
    "circles": Sentence(
        "The picture shows a grid of {columns} x {rows} circles: not the board asked for."
    ),
    "asymmetric circles": Sentence(
        "The picture shows an asymmetric grid of circles, {rows} rows of {columns}: not the board "
        "asked for."
    ),
    "unread": Sentence(
        "The picture shows a board of {columns} x {rows} inner corners, but its markers cannot be "
        "read: they are too small or blurred, or their dictionary is none of OpenCV's."
    ),
}
_THIN = {
    "black": Sentence(
        "The markers of the board in the picture are of {dictionary}, but their black border is "
        "too thin for them to be found: it must be as wide as one of a marker's cells."
    ),
    "white": Sentence(
        "The markers of the board in the picture are of {dictionary}, but the white border around "
        "them is too thin for them to be found: they nearly fill their squares."
    ),
}


def _thin(board: Board, grey: Grey, pattern: Pattern) -> Diagnosis | None:
    """That a border of the board's markers is too thin for them to be found, if it is."""
    if pattern.kind != "unread" or pattern.corners is None or not board.has("marker"):
        return None
    thin = thin_border(grey, pattern.corners, board)
    if thin is None:
        return None
    return Diagnosis(
        "unread-markers",
        _THIN[thin].format(dictionary=board.dictionary),
        Sentence("Print the board again with venus3d board, and measure it."),
    )


def _plain(board: Board, pattern: Pattern) -> Diagnosis | None:
    """That the picture shows a pattern without markers; None if it is the board asked for."""
    cause = _PLAIN[pattern.kind].format(columns=pattern.columns, rows=pattern.rows)
    if pattern.kind == "unread":
        return Diagnosis(
            "unread-markers",
            cause,
            Sentence(
                "Bring the board nearer and hold it still; if that does not help, print a board "
                "with venus3d board."
            ),
        )
    more = 1 if pattern.kind == "checkerboard" else 0  # squares, not inner corners
    columns, rows, kind = pattern.columns + more, pattern.rows + more, _KIND_OF[pattern.kind]
    if board.kind == kind and {board.columns, board.rows} == {columns, rows}:
        return None  # hard to see, or read the other way round
    return Diagnosis("other-pattern", cause, _options(kind, columns, rows))

"""Recognises what images show in which the expected board was not found.

OpenCV finds no corners if rows and columns are swapped or the dictionary is wrong, and gives no
reason. Here all markers are read (`marker_reading`), mirrored ones too, and how they lie tells the
kind of board (`marker_lattice`); patterns without markers: `plain_patterns`. Another layout is
handled by `detection`. `board_diagnoses` says what is found.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_diagnoses import (
    charuco_diagnosis,
    first_id_diagnosis,
    marker_size_diagnosis,
    mirrored_diagnosis,
    plain_pattern_diagnosis,
    single_markers_diagnosis,
    small_board_diagnosis,
    some_mirrored_diagnosis,
    swapped_size_diagnosis,
    tag_grid_diagnosis,
    two_boards_diagnosis,
    unread_border_diagnosis,
    wrong_dictionary_diagnosis,
)
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.marker_lattice import Lattice, lattices_of
from venus3d.engine.calibration.marker_numbering import (
    IN_PLACE,
    Numbering,
    numbering_of,
    tag_numbering_of,
)
from venus3d.engine.calibration.marker_reading import (
    Markers,
    family_of,
    read_markers,
    shows_twice,
)
from venus3d.engine.calibration.plain_patterns import Pattern, find_pattern
from venus3d.engine.calibration.thin_borders import thin_border
from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.board import Board

Grey = NDArray[np.uint8]

# Frames without the board before the first try, between tries, and after one with a result.
_PATIENCE, _EVERY, _PAUSE = 8, 4, 60
# Patterns without markers take longer to find: every so many tries.
_PLAIN_EVERY = 8
_FEWEST_MARKERS = 4
"""Different markers of one dictionary that rule out a chance detection."""
_FEWEST_PLACED = 6
"""Markers needed to judge their arrangement."""
_OFF = 0.3
"""Largest distance of a marker's corner from its place, in sides of a marker."""
_FEWEST_UNORDERED = 10
"""Markers needed to say that no number of columns explains how they are numbered."""
OTHER_MARKER = 0.2
"""Markers measured this far from the size given, by a share of it, are read in the size measured:
it is measured to some 5 %, and corners are found in their places up to some 30 %."""


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


def best_finding(board: Board, pictures: Iterable[Grey], *, plain: bool = True) -> Finding | None:
    """The finding in the image that shows the most markers; a board that can be read first.
    `plain`: look for patterns without markers too."""
    found = [f for f in (_finding_of(board, picture, plain) for picture in pictures) if f]
    return max(found, key=lambda f: (f.board is not None, f.weight), default=None)


def _finding_of(board: Board, grey: Grey, plain: bool) -> Finding | None:
    upright, mirrored = read_markers(grey)
    flipped = _mirrored_markers(upright, mirrored)
    if flipped is not None:
        named = mirrored_diagnosis(_name(board, flipped), flipped.distinct)
        return Finding(named, weight=flipped.distinct)
    seen = _likeliest(board, upright)
    if seen is not None and seen.distinct >= _FEWEST_MARKERS:
        return _of_markers(board, grey, seen)
    pattern = find_pattern(grey) if plain else None
    small = None if pattern is None else _small(board, pattern)
    if small is not None:
        return Finding(small, weight=0.5)
    thin = None if pattern is None else _thin(board, grey, pattern)
    if thin is not None:
        return Finding(thin, weight=0.5)
    if seen is not None and family_of(seen.dictionary) == family_of(board.dictionary):
        return None  # perhaps a board that is small or hidden
    if pattern is not None:
        other = plain_pattern_diagnosis(board, pattern)
        weight = pattern.columns * pattern.rows / 1000
        return None if other is None else Finding(other, weight=weight)
    return (
        None
        if seen is None or not board.has("dictionary")
        else Finding(single_markers_diagnosis(board, seen), weight=seen.distinct)
    )


def _mirrored_markers(upright: list[Markers], mirrored: list[Markers]) -> Markers | None:
    """The markers of the mirror image of a board, of an image's by `read_markers`; None if it is
    none. They lie on a board, and more than twice as many as of those that are upright: what is
    read in the mirror image by chance lies anywhere."""
    placed = [_placed_in_mirror(markers) for markers in mirrored]
    largest = max(placed, default=0)
    upright_most = max((_largest(lattices_of(markers)) for markers in upright), default=0)
    fewest = max(_FEWEST_MARKERS, 1 + 2 * upright_most)
    return mirrored[placed.index(largest)] if largest >= fewest else None


def _largest(lattices: list[Lattice]) -> int:
    return lattices[0].ids.size if lattices else 0


def _placed_in_mirror(markers: Markers) -> int:
    """How many lie on one board in the mirror image; of few, only if they are numbered as one."""
    ordered = [
        lattice
        for lattice in lattices_of(markers.flipped)
        if lattice.ids.size >= _FEWEST_UNORDERED or _is_in_order(lattice)
    ]
    return _largest(ordered)


def _is_in_order(lattice: Lattice) -> bool:
    if lattice.arrangement == "chessboard":
        return bool(numbering_of(lattice).columns)
    return any(tag_numbering_of(lattice, from_below).columns for from_below in (False, True))


def _likeliest(board: Board, read: list[Markers]) -> Markers | None:
    """The dictionary of the most markers, of equals the board's own; without what may be chance."""
    own = family_of(board.dictionary)
    sure = [m for m in read if "4X4" not in m.dictionary or _is_no_chance(m, own)]
    return max(sure, key=lambda m: (m.distinct, family_of(m.dictionary) == own), default=None)


def _is_no_chance(markers: Markers, own: str) -> bool:
    """Whether these markers of 4 x 4 cells are some: one of 16 random squares is one of the 1000,
    so that a few are read in a board whose own bits are lost to blur. Of few, only those count
    that are numbered as one board, or are of the board's `own` family."""
    if markers.distinct < _FEWEST_MARKERS or family_of(markers.dictionary) == own:
        return markers.distinct >= _FEWEST_MARKERS
    placed = (lattice for lattice in lattices_of(markers) if lattice.ids.size >= _FEWEST_MARKERS)
    return markers.distinct >= _FEWEST_UNORDERED or any(map(_is_in_order, placed))


def _of_markers(board: Board, grey: Grey, markers: Markers) -> Finding | None:
    boards = lattices_of(markers)
    own = family_of(markers.dictionary) == family_of(board.dictionary)
    largest = boards[0] if boards and boards[0].ids.size >= _FEWEST_PLACED else None
    if own and shows_twice(markers.ids):
        return Finding(two_boards_diagnosis(), weight=markers.distinct)
    if own and board.kind == "charuco" and _lie_as_printed(board, markers):
        # Of a small board few are read, which may lie in any order among themselves.
        return None if largest is None else _read_in_place(board, largest)
    if largest is not None and largest.arrangement == "grid":
        return _of_grid(board, grey, markers.dictionary, largest)
    if board.kind != "charuco":
        if largest is None:
            return None
        named = charuco_diagnosis(largest, numbering_of(largest), markers.dictionary)
        return Finding(named, weight=markers.distinct)
    if own:
        if largest is None:
            return None
        return _misplaced(board, largest)
    size = None if largest is None else numbering_of(largest)
    return Finding(wrong_dictionary_diagnosis(board, markers, size), weight=markers.distinct)


def _lie_as_printed(board: Board, markers: Markers) -> bool:
    """Whether markers of a ChArUco board's dictionary lie as its own do: their corners, since a
    board of another number of columns is this one sheared."""
    printed = np.asarray(board.cv_board.getObjPoints(), dtype=np.float64)[..., :2]
    numbers = markers.ids - board.first_id
    known = (numbers >= 0) & (numbers < len(printed))
    quads = markers.quads[known]
    if len(quads) < max(2, IN_PLACE * markers.ids.size):
        return False
    side = float(np.median(np.linalg.norm(quads - np.roll(quads, 1, axis=1), axis=2)))
    flat = printed[numbers[known]].reshape(-1, 2)
    H, fits = cv2.findHomography(
        flat, quads.reshape(-1, 2), method=cv2.RANSAC, ransacReprojThreshold=_OFF * side
    )
    return H is not None and np.asarray(fits, dtype=np.float64).mean() >= IN_PLACE


def _read_in_place(board: Board, lattice: Lattice) -> Finding | None:
    """The board with another size of its markers, of which enough lie in order."""
    in_order = lattice.arrangement == "chessboard" and numbering_of(lattice).columns
    return _read_otherwise(board, numbering_of(lattice), lattice) if in_order else None


def _read_otherwise(board: Board, numbering: Numbering, lattice: Lattice) -> Finding | None:
    """The board with another first id, or another size of the markers."""
    weight = int(lattice.ids.size)
    marker = round(2000 * lattice.marker_share * board.square) / 2000  # to half a millimetre
    if abs(marker / board.marker - 1) > OTHER_MARKER and 0 < marker < board.square:
        other = replace(board, marker=marker)
        return Finding(marker_size_diagnosis(board, other), other, weight)
    return _begun_otherwise(board, numbering, weight)


def _begun_otherwise(board: Board, numbering: Numbering, weight: float) -> Finding | None:
    """The board with another first id."""
    # With other rows than asked for it is a part of the board, or one that is read all the same.
    if not numbering.whole or numbering.first_id == board.first_id or numbering.rows != board.rows:
        return None
    try:
        other = replace(board, first_id=numbering.first_id)
    except BoardError:
        return None
    return Finding(first_id_diagnosis(other), other, weight)


def _name(board: Board, markers: Markers) -> str:
    """The board's own dictionary if it is of the same family."""
    own = family_of(markers.dictionary) == family_of(board.dictionary)
    return board.dictionary if own else markers.dictionary


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


def some_mirrored(pictures: Iterable[Grey]) -> Diagnosis | None:
    """Whether one of the grey images (H, W) without the board is a mirror image, where other images
    of the set show the board upright; 0.1 s each at 720p."""
    if all(_mirrored_markers(*read_markers(one)) is None for one in pictures):
        return None
    return some_mirrored_diagnosis()


def _misplaced(board: Board, lattice: Lattice) -> Finding | None:
    """What is wrong with the arrangement of markers of the right dictionary; None if nothing."""
    numbering = numbering_of(lattice)
    weight = int(lattice.ids.size)
    if board.columns in numbering.columns:
        return _read_otherwise(board, numbering, lattice)
    if not numbering.columns and weight < _FEWEST_UNORDERED:
        return None
    return Finding(swapped_size_diagnosis(board, numbering), weight=weight)


def grid_kind(grey: Grey, dictionary: str, lattice: Lattice) -> Literal["aprilgrid", "aruco-grid"]:
    """The kind of board on which tags lie side by side in an image (H, W)."""
    april = dictionary.startswith("DICT_APRILTAG_") and has_dark_joints(grey, lattice)
    return "aprilgrid" if april else "aruco-grid"


def _of_grid(board: Board, grey: Grey, dictionary: str, lattice: Lattice) -> Finding | None:
    """That the picture shows another grid of tags than the one asked for; None if it may be that
    one, or a part of it."""
    kind = grid_kind(grey, dictionary, lattice)
    weight = int(lattice.ids.size)
    other = Finding(tag_grid_diagnosis(kind, lattice, dictionary), weight=weight)
    if board.kind != kind or family_of(dictionary) != family_of(board.dictionary):
        return other
    numbering = tag_numbering_of(lattice, kind == "aprilgrid")
    ordered = bool(numbering.columns)
    if board.columns not in numbering.columns and (ordered or weight >= _FEWEST_UNORDERED):
        return Finding(swapped_size_diagnosis(board, numbering), weight=weight)
    if lattice.columns > board.columns or lattice.rows > board.rows:
        return other
    return _begun_otherwise(board, numbering, weight)


def _small(board: Board, pattern: Pattern) -> Diagnosis | None:
    """That it is the board asked for, or a part of it, with squares too small for their markers,
    if it may be: nothing can be said of those."""
    grid = pattern.corners
    if pattern.kind != "unread" or grid is None or not board.has("marker"):
        return None
    short, long = sorted((board.columns, board.rows))
    if pattern.columns + 1 > long or pattern.rows + 1 > short:
        return None
    steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=2) for axis in (0, 1)]
    width, needed = (
        min(float(np.median(step)) for step in steps),
        board.of_kind.legible_square_px(board),
    )
    return small_board_diagnosis(width, needed) if width < needed else None


def _thin(board: Board, grey: Grey, pattern: Pattern) -> Diagnosis | None:
    """That a border of the board's markers is too thin for them to be found, if it is."""
    if pattern.kind != "unread" or pattern.corners is None or not board.has("marker"):
        return None
    thin = thin_border(grey, pattern.corners, board)
    return None if thin is None else unread_border_diagnosis(board, thin)

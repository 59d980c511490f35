"""Recognises a board other than the expected one in images where detection failed.

OpenCV finds no corners if rows and columns are swapped or the dictionary is wrong, and gives no
reason. The dictionary and column count are inferred from the markers, one dictionary per try, since
each costs a detection. Another layout is handled by `detection`.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.geometry.board import DICTIONARIES, Board
from venus3d.engine.geometry.pose import Array
from venus3d.engine.sentences import Sentence

# Frames without the board before the first try, between tries, and after all were tried.
_PATIENCE, _EVERY, _PAUSE = 8, 4, 60
_FEWEST_MARKERS = 4
"""Different markers of one dictionary that rule out a chance detection."""
_FEWEST_PLACED = 6
"""Markers needed to judge their arrangement."""
_MOST_COLUMNS = 30
_IN_PLACE = 0.8
"""Share of the markers that must be where a layout has them; one may be misread."""
_NEAR = 0.25
"""Largest deviation from that place, in marker sides: allows for lens distortion."""


class BoardRecognition:
    """Looks for other boards in images where the board was missed. Used by one thread."""

    def __init__(self, board: Board) -> None:
        self._board = board
        own = _family(board.dictionary)
        # One of each family, the largest: all of a family begin with the same markers.
        named = {_family(name): name for name in sorted(DICTIONARIES, key=_size)}
        self.dictionaries: tuple[str, ...] = (
            board.dictionary,
            *(name for name in sorted(named.values(), key=_size) if _family(name) != own),
        )
        """The dictionaries in the order in which they are tried; the board's own first."""
        self._turn = 0
        self._misses = 0
        self._diagnosis: Diagnosis | None = None

    @property
    def diagnosis(self) -> Diagnosis | None:
        """What the images show instead of the board; None if unknown."""
        return self._diagnosis

    def found(self) -> None:
        """The board was found: discards whatever else was seen."""
        self._misses, self._turn, self._diagnosis = 0, 0, None

    def missed(self, grey: NDArray[np.uint8]) -> None:
        """The board was not found in this whole image (H, W); tries a dictionary now and then."""
        self._misses += 1
        if self._misses >= _PATIENCE and self._misses % _EVERY == 0:
            self.try_next(grey)

    def try_next(self, grey: NDArray[np.uint8]) -> bool:
        """Try one dictionary on an image (H, W). True if this identifies what it shows."""
        name = self.dictionaries[self._turn]
        ids, quads = _markers(self._board, name, grey)
        seen = len(np.unique(ids)) >= _FEWEST_MARKERS
        if not seen:
            self._diagnosis = None
        elif self._turn:
            self._diagnosis = _wrong_dictionary(self._board, name, len(np.unique(ids)))
        else:
            self._diagnosis = _misplaced(self._board, ids, quads)
        if not seen:  # retry a dictionary that was found
            self._turn = (self._turn + 1) % len(self.dictionaries)
        if seen or self._turn == 0:
            self._misses = -_PAUSE
        return seen


def recognise_board(board: Board, pictures: Iterable[NDArray[np.uint8]]) -> Diagnosis | None:
    """What the first of the grey images (H, W) with markers shows instead of `board`.

    None if no image shows markers, or if they are arranged as on the board. Tries every dictionary
    on every image: about 0.2 s each at 720p.
    """
    for picture in pictures:
        check = BoardRecognition(board)
        for _ in check.dictionaries:
            if check.try_next(picture):
                break
        if check.diagnosis is not None:
            return check.diagnosis
    return None


def _wrong_dictionary(board: Board, name: str, count: int) -> Diagnosis:
    return Diagnosis(
        "wrong-dictionary",
        Sentence(
            "The picture shows markers of {name} ({count} different ones), not of {asked}."
        ).format(name=name, count=count, asked=board.dictionary),
        Sentence("Start with --board.dictionary {name}.").format(name=name),
    )


def _misplaced(board: Board, ids: NDArray[np.intp], quads: Array) -> Diagnosis | None:
    """What is wrong with the arrangement of markers of the right dictionary; None if nothing."""
    if ids.size < _FEWEST_PLACED or _lie_on(board.columns, ids, quads):
        return None
    fitting = [n for n in range(3, _MOST_COLUMNS + 1) if _lie_on(n, ids, quads)]
    asked = Sentence("not as on the board of {columns} columns and {rows} rows asked for").format(
        columns=board.columns, rows=board.rows
    )
    if board.rows in fitting:
        return Diagnosis(
            "swapped-size",
            Sentence(
                "The markers lie as on a board of {columns} columns, {asked}: the two are swapped."
            ).format(columns=board.rows, asked=asked),
            Sentence("Start with --board.columns {columns} --board.rows {rows}.").format(
                columns=board.rows, rows=board.columns
            ),
        )
    if len(fitting) == 1:
        return Diagnosis(
            "swapped-size",
            Sentence("The markers lie as on a board of {columns} columns, {asked}.").format(
                columns=fitting[0], asked=asked
            ),
            Sentence(
                "Count the rows of squares as well and start with --board.columns {columns} "
                "--board.rows ROWS."
            ).format(columns=fitting[0]),
        )
    return Diagnosis(
        "swapped-size",
        Sentence("Markers of {dictionary} are seen, but they lie {asked}.").format(
            dictionary=board.dictionary, asked=asked
        ),
        Sentence(
            "Count the squares along both sides and start with --board.columns and --board.rows."
        ),
    )


def _markers(board: Board, name: str, grey: NDArray[np.uint8]) -> tuple[NDArray[np.intp], Array]:
    """Ids (N,) and corners (N, 4, 2) of the markers of a dictionary, black or white.

    Only markers of a board of about this size: OpenCV 5 compares every candidate with every marker,
    so a whole dictionary of 1000 would take twenty times as long.
    """
    whole: Any = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))
    count = min(max(board.marker_count, 50), len(whole.bytesList))
    some = cv2.aruco.Dictionary(whole.bytesList[:count], whole.markerSize, 0)
    parameters = cv2.aruco.DetectorParameters()
    parameters.detectInvertedMarker = True
    parameters.errorCorrectionRate = 0.0  # a misread marker could name the wrong board
    corners, ids, _ = cv2.aruco.ArucoDetector(some, parameters).detectMarkers(grey)
    if ids is None or len(ids) == 0:
        return np.zeros(0, np.intp), np.zeros((0, 4, 2))
    quads = np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)
    return np.asarray(ids, dtype=np.intp).reshape(-1), quads


def _lie_on(columns: int, ids: NDArray[np.intp], quads: Array) -> bool:
    """Whether markers are arranged as on a board with this many columns, in either layout.

    They are numbered row by row on every second square, so the row count does not matter. A
    homography maps the flat board's squares to the image.
    """
    side = float(np.median(np.linalg.norm(np.diff(quads, axis=1), axis=2)))
    for first in (1, 0):  # the first row's second square carries a marker, or its first does
        index = np.arange(columns * (2 * int(ids.max()) // columns + 3))
        column, row = index % columns, index // columns
        squares = np.stack([column, row], axis=1)[(column + row) % 2 == first]
        placed = squares[ids].astype(np.float64)
        H, inliers = cv2.findHomography(placed, quads.mean(axis=1), cv2.RANSAC, _NEAR * side)
        if H is not None and np.count_nonzero(inliers) >= _IN_PLACE * ids.size:
            return True
    return False


def _family(dictionary: str) -> str:
    """The name without its size: DICT_5X5_100 and DICT_5X5_1000 begin with the same markers."""
    stem, _, size = dictionary.rpartition("_")
    return stem if size.isdigit() else dictionary.upper()


def _size(dictionary: str) -> tuple[bool, str, int]:
    """Sort key of the dictionaries: ArUco's families with sizes first, each by size."""
    size = dictionary.rpartition("_")[2]
    return (not size.isdigit(), _family(dictionary), int(size) if size.isdigit() else 0)

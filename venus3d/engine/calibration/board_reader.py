"""What finds one kind of board in a picture: the part of detection that differs between kinds."""

from __future__ import annotations

import copy
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

Grey = NDArray[np.uint8]
Region = tuple[int, int, int, int]
"""Search region x0, y0, x1, y1 in pixels; x1 and y1 are exclusive."""
Read = tuple[NDArray[np.intp], Array]
"""Ids (N,) ascending and corners (N, 2), pixels of the whole image."""
Reader = TypeVar("Reader", bound="BoardReader")
WholeReader = TypeVar("WholeReader", bound="WholeBoardReader")
_UPRIGHT = np.array([1.0, 0.0])
NOTHING: Read = (np.zeros(0, np.intp), np.zeros((0, 2)))


class BoardReader:
    """Reads a board in grey images; learns from them how it is printed. Used by one thread."""

    quick_from_px = 0.0
    """The narrow side of a square from which a quick search finds as much as a full one."""

    def __init__(self, board: Board) -> None:
        """Reads `board` as it is given."""
        self.board = board
        """As it is known to be printed so far."""
        self.settled = True
        """Whether that will stay."""
        self.confused = False
        """Whether the last image showed two boards that cannot be told apart."""
        self.exact = False
        """Whether the points need no refinement by windows around each."""
        self.centroids: Array | None = None
        """(N, 2) the centroids of the discs whose centres were just read, pixels; see `discs`."""
        self.weighing = False
        """Whether this has seen an image from which it learns; of copies."""
        self.is_copy = False

    def copy(self: Reader) -> Reader:
        """A reader for another thread, for images in any order: it searches as well as it can, and
        does not follow the board from one image to the next."""
        other = copy.copy(self)
        other.weighing, other.is_copy = False, True
        return other

    def read(self, grey: Grey, region: Region, quick: int) -> Read:
        """The board's points in a region of an image (H, W); none if it is not there. `quick`: see
        `Detector.detect`."""
        raise NotImplementedError

    def adopt(self, board: Board) -> None:
        """Read this board from now on."""
        self.board = board

    def seen_otherwise(self, ids: NDArray[np.intp], corners: Array) -> Board | None:
        """The board that the last image shows instead, if it was found, but not as it is."""
        del ids, corners
        return None

    def take_over(self, by: BoardReader) -> None:
        """What a copy has learnt."""

    def notes(self, asked: Board) -> tuple[str, ...]:
        """Sentences on harmless differences from the board asked for."""
        del asked
        return ()

    def diagnoses(self, asked: Board) -> list[Diagnosis]:
        """How the board differs from the one asked for."""
        del asked
        return []


class WholeBoardReader(BoardReader):
    """Reads a board that is seen as a whole or not at all, and follows it from image to image."""

    def __init__(self, board: Board) -> None:
        """Nothing seen yet."""
        super().__init__(board)
        self.exact = True
        self._last: tuple[Grey, Array] | None = None
        """The last image, and the points in it: (R, C, 2)."""
        self._across = _UPRIGHT
        """The direction of its rows."""

    def copy(self: WholeReader) -> WholeReader:
        """Without a last image."""
        other = super().copy()
        other._last, other._across = None, _UPRIGHT
        return other

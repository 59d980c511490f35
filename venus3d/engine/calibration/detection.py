"""From an image to an observation of the board: corners, their ids, sharpness.

A reader of the board's kind finds the points (`board_reader`); here they are refined and judged,
and images without the board are kept, to find out what they show. Subpixel corners: `refinement`.
"""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_diagnoses import missing_rows_diagnosis
from venus3d.engine.calibration.board_finding import FoundBoard
from venus3d.engine.calibration.board_reader import BoardReader, Grey, Region
from venus3d.engine.calibration.board_recognition import BoardRecognition, best_finding
from venus3d.engine.calibration.charuco_reader import CharucoReader
from venus3d.engine.calibration.chessboard_reader import ChessboardReader
from venus3d.engine.calibration.circle_reader import CircleReader
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.calibration.refinement import (
    edge_sharpness,
    local_scales,
    refine_corners,
    refinement_windows,
)
from venus3d.engine.calibration.second_board import second_board, told_by
from venus3d.engine.calibration.shifted_rows import ShiftedRows, rows_missing, shifted_board
from venus3d.engine.calibration.small_boards import small_board
from venus3d.engine.calibration.tag_reader import TagReader
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

# Number of whole images without the board kept for `explain_misses`: the first and the last ones.
_KEPT_MISSED = 3
_MARGIN, _LEAST_MARGIN_PX = 0.35, 48
"""Of a search region: as a share of the corners' extent, on each side."""
Beside = FoundBoard | Board
"""Another board beside the one detected, or that one with another first id."""


def reader_of(board: Board, *, find_layout: bool = True) -> BoardReader:
    """What reads boards of this kind."""
    if board.kind == "charuco":
        return CharucoReader(board, find_layout=find_layout)
    if board.kind == "chessboard":
        return ChessboardReader(board)
    if board.of_kind.radius(board) > 0:
        return CircleReader(board)
    return TagReader(board, 2 if board.kind == "aprilgrid" else 1, find_layout=find_layout)


class Detector:
    """Finds one board in images. Used by one thread; learns the board's layout as it goes.
    Other threads can look for it with a `copy` each, and hand what they saw to `take_over`."""

    def __init__(self, board: Board, *, find_layout: bool = True, refine: bool = True) -> None:
        """A detector for `board`.

        Args:
            find_layout: detect whether the board is printed in the other layout, or inverted.
            refine: refine a ChArUco board's corners in windows that follow the local size of a
                square; the other kinds' readers measure their points themselves.
        """
        self._asked = board
        self._reader = reader_of(board, find_layout=find_layout)
        self._refine = refine
        self._find_layout = find_layout
        self.square_px = 0.0
        """The narrow side of the smallest square in the last image with the board, pixels."""
        self._check = BoardRecognition(board)
        self._missed: deque[Grey] = deque(maxlen=_KEPT_MISSED)
        self._first_missed: list[Grey] = []
        self._beside: Diagnosis | None = None
        self._rows = ShiftedRows()

    @property
    def board(self) -> Board:
        """The board with the layout and polarity seen so far."""
        return self._reader.board

    @property
    def settled(self) -> bool:
        """Whether enough frames agree on the board's layout and first id, which then stay."""
        return self._reader.settled and not self._may_be_shifted

    @property
    def quick_from_px(self) -> float:
        """The narrow side of a square from which a quick search finds as much, pixels."""
        return self._reader.quick_from_px

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on harmless differences between the board and the one given."""
        return self._reader.notes(self._asked)

    @property
    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """Another board in the images, instead of the one given or beside it, or another layout,
        first id or marker size than given."""
        others = [one for one in (self._check.diagnosis, self._beside) if one is not None]
        return tuple(dict.fromkeys((*others, *self._reader.diagnoses(self._asked))))

    @property
    def missed_images(self) -> tuple[Grey, ...]:
        """The first and the last whole images (H, W) in which the board was not found."""
        return (*self._first_missed, *self._missed)

    def look_beside(self, image: Any, seen: Observation) -> Beside | None:
        """Another board in an image in which the board was `seen`, or that it has rows which are
        not read; some 0.15 s at 720p; from any thread."""
        board, grey = seen.board or self.board, _grey(image)
        try:
            shifted = shifted_board(board, grey) if rows_missing(board, seen.ids) else None
            return shifted or second_board(board, seen, grey)
        except cv2.error:  # a search for what nobody asked for ends nothing
            return None

    def note_beside(self, looks: Sequence[Beside | None]) -> None:
        """What some images show beside the board, each by `look_beside`: a diagnosis from now on,
        until the next call; from any thread."""
        board = self.board
        shifted = [one for one in looks if isinstance(one, Board)]
        shifted = [one for one in shifted if one.first_id != board.first_id]
        if shifted and self._rows.are_possible:
            self._beside = missing_rows_diagnosis(board, shifted[-1])
        else:
            self._beside = told_by([one for one in looks if isinstance(one, FoundBoard)])

    def explain_misses(self) -> tuple[Diagnosis, ...]:
        """What images without the board show instead; may take a second. A board that can be read
        is read from now on: detect in all images again if `board` has changed."""
        finding = best_finding(self.board, self.missed_images)
        if finding is None:
            small = small_board(self.board, self.missed_images, self.copy().detect)
            return () if small is None else (small,)
        if finding.board is not None and self._find_layout:
            self._adopt(finding.board)
        return (finding.diagnosis,)

    def _adopt(self, board: Board) -> None:
        """Read this board from now on, in whichever layout."""
        self._reader.adopt(board)
        self._rows = ShiftedRows()
        self._check = BoardRecognition(board)
        self._missed, self._first_missed = deque(maxlen=_KEPT_MISSED), []

    def copy(self) -> Detector:
        """A detector for another thread, as this one is now: for one image until the layout is
        settled, then for any number."""
        other = copy.copy(self)
        other._reader = self._reader.copy()
        return other

    def take_over(self, seen: Observation, image: Any, by: Detector) -> Observation:
        """What `by`, a `copy`, saw in an image (see `detect`), as if it had been detected here:
        called in the order of the images, the copies give the same as one detector."""
        self._reader.take_over(by._reader)
        if by._reader.weighing or (seen.count and self._may_be_shifted):
            # It is evidence for a layout or a first id, which is weighed here.
            return self.detect(image, time_s=seen.time_s, name=seen.name)
        if seen.count:
            self._check.found()
            self._rows.seen(self.board, seen.ids)
        else:
            self._miss(_grey(image))
        return replace(seen, board=self.board, board_diagnoses=self.diagnoses)

    def detect(
        self,
        image: Any,
        *,
        region: Region | None = None,
        quick: int = 0,
        time_s: float = 0.0,
        name: str = "",
    ) -> Observation:
        """The observation of the board in an image; empty without four non-collinear corners.

        Args:
            image: (H, W) grey or (H, W, 3) BGR, 8 or 16 bit.
            region: the part to search; corners are in pixels of the whole image.
            quick: 0: search as well as can be. n: with one threshold only, and where it helps in an
                image n times smaller; finds as much in a sharp image whose squares have n times
                `quick_from_px`, less in a blurred one.
            time_s, name: passed on to the observation.

        Raises:
            VenusError: the image is neither grey nor BGR, 8 or 16 bit.
        """
        observation = self._observed(image, region, quick)
        return replace(
            observation,
            time_s=time_s,
            name=name,
            board=self.board,
            board_diagnoses=self.diagnoses,
        )

    def _observed(self, image: Any, region: Region | None, quick: int) -> Observation:
        grey = _grey(image)
        size = (grey.shape[1], grey.shape[0])
        part = x0, y0, x1, y1 = _clipped(region, size)
        nothing = Observation.nothing(size)
        if x0 >= x1 or y0 >= y1:
            return nothing
        reader = self._reader
        ids, corners = reader.read(grey, part, quick)
        if reader.confused:
            return nothing
        if not determines_homography(self.board.points_of(ids)):
            if region is None and not quick and not reader.is_copy:
                self._miss(grey)
            return nothing
        otherwise = reader.seen_otherwise(ids, corners)
        if otherwise is not None:
            # The images in which the board was missed may yet show that even this is misread.
            missed = self._missed, self._first_missed
            self._adopt(otherwise)
            self._missed, self._first_missed = missed
            return self._observed(image, region, quick)
        if not reader.is_copy:
            self._check.found()
            self._rows.seen(self.board, ids)
            shifted = shifted_board(self.board, grey) if self._may_be_shifted else None
            if shifted is not None:
                self._adopt(shifted)
                return self._observed(image, region, quick)
        scales = local_scales(self.board, ids, corners)
        if self._refine and not reader.exact:
            windows = refinement_windows(self.board, scales, corners)
            corners = refine_corners(self.board, ids, grey, corners, windows)
        squares = np.linalg.norm(scales, axis=1).min(axis=1) * self.board.square
        self.square_px = float(squares.min())
        # A disc's nearest edge is its rim.
        edges = corners + scales[:, :, 0] * self.board.of_kind.radius(self.board)
        sharpness = edge_sharpness(grey, edges, squares)
        return Observation(ids, corners, size, sharpness=sharpness, centroids=reader.centroids)

    @property
    def _may_be_shifted(self) -> bool:
        return self._find_layout and self._rows.are_looked_for

    def _miss(self, grey: Grey) -> None:
        if len(self._first_missed) < _KEPT_MISSED:
            self._first_missed.append(grey)
        else:
            self._missed.append(grey)
        self._check.missed(grey)
        if self._check.readable is not None and not self.settled:
            self._adopt(self._check.readable)


def search_region(observation: Observation, image_size: tuple[int, int]) -> Region | None:
    """The region to search in the next frame, of this (width, height): around the corners of the
    last frame's observation, grown on all sides.

    Where the board is seen in part, the rest of it belongs to the region. Returns None if nothing
    was seen or a region saves nothing: search the whole image.
    """
    if observation.count == 0 or observation.image_size != image_size:
        return None
    corners = _whole_board(observation)
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = max(_LEAST_MARGIN_PX, _MARGIN * float((high - low).max()))
    x0, y0 = np.floor(low - margin).astype(int)
    x1, y1 = np.ceil(high + margin).astype(int) + 1
    region = _clipped((int(x0), int(y0), int(x1), int(y1)), image_size)
    area = (region[2] - region[0]) * (region[3] - region[1])
    return region if area < 0.8 * image_size[0] * image_size[1] else None


def _whole_board(observation: Observation) -> Array:
    """(N, 2) the corners seen, and where the board's others are about, pixels."""
    board, corners = observation.board, observation.corners
    if board is None or observation.count >= board.corner_count:
        return corners
    H, _ = cv2.findHomography(board.points_of(observation.ids)[:, :2], corners)
    if H is None:
        return corners
    flat = np.column_stack([board.corners[:, :2], np.ones(board.corner_count)])
    image = flat @ np.asarray(H, dtype=np.float64).T
    image = image[image[:, 2] * np.median(image[observation.ids, 2]) > 0]
    width, height = observation.image_size
    others = np.clip(image[:, :2] / image[:, 2:], 0, [width - 1, height - 1])
    return np.concatenate([corners, others])


def _grey(image: Any) -> Grey:
    """(H, W) grey, 8 bit."""
    picture: NDArray[Any] = np.asarray(image)
    if picture.ndim == 3 and picture.shape[2] == 1:
        picture = picture[:, :, 0]
    colour = picture.ndim == 3 and picture.shape[2] == 3
    if picture.dtype not in (np.uint8, np.uint16) or not (colour or picture.ndim == 2):
        raise VenusError(
            f"An image must be grey or BGR with 8 or 16 bits, not {picture.dtype} of shape "
            f"{picture.shape}; convert it first."
        )
    if picture.size == 0:
        raise VenusError("This image has no pixels; check that it was read completely.")
    if colour:
        picture = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    if picture.dtype == np.uint16:
        # A 10 or 12 bit camera uses the lower bits only: stretch by the largest value.
        peak = max(int(picture.max()), 1)
        picture = np.rint(picture * (255.0 / peak)).astype(np.uint8)
    return np.ascontiguousarray(picture, dtype=np.uint8)


def _clipped(region: Region | None, size: tuple[int, int]) -> Region:
    if region is None:
        return (0, 0, *size)
    x0, y0, x1, y1 = region
    return (max(0, x0), max(0, y0), min(size[0], x1), min(size[1], y1))

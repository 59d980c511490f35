"""Reads grids of tags: each tag found gives its four corners."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_diagnoses import (
    first_id_diagnosis,
    tag_size_diagnosis,
    two_boards_diagnosis,
)
from venus3d.engine.calibration.board_reader import NOTHING, BoardReader, Grey, Read, Region
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.following import Follower
from venus3d.engine.calibration.marker_lattice import lattices_of
from venus3d.engine.calibration.marker_numbering import numbered_otherwise
from venus3d.engine.calibration.marker_reading import Markers, shows_twice
from venus3d.engine.calibration.tag_completion import completed
from venus3d.engine.calibration.tag_edges import bends_of, corners_by_edges
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

_QUICK_FROM_PX = 40.0
_QUICK_WINDOW_PX = 7
_JOINED_WINDOW_PX, _OF_CONTRAST = 15, 0.16
"""Where black squares touch the tags' corners, the two come apart only if what counts as black is
darker than around it by a share of the difference of white and black. On 54 pictures (three lenses,
two blurs, three contrasts) OpenCV's three windows with 7 grey levels found 1705 tags, one of 15 px
with 0.14 to 0.17 of the contrast 1915 to 1968, both 2095 to 2106; with 0.1 and 0.2 fewer."""
_OF_OUTLINE = 0.4
"""Outlines are counted in steps to any of eight neighbours, diagonally 0.7 of their length; a tag
may have become smaller since. Shorter outlines, most of them cells of tags, are not looked into: a
third of the time, and no tag is lost."""
_OF_CLEARANCE, _LARGEST_WINDOW = 0.75, 10
_CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 0.003)
_BORDER_PX = 1.0
"""Corners nearer to the border are not measured: the tag may go on outside."""
_ASTRAY = 2
"""Tags out of place that another numbering explains with all others; a misread tag is one."""
_FEW, _TIMES_AS_MANY = 0.25, 3
"""Share of a board's tags up to which the mirror image is searched as well, and how many times as
many must be in that."""
_MEASURED, _FEWEST_PAIRS = 3, 8
"""Pictures in which the tags are measured, and pairs of neighbours that each must show."""
_FRAMES_AT_MOST = 12
"""Pictures after which it is too late to measure them."""
OTHER_SIZE = 0.03
"""Tags measured this far from the size given, by a share of it, are read in the size measured."""


class TagReader(BoardReader):
    """OpenCV's detector of markers, told the board's border and its tags alone."""

    quick_from_px = _QUICK_FROM_PX

    def __init__(self, board: Board, border: int, *, find_layout: bool = True) -> None:
        """`border`: width of the tags' black border, in cells. `find_layout`: see `Detector`."""
        super().__init__(board)
        self._border = border
        self.exact = True
        self.settled = not find_layout
        self._measured: list[float] = []
        self._frames = 0
        self._finders: dict[tuple[Board, bool, bool], Any] = {}
        self._two_boards = False
        self._follower = Follower(each=4)

    def copy(self) -> TagReader:
        """With detectors of its own."""
        other = super().copy()
        other._finders, other._measured, other._frames = {}, [], 0
        other._follower = Follower(each=4)
        return other

    def adopt(self, board: Board) -> None:
        """Read this board from now on."""
        super().adopt(board)
        self._follower = Follower(each=4)

    def take_over(self, by: BoardReader) -> None:
        """Whether a copy saw two boards."""
        if isinstance(by, TagReader):
            self._two_boards |= by._two_boards

    def diagnoses(self, asked: Board) -> list[Diagnosis]:
        """Two boards; another first id or size of the tags than given."""
        found = [two_boards_diagnosis()] if self._two_boards else []
        if self.board.first_id != asked.first_id:
            found.append(first_id_diagnosis(self.board))
        if self.board.marker != asked.marker:
            found.append(tag_size_diagnosis(asked, self.board))
        return found

    def seen_otherwise(self, ids: NDArray[np.intp], corners: Array) -> Board | None:
        """The board with the size of the tags as it is seen in the first pictures, if that is
        another one. What is left of the difference, a calibration finds (`board_shape`)."""
        if self.settled:
            return None
        self.weighing = True
        self._frames += 1
        share = tag_share(self.board, ids, corners)
        if share is not None:
            self._measured.append(share)
        self.settled = len(self._measured) >= _MEASURED or self._frames >= _FRAMES_AT_MOST
        if len(self._measured) < _MEASURED:
            return None
        marker = round(float(np.median(self._measured)) * self.board.square, 5)  # 0.01 mm
        if abs(marker / self.board.marker - 1) < OTHER_SIZE or not 0 < marker < self.board.square:
            return None
        return replace(self.board, marker=marker)

    def read(self, grey: Grey, region: Region, quick: int) -> Read:
        """The corners of the tags that are seen once."""
        followed = self._follower.followed(grey, region) if quick else None
        if followed is None:
            tags, quads = self._found(grey, region, quick)
        else:
            tags, quads = followed[0][::4] // 4, followed[1].reshape(-1, 4, 2)
        if not tags.size:
            return NOTHING
        quads = self._at(grey, quads, tags)
        inside = _inside(grey, quads)
        if not inside.any():
            return NOTHING
        ids = (4 * tags[inside, None] + np.arange(4)).reshape(-1).astype(np.intp)
        corners = quads[inside].reshape(-1, 2)
        if followed is not None:
            self._follower.measured(grey, ids, corners)
        elif not (self.is_copy or self.confused):
            self._follower.found(grey, ids, corners)
        return ids, corners

    def _found(self, grey: Grey, region: Region, quick: int) -> tuple[NDArray[np.intp], Array]:
        """The tags (N,) ascending and their outlines' corners (N, 4, 2), pixels."""
        x0, y0, x1, y1 = region
        part = grey[y0:y1, x0:x1]
        ids, quads = self._searched(part, quick > 0)
        if self._border > 1 and not quick and len(np.unique(ids)) < self.board.marker_count:
            ids, quads = _joined(ids, quads, *self._searched(part, False, quads))
        self.confused = False
        if not ids.size:
            return ids, quads
        tags, first, counts = np.unique(ids, return_index=True, return_counts=True)
        self.confused = shows_twice(ids)
        self._two_boards |= self.confused
        once = counts == 1
        found = quads[first[once]]
        mirrored = not quick and self._is_mirrored(part, tags.size)
        if mirrored or self._is_another(tags[once], found):
            return np.zeros(0, np.intp), np.zeros((0, 4, 2))
        found, tags = found + np.array([x0, y0]), tags[once]
        if self.confused or tags.size == self.board.marker_count:
            return tags, found
        return completed(grey, self.board, self._border, tags, found, partial(self._at, grey))

    def _at(self, grey: Grey, quads: Array, tags: NDArray[np.intp] | None = None) -> Array:
        """(N, 4, 2) the corners of tags with outlines near them; `tags` (N,): bent by the lens."""
        bends = None
        if tags is not None and self._border == 1:
            points = self.board.of_kind.points(self.board).reshape(-1, 4, 2)[tags]
            bends = partial(bends_of, points)
        found = corners_by_edges(grey, quads, self._clear_share, bends)
        inside = _inside(grey, found)
        if inside.any():
            found[inside] = self._refined(grey, found[inside]).reshape(-1, 4, 2)
        return found

    def _searched(
        self, grey: Grey, quick: bool, before: Array | None = None
    ) -> tuple[NDArray[np.intp], Array]:
        """The ids (N,) and outlines (N, 4, 2) of the markers in an image (H, W) by one search.
        `before`: the outlines found by OpenCV's own thresholds; search now by the contrast there.
        """
        by_contrast = self._border > 1 and (quick or before is not None)
        key = self.board, quick, by_contrast
        if key not in self._finders:
            self._finders[key] = _finder(self.board, self._border, quick, by_contrast)
        finder = self._finders[key]
        if quick or by_contrast:
            parameters = finder.getDetectorParameters()
            if quick:
                parameters.minMarkerPerimeterRate = self._least_outline_px / max(grey.shape)
            if by_contrast:
                parameters.adaptiveThreshConstant = _OF_CONTRAST * _contrast(grey, before)
            finder.setDetectorParameters(parameters)
        quads, ids, _ = finder.detectMarkers(grey)
        if ids is None:
            return np.zeros(0, np.intp), np.zeros((0, 4, 2))
        found = np.asarray(quads, dtype=np.float64).reshape(-1, 4, 2)
        return np.asarray(ids, dtype=np.intp).reshape(-1), found

    def _is_mirrored(self, grey: Grey, count: int) -> bool:
        """Whether the few tags found are there by chance, as the image (H, W) is a mirror image: of
        a grid of 4 x 4 cells, a sixth of the tags look like others of it."""
        if count > _FEW * self.board.marker_count:
            return False
        ids, _ = self._searched(np.ascontiguousarray(grey[:, ::-1]), False)
        return len(np.unique(ids)) > _TIMES_AS_MANY * count

    def _is_another(self, tags: NDArray[np.intp], quads: Array) -> bool:
        """Whether the tags (N,) are in order as on a board of other columns or another first id:
        by how they lie from neighbour to neighbour, seen alike by any lens."""
        found = lattices_of(Markers(self.board.dictionary, tags, quads))
        if not found or found[0].arrangement != "grid":
            return False
        return numbered_otherwise(self.board, found[0]) >= _ASTRAY

    @property
    def _least_outline_px(self) -> float:
        """Pixels along the outline of the smallest tag that a quick search must find."""
        side = self.quick_from_px * self.board.marker / self.board.square
        return _OF_OUTLINE * 4 * side

    @property
    def _clear_share(self) -> float:
        return self.board.of_kind.clearance(self.board) / self.board.marker

    def _refined(self, grey: Grey, quads: Array) -> Array:
        """(4 N, 2) corners. Where black squares touch a tag's corners, OpenCV's outlines run into
        them by some pixels, so that the edges were found anew; there cornerSubPix is better still,
        in a window as wide as that of the smallest tag may be."""
        if self._border == 1:
            return quads.reshape(-1, 2)
        sides = np.linalg.norm(quads - np.roll(quads, 1, axis=1), axis=2)
        half = int(np.clip(_OF_CLEARANCE * self._clear_share * sides.min(), 2, _LARGEST_WINDOW))
        start = quads.astype(np.float32).reshape(-1, 1, 2)
        moved = cv2.cornerSubPix(grey, start.copy(), (half, half), (-1, -1), _CRITERIA)
        return np.asarray(moved, dtype=np.float64).reshape(-1, 2)


def tag_share(board: Board, ids: NDArray[np.intp], corners: Array) -> float | None:
    """Side of the tags over the distance from one to the next, as a picture shows it: of tags side
    by side, seen alike by any lens; None if too few are."""
    tags = ids[::4] // 4
    quads = corners.reshape(-1, 4, 2)
    H, _ = cv2.findHomography(corners, board.points_of(ids)[:, :2])
    if H is None:
        return None
    flat = cv2.perspectiveTransform(quads.reshape(1, -1, 2), H).reshape(-1, 4, 2)
    places = {
        (int(tag) % board.columns, int(tag) // board.columns): n for n, tag in enumerate(tags)
    }
    shares: list[float] = []
    for (column, row), n in places.items():
        for across, beside in ((True, (column + 1, row)), (False, (column, row + 1))):
            k = places.get(beside)
            if k is None:
                continue
            apart = np.linalg.norm(flat[k].mean(axis=0) - flat[n].mean(axis=0))
            sides = [
                flat[i][[1, 2]] - flat[i][[0, 3]] if across else flat[i][[3, 2]] - flat[i][[0, 1]]
                for i in (n, k)
            ]
            shares.append(float(np.linalg.norm(np.concatenate(sides), axis=1).mean() / apart))
    return float(np.median(shares)) if len(shares) >= _FEWEST_PAIRS else None


def _inside(grey: Grey, quads: Array) -> NDArray[np.bool_]:
    """(N,) which of the tags at (N, 4, 2) lie within an image (H, W), its border excepted."""
    limit = np.array(grey.shape[::-1]) - 1 - _BORDER_PX
    return np.asarray(((quads > _BORDER_PX) & (quads < limit)).all(axis=(1, 2)))


def _joined(
    ids: NDArray[np.intp], quads: Array, more_ids: NDArray[np.intp], more_quads: Array
) -> tuple[NDArray[np.intp], Array]:
    """The markers of two searches of one image; those found by both once."""
    apart = np.linalg.norm(more_quads.mean(axis=1)[:, None] - quads.mean(axis=1), axis=2)
    side = np.linalg.norm(more_quads[:, 1] - more_quads[:, 0], axis=1)
    again = (more_ids[:, None] == ids) & (apart < side[:, None])
    new = ~again.any(axis=1)
    return np.concatenate([ids, more_ids[new]]), np.concatenate([quads, more_quads[new]])


def _contrast(grey: Grey, quads: Array | None) -> float:
    """Grey levels from black to white, by those of an image (H, W) where the outlines (N, 4, 2) are
    or, without any, of all of it."""
    if quads is not None and len(quads):
        x0, y0 = np.maximum(quads.min(axis=(0, 1)), 0).astype(int)
        x1, y1 = quads.max(axis=(0, 1)).astype(int) + 1
        grey = grey[y0:y1, x0:x1]
    low, high = np.percentile(grey[::4, ::4], (2, 98))
    return float(high - low)


def _finder(board: Board, border: int, quick: bool, by_contrast: bool) -> Any:
    parameters = cv2.aruco.DetectorParameters()
    parameters.markerBorderBits = border
    if quick or by_contrast:
        window = _JOINED_WINDOW_PX if by_contrast else _QUICK_WINDOW_PX
        parameters.adaptiveThreshWinSizeMin = parameters.adaptiveThreshWinSizeMax = window
    return cv2.aruco.ArucoDetector(board.cv_dictionary, parameters)

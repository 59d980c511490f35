"""Reads ChArUco boards: OpenCV finds markers and corners, and the layout and polarity in which the
board is printed are found out; see `detection` for what all kinds have in common."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_diagnoses import (
    first_id_diagnosis,
    marker_size_diagnosis,
    two_boards_diagnosis,
)
from venus3d.engine.calibration.board_reader import NOTHING, BoardReader, Grey, Read, Region
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.following import Follower
from venus3d.engine.calibration.marker_lattice import side_of
from venus3d.engine.calibration.marker_reading import shows_twice
from venus3d.engine.calibration.observation import determines_homography
from venus3d.engine.calibration.refinement import (
    by_corner_sub_pix,
    local_scales,
    refinement_windows,
)
from venus3d.engine.calibration.thin_borders import thin_border_diagnosis
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array
from venus3d.engine.sentences import Sentence

# Evidence for a layout: this many frames with corners, one reading ahead by this many corners.
_FRAMES_TO_SETTLE = 3
_FRAMES_AT_MOST = 12
_LEAD = 2.0
# OpenCV searches markers with three threshold windows (3, 13 and 23 px). A single one of 7 px takes
# less than half the time, and finds as much where a square's narrow side has this many pixels: no
# corner of 5985 was lost on real recordings, none of 2262 on simulated tilted boards
# (docs/method.md). Smaller squares need all three.
QUICK_FROM_PX = 40.0
_QUICK_WINDOW_PX = 7
_FEWEST_MEASURED = 8
_OTHER_MARKER = 0.08
"""Share by which a marker's size as seen and as given differ, above which the one seen is right. On
boards given rightly a picture measures it to 2 %."""
_NEAR_PX = 1.0
"""Farthest that a corner may be from where it was carried to, pixels."""

_WHITE_ON_BLACK = Sentence(
    "The board is printed white on black, not black on white; it is read that way."
)
_BLACK_ON_WHITE = Sentence(
    "The board is printed black on white, not white on black; it is read that way."
)
_OLD_LAYOUT = (
    Sentence(
        "The board is printed in the layout used before OpenCV 4.6 (legacy is on), not in the one "
        "asked for; it is read that way."
    ),
    Sentence("Start with --board.legacy to be sure."),
)
_NEW_LAYOUT = (
    Sentence(
        "The board is printed in the layout used since OpenCV 4.6 (legacy is off), not in the one "
        "asked for; it is read that way."
    ),
    Sentence("Leave out --board.legacy to be sure."),
)


class CharucoReader(BoardReader):
    """Compares the ways in which a board may be printed, until enough images agree on one."""

    quick_from_px = QUICK_FROM_PX

    def __init__(self, board: Board, *, find_layout: bool = True) -> None:
        """`find_layout`: see `Detector`."""
        super().__init__(board)
        self.settled = not find_layout
        self._finders: dict[tuple[Board, bool], Any] = {}
        self._small_finders: dict[Board, Any] = {}
        self._evidence: dict[Board, int] = dict.fromkeys(_readings(board), 0)
        self._frames = 0
        self._markers: Any = None
        self._two_boards = False
        self._follower = Follower()

    def copy(self) -> CharucoReader:
        """Reads one image until the layout is settled, then any number."""
        other = super().copy()
        other._finders, other._small_finders = {}, {}
        other._follower = Follower()
        other._evidence = dict(self._evidence)
        other._frames = 0
        return other

    def take_over(self, by: BoardReader) -> None:
        """Whether a copy saw two boards."""
        if isinstance(by, CharucoReader):
            self._two_boards |= by._two_boards

    def notes(self, asked: Board) -> tuple[str, ...]:
        """On the polarity."""
        if self.board.inverted == asked.inverted:
            return ()
        return (_WHITE_ON_BLACK if self.board.inverted else _BLACK_ON_WHITE,)

    def diagnoses(self, asked: Board) -> list[Diagnosis]:
        """Two boards; another layout, first id or marker size than given; thin borders."""
        found = [two_boards_diagnosis()] if self._two_boards else []
        if self.board.legacy != asked.legacy:
            found.append(
                Diagnosis("wrong-layout", *(_OLD_LAYOUT if self.board.legacy else _NEW_LAYOUT))
            )
        if self.board.first_id != asked.first_id:
            found.append(first_id_diagnosis(self.board))
        if self.board.marker != asked.marker:
            found.append(marker_size_diagnosis(asked, self.board))
        thin = thin_border_diagnosis(self.board) if self._frames else None
        return found if thin is None else [*found, thin]

    def adopt(self, board: Board) -> None:
        """Read this board from now on, in whichever layout."""
        super().adopt(board)
        self._follower = Follower()
        self.settled, self._frames, self.weighing = False, 0, False
        self._evidence = dict.fromkeys(_readings(board), 0)

    def read(self, grey: Grey, region: Region, quick: int) -> Read:
        """The corners of the presumed board; compares readings until settled."""
        followed = self._followed(grey, region) if quick else None
        self.exact = followed is not None
        if followed is not None:
            return followed
        x0, y0, x1, y1 = region
        self._markers = None
        ids, corners = self._found(grey[y0:y1, x0:x1], quick)
        corners = corners + np.array([x0, y0])
        self.confused = self._shows_two_boards()
        if not (self.is_copy or self.confused):
            self._follower.found(grey, ids, corners)
        return ids, corners

    def _followed(self, grey: Grey, region: Region) -> Read | None:
        """The last image's corners, by cornerSubPix alone: where they were carried to is too smooth
        to be a first opinion. None if one of them is not near there."""
        followed = self._follower.followed(grey, region)
        if followed is None:
            return None
        ids, near = followed
        windows = refinement_windows(self.board, local_scales(self.board, ids, near), near)
        corners = by_corner_sub_pix(grey, near, windows)
        moved = np.linalg.norm(corners - near, axis=1)
        if not ((moved > 0) & (moved < _NEAR_PX)).all():  # one that is not measured stays
            return None
        self._follower.measured(grey, ids, corners)
        return ids, corners

    def _found(self, grey: Grey, quick: int) -> Read:
        if self.settled:
            markers = self._markers_in_small(grey, quick) if quick > 1 else None
            if quick > 1 and markers is None:
                return NOTHING
            ids, corners, _ = self._detect_board(self.board, grey, markers, quick=quick > 0)
            return ids, corners
        found: dict[Board, Read] = {}
        for inverted in (self.board.inverted, not self.board.inverted):
            markers: Any = None
            for board in self._evidence:
                if board.inverted == inverted:
                    ids, corners, markers = self._detect_board(board, grey, markers)
                    found[board] = (ids, corners)
            if any(ids.size for ids, _ in found.values()):
                break  # a board has one polarity: the other would give nothing
        # A few corners in a row may be those of another board, with some of its markers.
        if any(determines_homography(board.points_of(ids)) for board, (ids, _) in found.items()):
            self._weigh({board: ids.size for board, (ids, _) in found.items()})
        return found.get(self.board, NOTHING)

    def seen_otherwise(self, ids: NDArray[np.intp], corners: Array) -> Board | None:
        """The board with the size of the markers as it is seen, if that is quite another."""
        if self.settled or not determines_homography(self.board.points_of(ids)):
            return None
        square = self.board.square
        share = _marker_share(self.board, ids, corners, self._markers)
        if share is None or abs(share * square / self.board.marker - 1) < _OTHER_MARKER:
            return None
        marker = round(2000 * share * square) / 2000  # to half a millimetre
        if not 0 < marker < square or marker == self.board.marker:
            return None
        return replace(self.board, marker=marker)

    def _shows_two_boards(self) -> bool:
        """Whether several of the markers just found are there twice."""
        if self._markers is None:
            return False
        twice = shows_twice(self._markers[1])
        self._two_boards |= twice
        return twice

    def _weigh(self, counts: dict[Board, int]) -> None:
        """Add a frame's evidence: the right reading finds more corners over several frames.
        The wrong one finds some too, even with a lower reprojection error: neither is proof."""
        self._frames += 1
        self.weighing = True
        for board, count in counts.items():
            self._evidence[board] += count
        # The first of equals wins, and the board as given comes first.
        self.board = max(self._evidence, key=lambda board: self._evidence[board])
        best, *others = sorted(self._evidence.values(), reverse=True)
        clear = all(best >= _LEAD * other for other in others)
        self.settled = self._frames >= (_FRAMES_TO_SETTLE if clear else _FRAMES_AT_MOST)

    def _markers_in_small(self, grey: Grey, times: int) -> Any:
        """The markers as in `grey`, but found in a picture so many times smaller; None if there are
        none. The corners are then found in `grey` itself."""
        height, width = (side // times for side in grey.shape)
        whole = grey[: height * times, : width * times]
        small = np.asarray(
            cv2.resize(whole, (width, height), interpolation=cv2.INTER_AREA), np.uint8
        )
        board = self.board
        if board not in self._small_finders:
            dictionary = board.cv_board.getDictionary()
            finder = cv2.aruco.ArucoDetector(dictionary, _parameters(quick=True))
            self._small_finders[board] = finder
        picture = 255 - small if board.inverted else small
        quads, ids, _ = self._small_finders[board].detectMarkers(picture)
        if ids is None or len(ids) == 0:
            return None
        return [((quad + 0.5) * times - 0.5).astype(np.float32) for quad in quads], ids

    def _detect_board(
        self, board: Board, grey: Grey, markers: Any = None, *, quick: bool = False
    ) -> tuple[NDArray[np.intp], Array, Any]:
        """Ids (N,) ascending, corners (N, 2), and the markers, which another layout can reuse.

        OpenCV 4 gives (N, 1, 2) and (N, 1), OpenCV 5 (N, 2) and (N,); both None or empty if none.
        """
        if (board, quick) not in self._finders:
            self._finders[board, quick] = _finder(board, quick)
        picture = 255 - grey if board.inverted else grey
        known = () if markers is None else (None, None, *markers)
        corners, ids, marker_corners, marker_ids = self._finders[board, quick].detectBoard(
            picture, *known
        )
        seen = (marker_corners, marker_ids) if marker_ids is not None and len(marker_ids) else None
        if seen is not None:
            self._markers = seen
        if ids is None or len(ids) == 0:
            return np.zeros(0, np.intp), np.zeros((0, 2)), seen
        numbers = np.asarray(ids, dtype=np.intp).reshape(-1)
        pixels = np.asarray(corners, dtype=np.float64).reshape(-1, 2)
        order = np.argsort(numbers)
        return numbers[order], pixels[order], seen


def _marker_share(
    board: Board, ids: NDArray[np.intp], corners: Array, markers: Any
) -> float | None:
    """Side of the markers over that of a square, as seen; None if too little is seen."""
    if markers is None or len(markers[1]) < _FEWEST_MEASURED or ids.size < _FEWEST_MEASURED:
        return None
    H, _ = cv2.findHomography(corners, board.points_of(ids)[:, :2])
    if H is None:
        return None
    quads = np.asarray(markers[0], dtype=np.float64).reshape(-1, 4, 2)
    return side_of(quads, np.asarray(H, dtype=np.float64)) / board.square


def _finder(board: Board, quick: bool) -> Any:
    charuco = cv2.aruco.CharucoParameters()
    return cv2.aruco.CharucoDetector(board.cv_board, charuco, _parameters(quick=quick))


def _parameters(*, quick: bool) -> cv2.aruco.DetectorParameters:
    parameters = cv2.aruco.DetectorParameters()
    if quick:
        parameters.adaptiveThreshWinSizeMin = parameters.adaptiveThreshWinSizeMax = _QUICK_WINDOW_PX
    return parameters


def _readings(board: Board) -> list[Board]:
    """The board as given, then the other ways in which it may be printed."""
    # With an odd row count both layouts are the same board.
    layouts = (board.legacy, not board.legacy) if board.rows % 2 == 0 else (board.legacy,)
    return [
        replace(board, legacy=legacy, inverted=inverted)
        for inverted in (board.inverted, not board.inverted)
        for legacy in layouts
    ]

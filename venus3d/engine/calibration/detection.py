"""From an image to an observation of the board: corners, their ids, sharpness.

OpenCV finds the markers and corners; here its results get the same shape for every version, and
the board's layout and polarity are determined. Subpixel corners: `refinement`.
"""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_recognition import (
    OTHER_MARKER,
    BoardRecognition,
    best_finding,
    first_id_diagnosis,
    marker_size_diagnosis,
    two_boards_diagnosis,
)
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.marker_lattice import side_of
from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.calibration.refinement import (
    Grey,
    edge_sharpness,
    local_scales,
    refine_corners,
    refinement_windows,
)
from venus3d.engine.calibration.small_boards import small_board
from venus3d.engine.calibration.thin_borders import thin_border_diagnosis
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array
from venus3d.engine.sentences import Sentence

Region = tuple[int, int, int, int]
"""Search region x0, y0, x1, y1 in pixels; x1 and y1 are exclusive."""

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
# Number of whole images without the board kept for `explain_misses`: the first and the last ones.
_KEPT_MISSED = 3
_FEWEST_MEASURED = 8
# Different markers seen twice in one image: two boards.
_TWICE = 4


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


class Detector:
    """Finds one board in images. Used by one thread; learns the board's layout as it goes.
    Other threads can look for it with a `copy` each, and hand what they saw to `take_over`."""

    def __init__(self, board: Board, *, find_layout: bool = True, refine: bool = True) -> None:
        """A detector for `board`.

        Args:
            find_layout: detect whether the board is printed in the other layout, or inverted.
            refine: refine the corners in windows that follow the local size of a square.
        """
        self._asked = board
        self._board = board
        self._refine = refine
        self._find_layout = find_layout
        self._settled = not find_layout
        self._finders: dict[tuple[Board, bool], Any] = {}
        self.square_px = 0.0
        """The narrow side of the smallest square in the last image with the board, pixels."""
        self._evidence: dict[Board, int] = dict.fromkeys(_readings(board), 0)
        self._frames = 0
        self._check = BoardRecognition(board)
        self._missed: deque[Grey] = deque(maxlen=_KEPT_MISSED)
        self._first_missed: list[Grey] = []
        self._markers: Any = None
        self._two_boards = False
        self._is_copy = False

    @property
    def board(self) -> Board:
        """The board with the layout and polarity seen so far."""
        return self._board

    @property
    def settled(self) -> bool:
        """Whether enough frames agree on the board's layout, which then stays."""
        return self._settled

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on harmless differences between the board and the one given."""
        if self._board.inverted == self._asked.inverted:
            return ()
        return (_WHITE_ON_BLACK if self._board.inverted else _BLACK_ON_WHITE,)

    @property
    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """Another board in the images, or another layout, first id or marker size than given."""
        found: list[Diagnosis] = []
        if self._check.diagnosis is not None:
            found.append(self._check.diagnosis)
        if self._two_boards:
            found.append(two_boards_diagnosis())
        if self._board.legacy != self._asked.legacy:
            found.append(
                Diagnosis("wrong-layout", *(_OLD_LAYOUT if self._board.legacy else _NEW_LAYOUT))
            )
        if self._board.first_id != self._asked.first_id:
            found.append(first_id_diagnosis(self._board))
        if self._board.marker != self._asked.marker:
            found.append(marker_size_diagnosis(self._asked, self._board))
        thin = thin_border_diagnosis(self._board) if self._frames else None
        if thin is not None:
            found.append(thin)
        return tuple(dict.fromkeys(found))

    @property
    def missed_images(self) -> tuple[Grey, ...]:
        """The first and the last whole images (H, W) in which the board was not found."""
        return (*self._first_missed, *self._missed)

    def explain_misses(self) -> tuple[Diagnosis, ...]:
        """What images without the board show instead; may take a second. A board that can be read
        is read from now on: detect in all images again if `board` has changed."""
        finding = best_finding(self._board, self.missed_images)
        if finding is None:
            small = small_board(self._board, self.missed_images, self.copy().detect)
            return () if small is None else (small,)
        if finding.board is not None and self._find_layout:
            self._adopt(finding.board)
        return (finding.diagnosis,)

    def _adopt(self, board: Board) -> None:
        """Read this board from now on, in whichever layout."""
        self._board, self._check = board, BoardRecognition(board)
        self._settled, self._frames = False, 0
        self._evidence = dict.fromkeys(_readings(board), 0)
        self._missed, self._first_missed = deque(maxlen=_KEPT_MISSED), []

    def copy(self) -> Detector:
        """A detector for another thread, as this one is now: for one image until the layout is
        settled, then for any number."""
        other = copy.copy(self)
        other._finders, other._evidence = {}, dict(self._evidence)
        other._frames, other._is_copy = 0, True
        return other

    def take_over(self, seen: Observation, image: Any, by: Detector) -> Observation:
        """What `by`, a `copy`, saw in an image (see `detect`), as if it had been detected here:
        called in the order of the images, the copies give the same as one detector."""
        self._two_boards |= by._two_boards
        if by._frames:  # it is evidence for a layout, which is weighed here
            return self.detect(image, time_s=seen.time_s, name=seen.name)
        if seen.count:
            self._check.found()
        else:
            self._miss(_grey(image))
        return replace(seen, board=self._board, board_diagnoses=self.diagnoses)

    def settle(self, images: Iterable[Any]) -> Board:
        """Detect in images until the layout is settled; returns the board with that layout."""
        for image in images:
            if self._settled:
                break
            self.detect(image)
        return self._board

    def detect(
        self,
        image: Any,
        *,
        region: Region | None = None,
        quick: bool = False,
        time_s: float = 0.0,
        name: str = "",
    ) -> Observation:
        """The observation of the board in an image; empty without four non-collinear corners.

        Args:
            image: (H, W) grey or (H, W, 3) BGR, 8 or 16 bit.
            region: the part to search; corners are in pixels of the whole image.
            quick: one threshold only; finds as much in a sharp image whose squares have
                `QUICK_FROM_PX`, less in a blurred one.
            time_s, name: passed on to the observation.

        Raises:
            VenusError: the image is neither grey nor BGR, 8 or 16 bit.
        """
        observation = self._observed(image, region, quick)
        return replace(
            observation,
            time_s=time_s,
            name=name,
            board=self._board,
            board_diagnoses=self.diagnoses,
        )

    def _observed(self, image: Any, region: Region | None, quick: bool) -> Observation:
        whole = _grey(image)
        size = (whole.shape[1], whole.shape[0])
        x0, y0, x1, y1 = _clipped(region, size)
        grey = whole[y0:y1, x0:x1]
        nothing = Observation.nothing(size)
        if grey.size == 0:
            return nothing
        ids, corners = self._read(grey, quick)
        if self._shows_two_boards():
            return nothing
        if not determines_homography(self._board.points_of(ids)):
            if region is None and not quick and not self._is_copy:
                self._miss(grey)
            return nothing
        if not self._settled and self._reads_other_markers(ids, corners):
            return self._observed(image, region, quick)
        if not self._is_copy:
            self._check.found()
        scales = local_scales(self._board, ids, corners)
        if self._refine:
            windows = refinement_windows(self._board, scales, corners)
            corners = refine_corners(self._board, ids, grey, corners, windows)
        squares = np.linalg.norm(scales, axis=1).min(axis=1) * self._board.square
        self.square_px = float(squares.min())
        sharpness = edge_sharpness(grey, corners, squares)
        return Observation(ids, corners + np.array([x0, y0]), size, sharpness)

    def _miss(self, grey: Grey) -> None:
        if len(self._first_missed) < _KEPT_MISSED:
            self._first_missed.append(grey)
        else:
            self._missed.append(grey)
        self._check.missed(grey)
        if self._check.readable is not None and not self._settled:
            self._adopt(self._check.readable)

    def _read(self, grey: Grey, quick: bool) -> tuple[NDArray[np.intp], Array]:
        """Ids (N,) and corners (N, 2) of the presumed board; compares readings until settled."""
        self._markers = None
        if self._settled:
            ids, corners, _ = self._detect_board(self._board, grey, quick=quick)
            return ids, corners
        found: dict[Board, tuple[NDArray[np.intp], Array]] = {}
        for inverted in (self._board.inverted, not self._board.inverted):
            markers: Any = None
            for board in self._evidence:
                if board.inverted == inverted:
                    ids, corners, markers = self._detect_board(board, grey, markers)
                    found[board] = (ids, corners)
            if any(ids.size for ids, _ in found.values()):
                break  # a board has one polarity: the other would give nothing
        self._weigh({board: ids.size for board, (ids, _) in found.items()})
        nothing = (np.zeros(0, np.intp), np.zeros((0, 2)))
        return found.get(self._board, nothing)

    def _shows_two_boards(self) -> bool:
        """Whether several of the markers just found are there twice."""
        if self._markers is None:
            return False
        _, counts = np.unique(np.asarray(self._markers[1]).reshape(-1), return_counts=True)
        twice = int((counts > 1).sum()) >= _TWICE
        self._two_boards |= twice
        return twice

    def _reads_other_markers(self, ids: NDArray[np.intp], corners: Array) -> bool:
        """Take over the size of the markers as it is seen, if it is quite another."""
        share = _marker_share(self._board, ids, corners, self._markers)
        if share is None or abs(share * self._board.square / self._board.marker - 1) < (
            OTHER_MARKER
        ):
            return False
        marker = round(2000 * share * self._board.square) / 2000  # to half a millimetre
        if not 0 < marker < self._board.square or marker == self._board.marker:
            return False
        self._adopt(replace(self._board, marker=marker))
        return True

    def _weigh(self, counts: dict[Board, int]) -> None:
        """Add a frame's evidence: the right reading finds more corners over several frames.
        The wrong one finds some too, even with a lower reprojection error: neither is proof."""
        if not any(counts.values()):
            return
        self._frames += 1
        for board, count in counts.items():
            self._evidence[board] += count
        # The first of equals wins, and the board as given comes first.
        self._board = max(self._evidence, key=lambda board: self._evidence[board])
        best, *others = sorted(self._evidence.values(), reverse=True)
        clear = all(best >= _LEAD * other for other in others)
        self._settled = self._frames >= (_FRAMES_TO_SETTLE if clear else _FRAMES_AT_MOST)

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


def search_region(
    observation: Observation, image_size: tuple[int, int], *, grow: float = 0.35, least_px: int = 48
) -> Region | None:
    """The region to search in the next frame: around the corners, grown on all sides.

    Args:
        observation: the last frame's.
        image_size: (width, height) of the next frame.
        grow: share of the corners' extent added on each side; at least `least_px`.

    Returns None if nothing was seen or a region saves nothing: search the whole image.
    """
    if observation.count == 0 or observation.image_size != image_size:
        return None
    low, high = observation.corners.min(axis=0), observation.corners.max(axis=0)
    margin = max(least_px, grow * float((high - low).max()))
    x0, y0 = np.floor(low - margin).astype(int)
    x1, y1 = np.ceil(high + margin).astype(int) + 1
    region = _clipped((int(x0), int(y0), int(x1), int(y1)), image_size)
    area = (region[2] - region[0]) * (region[3] - region[1])
    return region if area < 0.8 * image_size[0] * image_size[1] else None


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
    markers = cv2.aruco.DetectorParameters()
    if quick:
        markers.adaptiveThreshWinSizeMin = markers.adaptiveThreshWinSizeMax = _QUICK_WINDOW_PX
    return cv2.aruco.CharucoDetector(board.cv_board, cv2.aruco.CharucoParameters(), markers)


def _readings(board: Board) -> list[Board]:
    """The board as given, then the other ways in which it may be printed."""
    # With an odd row count both layouts are the same board.
    layouts = (board.legacy, not board.legacy) if board.rows % 2 == 0 else (board.legacy,)
    return [
        replace(board, legacy=legacy, inverted=inverted)
        for inverted in (board.inverted, not board.inverted)
        for legacy in layouts
    ]


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

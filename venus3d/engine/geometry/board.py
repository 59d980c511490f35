"""The board: its points, their ids, its image. What differs from kind to kind: `boards`.
All coordinates are relative to the board's centre, x along the columns, y along the rows, z = 0."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple, dataclass
from functools import cached_property
from typing import Any, Literal, get_args

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.boards.charuco import Charuco
from venus3d.engine.geometry.boards.chessboard import Chessboard
from venus3d.engine.geometry.boards.circles import ASYMMETRIC_CIRCLES, CIRCLES
from venus3d.engine.geometry.boards.kind import BoardKind
from venus3d.engine.geometry.boards.tags import APRILGRID, ARUCO_GRID
from venus3d.engine.geometry.pose import Array

DICTIONARIES: tuple[str, ...] = tuple(
    sorted(
        name for name in dir(cv2.aruco) if name.startswith("DICT_") and "CUSTOM" not in name.upper()
    )
)
"""Names of the marker dictionaries of this OpenCV version."""


Kind = Literal["charuco", "chessboard", "circles", "asymmetric-circles", "aprilgrid", "aruco-grid"]
"""Names of the kinds of boards."""
KINDS: Mapping[str, BoardKind] = {
    "charuco": Charuco(),
    "chessboard": Chessboard(),
    "circles": CIRCLES,
    "asymmetric-circles": ASYMMETRIC_CIRCLES,
    "aprilgrid": APRILGRID,
    "aruco-grid": ARUCO_GRID,
}
assert tuple(KINDS) == get_args(Kind)
_LARGEST_STRETCH = 0.2
"""Of a print: more is a mistake."""
_ABSENT: Mapping[str, Any] = {
    "marker": 0.0,
    "dictionary": "",
    "legacy": False,
    "inverted": False,
    "first_id": 0,
}
"""What a field holds that the kind has not: boards that look alike are equal."""


@dataclass(frozen=True)
class Board:
    """A calibration board. Lengths in metres. Raises `BoardError` for invalid options."""

    columns: int = 9
    """Squares, tags or circles along x; of a checkerboard one more than inner corners."""
    rows: int = 6
    """Squares, tags or circles along y."""
    square: float = 0.028
    """Side of a square, or from one tag or row of circles to the next, metres."""
    marker: float = 0.021
    """Side of a marker, or diameter of a circle, metres."""
    dictionary: str = "DICT_5X5_100"
    legacy: bool = False
    """Layout of boards printed before OpenCV 4.6; differs if the row count is even."""
    inverted: bool = False
    """White markers on black."""
    first_id: int = 0
    """The dictionary's number of the first marker; the others follow."""
    bow: tuple[float, float] = (0.0, 0.0)
    """How far the middle lies behind the ends, along x and along y, metres: a parabola each."""
    stretch: float = 0.0
    """By how much the print is longer along x than along y, as a share: half to each."""
    kind: Kind = "charuco"

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise BoardError(
                f"There is no kind of board {self.kind!r}; use one of {', '.join(KINDS)}."
            )
        for name, value in _ABSENT.items():
            if name not in self.of_kind.fields:
                object.__setattr__(self, name, value)
        sides = (self.square, self.marker) if self.has("marker") else (self.square,)
        if not all(0 < side < np.inf for side in sides):
            raise BoardError("Square and marker sizes must be positive numbers.")
        if not abs(self.stretch) < _LARGEST_STRETCH:
            raise BoardError(
                "A board's squares cannot be so much longer one way than the other; measure "
                "--board.square-x-mm and --board.square-y-mm again."
            )
        self.of_kind.check(self)
        if self.has("dictionary"):
            self._check_markers()

    def _check_markers(self) -> None:
        if self.dictionary not in DICTIONARIES:
            raise BoardError(
                f"There is no marker dictionary {self.dictionary!r}; use one of "
                f"{', '.join(DICTIONARIES)}."
            )
        if self.first_id < 0:
            raise BoardError("The first marker's id cannot be negative; give 0 or more.")
        have = len(self._predefined.bytesList)
        if self.first_id + self.marker_count > have:
            begun = f" from id {self.first_id} on" if self.first_id else ""
            raise BoardError(
                f"{self.dictionary} has {have} markers, but a board of {self.columns} x "
                f"{self.rows} {self.of_kind.unit} needs {self.marker_count}{begun}; use a larger "
                "dictionary."
            )

    @property
    def of_kind(self) -> BoardKind:
        """What boards of this kind have in common."""
        return KINDS[self.kind]

    def has(self, field: str) -> bool:
        """Whether this kind of board has a field, such as `marker`."""
        return field in self.of_kind.fields

    def __reduce__(self) -> tuple[type[Board], tuple[Any, ...]]:
        """Pickled as its options, without the cached OpenCV objects."""
        return Board, astuple(self)

    @property
    def marker_count(self) -> int:
        """Number of markers."""
        return self.of_kind.marker_count(self)

    @property
    def _predefined(self) -> Any:
        return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, self.dictionary))

    @cached_property
    def cv_dictionary(self) -> Any:
        """OpenCV's dictionary object, cut down to the markers on this board: `first_id` is its 0.

        OpenCV 5 compares every candidate with every marker: six times the work for `DICT_5X5_1000`
        as for a board's 48.
        """
        whole = self._predefined
        return cv2.aruco.Dictionary(
            whole.bytesList[self.first_id : self.first_id + self.marker_count],
            whole.markerSize,
            whole.maxCorrectionBits,
        )

    @cached_property
    def cv_board(self) -> Any:
        """OpenCV's object for this board (its origin is the top left corner, not the centre); None
        where it has none."""
        return self.of_kind.cv_board(self)

    @property
    def width(self) -> float:
        """Extent along x, metres."""
        return self.of_kind.size(self)[0]

    @property
    def height(self) -> float:
        """Extent along y, metres."""
        return self.of_kind.size(self)[1]

    @property
    def corner_count(self) -> int:
        """Number of points."""
        return len(self.lattice)

    @cached_property
    def lattice(self) -> NDArray[np.intp]:
        """(M, 2) column and row of each point, in order of the ids; the next one is
        `of_kind.stride` places away."""
        return self.of_kind.lattice(self)

    @cached_property
    def corners(self) -> Array:
        """(M, 3) points relative to the centre, in order of their ids, metres."""
        points = self.of_kind.points(self)
        flat = np.column_stack([points, np.zeros(len(points))])
        return flat + np.tensordot([*self.bow, self.stretch], self.deformations(flat), 1)

    def deformations(self, points: Array) -> Array:
        """(3, ..., 3) shift of points (..., 3) of the flat board by one metre of each `bow` and by
        a `stretch` of 1."""
        x, y, flat = points[..., 0], points[..., 1], np.zeros(points.shape[:-1])
        return np.stack(
            [
                np.stack([flat, flat, 1 - (2 * x / self.width) ** 2], axis=-1),
                np.stack([flat, flat, 1 - (2 * y / self.height) ** 2], axis=-1),
                np.stack([x / 2, -y / 2, flat], axis=-1),
            ]
        )

    @cached_property
    def outline(self) -> Array:
        """(4, 3) the board's outer corners, clockwise from the top left; metres."""
        w, h = self.width / 2, self.height / 2
        return np.array([[-w, -h, 0], [w, -h, 0], [w, h, 0], [-w, h, 0]], dtype=np.float64)

    def points_of(self, ids: ArrayLike) -> Array:
        """(N, 3) board points of corner ids (N,), metres."""
        return self.corners[np.asarray(ids, dtype=np.intp)]

    def texture(self, square_px: int = 60) -> NDArray[np.uint8]:
        """(height, width) grey image of what is printed, without a margin, `square_px` a square."""
        picture = self.of_kind.texture(self, square_px)
        return 255 - picture if self.inverted else picture

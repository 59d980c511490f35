"""The ChArUco board: its corners, their ids, its image.
All coordinates are relative to the board's centre, x along the columns, y along the rows, z = 0."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.pose import Array

DICTIONARIES: tuple[str, ...] = tuple(
    sorted(
        name for name in dir(cv2.aruco) if name.startswith("DICT_") and "CUSTOM" not in name.upper()
    )
)
"""Names of the marker dictionaries of this OpenCV version."""


@dataclass(frozen=True)
class Board:
    """A ChArUco board. Lengths in metres. Raises `BoardError` for invalid options."""

    columns: int = 9
    """Squares along x."""
    rows: int = 6
    """Squares along y."""
    square: float = 0.028
    """Side of a square, metres."""
    marker: float = 0.021
    """Side of a marker, metres."""
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

    def __post_init__(self) -> None:
        if self.columns < 3 or self.rows < 3:
            raise BoardError(
                f"A board of {self.columns} x {self.rows} squares has too few inner corners to "
                "calibrate with; use at least 3 columns and 3 rows."
            )
        if not all(0 < side < np.inf for side in (self.square, self.marker)):
            raise BoardError("Square and marker sizes must be positive numbers.")
        if self.marker >= self.square:
            raise BoardError(
                f"The marker ({self.marker * 1000:g} mm) must be smaller than the square "
                f"({self.square * 1000:g} mm); are the two swapped?"
            )
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
                f"{self.rows} squares needs {self.marker_count}{begun}; use a larger dictionary."
            )

    def __reduce__(self) -> tuple[type[Board], tuple[Any, ...]]:
        """Pickled as its options, without the cached OpenCV objects."""
        return Board, astuple(self)

    @property
    def marker_count(self) -> int:
        """Number of markers."""
        return self.columns * self.rows // 2

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
        """OpenCV's `CharucoBoard` (its origin is the top left corner, not the centre)."""
        board = cv2.aruco.CharucoBoard(
            (self.columns, self.rows), self.square, self.marker, self.cv_dictionary
        )
        board.setLegacyPattern(self.legacy)
        return board

    @property
    def width(self) -> float:
        """Extent along x, metres."""
        return self.columns * self.square

    @property
    def height(self) -> float:
        """Extent along y, metres."""
        return self.rows * self.square

    @property
    def corner_count(self) -> int:
        """Number of inner corners."""
        return (self.columns - 1) * (self.rows - 1)

    @cached_property
    def corners(self) -> Array:
        """(M, 3) inner corners relative to the centre, in order of their ids, metres."""
        x = (np.arange(1, self.columns) - self.columns / 2) * self.square
        y = (np.arange(1, self.rows) - self.rows / 2) * self.square
        across, down = np.tile(x, y.size), np.repeat(y, x.size)
        flat = np.stack([across, down, np.zeros(down.size)], 1).astype(np.float64)
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

    def id_of(self, column: int, row: int) -> int:
        """Id of the inner corner right below square (column, row), both from 0 at the top left."""
        if not (0 <= column < self.columns - 1 and 0 <= row < self.rows - 1):
            raise BoardError(f"The board has no inner corner ({column}, {row}).")
        return row * (self.columns - 1) + column

    def column_row_of(self, corner_id: int) -> tuple[int, int]:
        """(column, row) of a corner id; the inverse of `id_of`."""
        if not 0 <= corner_id < self.corner_count:
            raise BoardError(f"The board has no inner corner number {corner_id}.")
        row, column = divmod(corner_id, self.columns - 1)
        return column, row

    def texture(self, square_px: int = 60) -> NDArray[np.uint8]:
        """Grey image (rows * square_px, columns * square_px) of the board without a margin."""
        size = (self.columns * square_px, self.rows * square_px)
        picture = np.asarray(self.cv_board.generateImage(size, marginSize=0), dtype=np.uint8)
        return 255 - picture if self.inverted else picture

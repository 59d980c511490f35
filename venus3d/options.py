"""Options shared by several commands: the board, the limits, and range checks.

Lengths are in millimetres, as a person types them; `BoardOptions.board()` and
`LimitOptions.chosen()` convert to metres. Each field's docstring is its `--help` text.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from tyro.conf import FlagCreatePairsOff, arg

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board, Kind
from venus3d.languages import Language

Switch = FlagCreatePairsOff[bool]
"""An option that is off by default."""


def optional(unit: str, usual: str = "") -> object:
    """How `--help` shows an option that is None by default."""
    return arg(metavar=unit, help_behavior_hint=f"(usual: {usual})" if usual else "(optional)")


LensName = Literal[
    "auto",
    "pinhole",
    "brown3",
    "brown4",
    "brown5",
    "rational",
    "rational-thin-prism",
    "equidistant",
    "fisheye",
]
"""A lens model, or auto."""
LanguageOption = Annotated[Language | None, arg(help_behavior_hint="(usual: the browser's)")]
"""The language of a page."""


_DICTIONARIES = {"aprilgrid": "DICT_APRILTAG_36H11"}


@dataclass(frozen=True)
class BoardOptions:
    """The board that is held in front of the camera. --board FILE gives all of it: a file that
    venus3d board --save wrote, Kalibr's YAML, or the name of a calib.io file."""

    kind: Kind = "charuco"
    """What is printed on it."""
    columns: int = 9
    """Squares, tags or circles from left to right; a checkerboard of 9 x 6 inner corners has 10 x 7
    squares."""
    rows: int = 6
    """Squares, tags or circles from top to bottom."""
    square_mm: float = 28.0
    """Side of a square in millimetres, as measured on the printed board; from one tag or row of
    circles to the next (asymmetric circles are twice as far apart in a row)."""
    square_x_mm: Annotated[float | None, optional("MM", "--board.square-mm")] = None
    """The same from left to right, where a printer stretched the board one way."""
    square_y_mm: Annotated[float | None, optional("MM", "--board.square-mm")] = None
    """The same from top to bottom."""
    marker_mm: Annotated[
        float | None, optional("MM", "21; of circles half of --board.square-mm")
    ] = None
    """Side of a marker or tag, or diameter of a circle, in millimetres."""
    dictionary: Annotated[
        str | None, optional("NAME", "DICT_5X5_100; of an aprilgrid DICT_APRILTAG_36H11")
    ] = None
    """OpenCV's name of the marker dictionary."""
    legacy: Switch = False
    """The layout of boards printed before OpenCV 4.6; detected where it matters."""
    inverted: Switch = False
    """White on black; of markers detected automatically."""
    first_id: int = 0
    """Number of the board's first marker in the dictionary; detected automatically."""

    def board(self) -> Board:
        """The engine's board. Raises `BoardError` for invalid options."""
        across, down = (
            self.square_mm if side is None else side
            for side in (self.square_x_mm, self.square_y_mm)
        )
        square_mm = (across + down) / 2
        return Board(
            columns=self.columns,
            rows=self.rows,
            square=square_mm / 1000,
            marker=self._marker_mm / 1000,
            dictionary=self.dictionary or _DICTIONARIES.get(self.kind, Board.dictionary),
            legacy=self.legacy,
            inverted=self.inverted,
            first_id=self.first_id,
            stretch=(across - down) / square_mm if min(across, down) > 0 else float("inf"),
            kind=self.kind,
        )

    @property
    def _marker_mm(self) -> float:
        if self.marker_mm is not None:
            return self.marker_mm
        return self.square_mm / 2 if "circles" in self.kind else 1000 * Board.marker


@dataclass(frozen=True)
class LimitOptions:
    """Limits of a target pose; by default those that suit the board and the camera."""

    max_angle_deg: Annotated[float | None, optional("DEG", "70")] = None
    """Largest turn about each axis in degrees."""
    max_tilt_deg: Annotated[float | None, optional("DEG", "55")] = None
    """Largest angle between the board's normal and the line of sight in degrees."""
    nearest_mm: Annotated[float | None, optional("MM", "200")] = None
    """Nearest distance of a corner in millimetres."""
    farthest_mm: Annotated[float | None, optional("MM", "1200")] = None
    """Farthest distance of a corner in millimetres."""
    max_depth_ratio: Annotated[float | None, optional("RATIO", "2.2")] = None
    """Largest ratio of the farthest to the nearest corner's distance: focus."""
    min_square_px: Annotated[float | None, optional("PX", "12")] = None
    """Smallest side of a square in the picture in pixels; more where the markers need it."""

    def check(self) -> None:
        """Raises `VenusError` for the first impossible limit."""
        ranges = {
            "max_angle_deg": (1, 180),
            "max_tilt_deg": (1, 85),
            "nearest_mm": (10, 100_000),
            "farthest_mm": (10, 100_000),
            "max_depth_ratio": (1.01, 100),
            "min_square_px": (1, 1000),
        }
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if value is not None:
                check_range(f"--limits.{name.replace('_', '-')}", value, low, high)
        nearest, farthest = self.nearest_mm, self.farthest_mm
        if nearest is not None and farthest is not None and nearest >= farthest:
            raise VenusError("--limits.nearest-mm must be smaller than --limits.farthest-mm.")

    def chosen(self) -> dict[str, float]:
        """The limits that were set, as fields of the engine's `Limits`."""
        given = {
            "max_angle_deg": self.max_angle_deg,
            "max_tilt_deg": self.max_tilt_deg,
            "nearest": None if self.nearest_mm is None else self.nearest_mm / 1000,
            "farthest": None if self.farthest_mm is None else self.farthest_mm / 1000,
            "max_depth_ratio": self.max_depth_ratio,
            "min_square_px": self.min_square_px,
        }
        return {name: value for name, value in given.items() if value is not None}


def image_size_of(text: str) -> tuple[int, int]:
    """(width, height) of a text like 1280x720. Raises `VenusError` for anything else."""
    width, cross, height = text.lower().partition("x")
    if not (cross and width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise VenusError(f"A picture's size is WIDTHxHEIGHT, such as 1280x720, not {text!r}.")
    size = int(width), int(height)
    if not all(64 <= side <= 16384 for side in size):
        raise VenusError(f"A picture of {text} px is of no use; take 64 to 16384 px a side.")
    return size


def check_range(option: str, value: float | None, low: float, high: float) -> None:
    """Raises `VenusError` if a number was given that is out of range."""
    if value is not None and not low <= value <= high:  # also refuses NaN
        raise VenusError(f"{option} must be from {low:g} to {high:g}, not {value:g}.")

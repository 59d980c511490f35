"""What a person can choose, as frozen values that the command line fills and the rooms read.

Lengths are in millimetres here, because a person types them; `BoardOptions.board()` and
`LimitOptions.chosen()` turn them into the engine's metres. Each field's docstring is its `--help`
text. How options are parsed is left to tyro, what is done with them to `app` and `cli`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import FlagCreatePairsOff, Positional, arg

from venus3d.engine.board import Board
from venus3d.engine.errors import VenusError
from venus3d.engine.snapshot import Cost, Method, Strategy
from venus3d.engine.way import way_of

Switch = FlagCreatePairsOff[bool]
"""An option that is off unless it is named."""


def _optional(unit: str, usual: str) -> object:
    """How `--help` shows an option that is None unless given."""
    return arg(metavar=unit, help_behavior_hint=f"(usual: {usual})")


@dataclass(frozen=True)
class BoardOptions:
    """The ChArUco board that is held in front of the camera."""

    columns: int = 9
    """Squares from left to right."""
    rows: int = 6
    """Squares from top to bottom."""
    square_mm: float = 28.0
    """Side of a square in millimetres, as measured on the printed board."""
    marker_mm: float = 21.0
    """Side of a marker in millimetres."""
    dictionary: str = "DICT_5X5_100"
    """OpenCV's name of the marker dictionary."""
    legacy: Switch = False
    """The layout of boards printed before OpenCV 4.6; found out by itself where it matters."""
    inverted: Switch = False
    """White on black; found out by itself."""

    def board(self) -> Board:
        """The engine's board. Raises `BoardError` for options that make no board."""
        return Board(
            columns=self.columns,
            rows=self.rows,
            square=self.square_mm / 1000,
            marker=self.marker_mm / 1000,
            dictionary=self.dictionary,
            legacy=self.legacy,
            inverted=self.inverted,
        )


@dataclass(frozen=True)
class LimitOptions:
    """What a target pose may ask of a person; by itself what suits the board and the camera."""

    max_angle_deg: Annotated[float | None, _optional("DEG", "70")] = None
    """Largest turn about each axis in degrees."""
    max_tilt_deg: Annotated[float | None, _optional("DEG", "55")] = None
    """Largest angle between the board's normal and the line of sight in degrees."""
    nearest_mm: Annotated[float | None, _optional("MM", "200")] = None
    """Nearest distance of a corner in millimetres."""
    farthest_mm: Annotated[float | None, _optional("MM", "1200")] = None
    """Farthest distance of a corner in millimetres."""
    max_depth_ratio: Annotated[float | None, _optional("RATIO", "2.2")] = None
    """Largest ratio of the farthest to the nearest corner's distance: focus."""
    min_square_px: Annotated[float | None, _optional("PX", "12")] = None
    """Smallest side of a square in the picture in pixels; more where the markers need it."""

    def check(self) -> None:
        """Raises `VenusError` for the first limit that cannot be met."""
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
        """What was set, as fields of the engine's `Limits`; the session finds the rest itself."""
        given = {
            "max_angle_deg": self.max_angle_deg,
            "max_tilt_deg": self.max_tilt_deg,
            "nearest": None if self.nearest_mm is None else self.nearest_mm / 1000,
            "farthest": None if self.farthest_mm is None else self.farthest_mm / 1000,
            "max_depth_ratio": self.max_depth_ratio,
            "min_square_px": self.min_square_px,
        }
        return {name: value for name, value in given.items() if value is not None}


_CALIBRATING = {
    "method": "--method",
    "cost": "--cost",
    "search": "--search",
    "wanted_error": "--wanted-error",
    "keep_best": "--keep-best",
    "convergence": "--convergence",
    "max_views": "--max-views",
    "auto_capture": "--no-auto-capture",
}


@dataclass(frozen=True)
class GuideOptions:
    """One guided calibration."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")] = "sim"
    """sim, a camera's number or device, a stream's address, a video, a folder or a pattern."""
    board: BoardOptions = field(default_factory=BoardOptions)
    camera_size: Annotated[
        str | None, arg(metavar="WIDTHxHEIGHT", help_behavior_hint="(usual: as it comes)")
    ] = None
    """Size of the picture to ask a camera for, or to simulate (sim: 1280x720)."""
    method: Method = "global"
    """How the next pose is found: ours (global), the paper's (venus), Rojtberg's, or by chance."""
    cost: Annotated[Cost | None, arg(help_behavior_hint="(the method's own)")] = None
    """What the search makes small: by itself projection-variance for global, sum-iod for venus."""
    search: Annotated[Strategy | None, arg(help_behavior_hint="(the method's own)")] = None
    """How it is searched for: by itself annealing for venus, the whole space for global."""
    wanted_error: Annotated[float, arg(metavar="PX")] = 0.3
    """Mean projection error in pixels that is enough; the views until then are forecast."""
    limits: LimitOptions = field(default_factory=LimitOptions)
    keep_best: Switch = False
    """Method venus: take the best pose that its search met, not the one it ends on."""
    overlap: float = 0.85
    """How much the board must cover its target in the picture, 0 to 1, to be captured."""
    auto_capture: bool = True
    """Capture by itself once the board is in place and still; otherwise only on command."""
    convergence: Literal["repaired", "printed"] = "repaired"
    """When a parameter counts as settled: the repaired rule, or the paper's as printed."""
    max_views: int = 20
    """End after this many views at the latest."""
    seed: int = 0
    """One number that makes a run repeat: search, simulated noise, autopilot."""
    autopilot: bool = False
    """Let a simulated hand walk the board through the four steps (sim only)."""
    speed: float = 1.0
    """How fast the simulated hand moves; 1 is a calm person."""
    headless: Switch = False
    """No viewer: run to convergence, to --max-views or to the recording's end, then print."""
    host: str = "127.0.0.1"
    """Address the viewer listens on; 0.0.0.0 lets other machines in, without a password."""
    port: int = 8080
    """Port of the viewer; the next free one is used if it is taken."""
    output: Annotated[Path | None, arg(metavar="DIR", help_behavior_hint="(optional)")] = None
    """Folder for camera.yaml and result.json (--trial: trial.csv); with the viewer, venus3d-result
    (--trial: venus3d-trial) if none is named."""
    json: Switch = False
    """Print the result as one JSON object on the last line."""
    trial: Switch = False
    """No calibration: time one volunteer with three kinds of help to the same poses."""
    participant: Annotated[
        str | None, arg(metavar="NAME", help_behavior_hint="(usual: P1, P2, ...)")
    ] = None
    """Who takes part in the trial; one who was interrupted goes on."""
    camera: Annotated[
        Path | None, arg(metavar="CAMERA.YAML", help_behavior_hint="(sim: its own)")
    ] = None
    """The calibrated camera that the trial looks through."""
    trial_poses: int = 10
    """How many poses there are with each help of the trial."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        self._check_trial()
        way_of(self.method, self.cost, self.search)
        self.limits.check()
        check_range("--wanted-error", self.wanted_error, 0.001, 100)
        check_range("--overlap", self.overlap, 0.1, 0.99)
        check_range("--speed", self.speed, 0.1, 10)
        check_range("--max-views", self.max_views, 1, 1000)
        check_range("--seed", self.seed, 0, 2**63)
        if self.camera_size is not None:
            image_size_of(self.camera_size)

    def _check_trial(self) -> None:
        if not self.trial and (self.participant is not None or self.camera is not None):
            option = "--camera" if self.participant is None else "--participant"
            raise VenusError(f"{option} goes with --trial; leave it out to calibrate.")
        if not self.trial:
            return
        check_range("--trial-poses", self.trial_poses, 2, 100)
        # A trial's poses are its own and nothing is calibrated: what would be ignored is refused.
        usual = GuideOptions()
        for name, option in _CALIBRATING.items():
            if getattr(self, name) != getattr(usual, name):
                raise VenusError(
                    f"{option} chooses how a camera is calibrated, and a trial calibrates none; "
                    "leave it out."
                )
        if self.headless and self.source != "sim":
            raise VenusError(
                "A trial without a viewer is a rehearsal of the simulated hand, so --trial "
                "--headless goes with sim only."
            )
        if self.source != "sim" and self.camera is None:
            raise VenusError(
                "A trial needs a calibrated camera: calibrate it first with venus3d guide, then "
                "give its file with --camera camera.yaml."
            )
        if self.participant is not None and not self.participant.strip():
            raise VenusError("The participant's name is empty; leave --participant out for P1, P2.")

    @property
    def image_size(self) -> tuple[int, int] | None:
        """`camera_size` as (width, height); None if it was not given."""
        return None if self.camera_size is None else image_size_of(self.camera_size)


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
    """Raises `VenusError` if a number was given that cannot be met."""
    if value is not None and not low <= value <= high:  # also refuses what is no number
        raise VenusError(f"{option} must be from {low:g} to {high:g}, not {value:g}.")

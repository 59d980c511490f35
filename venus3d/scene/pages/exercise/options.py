"""Options of practice and trial; a docstring is its option's `--help`."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from venus3d.engine.errors import VenusError
from venus3d.options import (
    BoardOptions,
    LanguageOption,
    LimitOptions,
    Switch,
    check_range,
    image_size_of,
    optional,
)
from venus3d.storage.exercise import harmless


@dataclass(frozen=True)
class PracticeOptions:
    """Let trainees bring a board to target poses, and score them."""

    board: BoardOptions = field(default_factory=BoardOptions)
    camera: Annotated[Path | None, optional("FILE", "a simulated webcam")] = None
    """The calibrated camera that is practised with: a result.json, a camera.yaml, any other camera
    file, or the folder of a calibration."""
    seed: int = 0
    """One number that makes the target poses repeat."""
    language: LanguageOption = None
    """Language of the page; usually each browser's own."""
    host: str = "127.0.0.1"
    """Address the page listens on; 0.0.0.0 lets other machines in, without a password."""
    token: Switch = False
    """With another --host: let in only who has the address that is printed, by the token in it."""
    port: int = 8080
    """Port of the page; the next free one is used if it is taken."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-practice")
    """Folder for practice.csv: one row for each pose that was reached or given up."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        check_range("--port", self.port, 1, 65535)
        check_range("--seed", self.seed, 0, 2**63)


@dataclass(frozen=True)
class TrialOptions:
    """Time volunteers who reach poses with three kinds of help."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")] = "sim"
    """sim, a camera's number or device, or a stream's address."""
    camera: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="(sim: its own)")] = None
    """The calibrated camera that the trial looks through: a result.json, a camera.yaml, any other
    camera file, or the folder of a calibration."""
    participant: Annotated[str | None, optional("NAME", "P1, P2, ...")] = None
    """Who takes part; one who was interrupted goes on."""
    poses: int = 10
    """How many poses there are with each help."""
    board: BoardOptions = field(default_factory=BoardOptions)
    limits: LimitOptions = field(default_factory=LimitOptions)
    camera_size: Annotated[str | None, optional("WIDTHxHEIGHT", "as it comes")] = None
    """Size of the picture to ask a camera for, or to simulate (sim: 1280x720)."""
    overlap: float = 0.85
    """How much the board must cover its target in the picture, 0 to 1, to have reached it."""
    seed: int = 0
    """One number that makes a run repeat: target poses, simulated noise, autopilot."""
    autopilot: bool = False
    """Let a simulated hand walk the board through the four steps (sim only)."""
    speed: float = 1.0
    """How fast the simulated hand moves; 1 is a calm person."""
    headless: Switch = False
    """No page: a rehearsal of the simulated hand (sim only)."""
    language: LanguageOption = None
    """Language of the page; usually each browser's own."""
    host: str = "127.0.0.1"
    """Address the page listens on; with 0.0.0.0 the address that is printed opens the page on
    other machines too, by the token in it."""
    port: int = 8080
    """Port of the page; the next free one is used if it is taken."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-trial")
    """Folder for trial.csv: one row for each pose, all participants in the same file."""
    json: Switch = False
    """Print the result as one JSON object on the last line."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        self.limits.check()
        check_range("--poses", self.poses, 2, 100)
        check_range("--overlap", self.overlap, 0.1, 0.99)
        check_range("--speed", self.speed, 0.1, 10)
        check_range("--seed", self.seed, 0, 2**63)
        if self.camera_size is not None:
            image_size_of(self.camera_size)
        if self.headless and self.source != "sim":
            raise VenusError(
                "A trial without a page is a rehearsal of the simulated hand, so --headless goes "
                "with sim only."
            )
        if self.source != "sim" and (self.autopilot or self.speed != 1):
            raise VenusError(
                "--autopilot and --speed are for the simulated hand; leave them out, or trial sim."
            )
        if self.source != "sim" and self.camera is None:
            raise VenusError(
                "A trial needs a calibrated camera: calibrate it first with venus3d guide, then "
                "give its file with --camera camera.yaml."
            )
        if self.participant is not None and not self.participant.strip():
            raise VenusError("The participant's name is empty; leave --participant out for P1, P2.")
        if self.participant is not None and harmless(self.participant) != self.participant:
            raise VenusError(
                "A participant's name has visible characters only, and none of = + - @ | % in "
                f"front, not {self.participant[:60]!r}."
            )

    @property
    def image_size(self) -> tuple[int, int] | None:
        """`camera_size` as (width, height); None if it was not given."""
        return None if self.camera_size is None else image_size_of(self.camera_size)

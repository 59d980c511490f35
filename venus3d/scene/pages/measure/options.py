"""Options of `venus3d measure`; a docstring is its option's `--help`."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from venus3d.engine.errors import VenusError
from venus3d.options import BoardOptions, LanguageOption, Switch, check_range


@dataclass(frozen=True)
class MeasureOptions:
    """Measure lengths on the board's plane, by two clicks in the live picture."""

    source: Annotated[Positional[str], arg(metavar="SOURCE")] = "sim"
    """A camera's number, a stream, a video, a folder of pictures; sim: a simulated webcam."""
    camera: Annotated[
        Path | None, arg(metavar="FILE", help_behavior_hint="(needed but for sim)")
    ] = None
    """The camera's calibration: a result.json, a camera.yaml, any other camera file, or the folder
    of a calibration."""
    board: BoardOptions = field(default_factory=BoardOptions)
    flip: Switch = False
    """Exchange left and right: for pictures that are mirrored."""
    language: LanguageOption = None
    """Language of the page; usually the browser's own."""
    host: str = "127.0.0.1"
    """Address the page listens on; 0.0.0.0 lets other machines in, with the token that is
    printed."""
    port: int = 8080
    """Port of the page; the next free one is used if it is taken."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        if self.camera is None and self.source != "sim":
            raise VenusError(
                "Lengths are measured with a calibrated camera; give its file with --camera FILE "
                "(venus3d guide or venus3d calibrate make one)."
            )
        check_range("--port", self.port, 1, 65535)

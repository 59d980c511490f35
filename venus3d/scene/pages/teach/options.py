"""Options of the teaching page; a docstring is its option's `--help`."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional

from venus3d.engine.errors import VenusError
from venus3d.options import BoardOptions, LanguageOption, Switch, check_range, optional


@dataclass(frozen=True)
class TeachOptions:
    """Show what a pose is and how it comes apart, in the browser."""

    lesson: Annotated[Positional[str], optional("LESSON", "the first")] = ""
    """A lesson's name, or a lesson file of your own (.toml)."""
    board: BoardOptions = field(default_factory=BoardOptions)
    camera: Annotated[Path | None, optional("FILE", "a simulated webcam")] = None
    """The calibrated camera that is taught with: a result.json, a camera.yaml, any other camera
    file, or the folder of a calibration."""
    export: Annotated[Path | None, optional("FILE")] = None
    """Write the lesson to a file and end: .html (plays offline), .png (a sheet of the four steps),
    .mp4 or .gif (the animation)."""
    dark: Switch = False
    """With --export: .html, .mp4 or .gif in dark colours, for a dark room."""
    follow_me: Switch = False
    """The tabs of a class show what the teacher's shows, until the teacher lets go. That is the tab
    opened first on the machine that this runs on."""
    language: LanguageOption = None
    """Language of the page and of the shipped lessons; usually each browser's own, and English with
    --export."""
    host: str = "127.0.0.1"
    """Address the page listens on; 0.0.0.0 lets other machines in, without a password."""
    token: Switch = False
    """With another --host: let in only who has the address that is printed, by the token in it."""
    port: int = 8080
    """Port of the page; the next free one is used if it is taken."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        if self.dark and (self.export is None or self.export.suffix.lower() == ".png"):
            raise VenusError(
                "--dark goes with --export and a file that is shown on a screen (.html, .mp4, "
                ".gif): a sheet is for paper, and on the page the key B does it."
            )
        if self.follow_me and self.export is not None:
            raise VenusError("--follow-me is for the page; leave it out with --export.")
        check_range("--port", self.port, 1, 65535)

"""What a person can choose for practice. Each field's docstring is its `--help` text."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from tyro.conf import arg

from venus3d.options import BoardOptions, check_range


@dataclass(frozen=True)
class PracticeOptions:
    """One server on which trainees practise, each with a board of their own."""

    board: BoardOptions = field(default_factory=BoardOptions)
    camera: Annotated[
        Path | None, arg(metavar="CAMERA.YAML", help_behavior_hint="(usual: a simulated webcam)")
    ] = None
    """The calibrated camera that is practised with."""
    seed: int = 0
    """One number that makes the target poses repeat."""
    host: str = "127.0.0.1"
    """Address the page listens on; 0.0.0.0 lets other machines in, without a password."""
    port: int = 8080
    """Port of the page; the next free one is used if it is taken."""
    output: Annotated[Path, arg(metavar="DIR")] = Path("venus3d-practice")
    """Folder for practice.csv: one row for each pose that was reached or given up."""

    def check(self) -> None:
        """Raises `VenusError` for the first option that cannot be met."""
        self.board.board()
        check_range("--port", self.port, 1, 65535)
        check_range("--seed", self.seed, 0, 2**63)

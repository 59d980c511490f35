"""practice.csv: one line for each pose that a trainee reached or gave up.

All trainees of a server share the file; whoever practises again later goes on in it by name.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from venus3d.storage.rows import RowFile, columns_of


@dataclass(frozen=True)
class PracticeRow:
    """One pose as it went. The fields are the columns of the file, in their order."""

    trainee: str
    """The name, or guest and a number where none was given."""
    level: int
    """1 ... 6: how many of the six numbers of the pose had to be found."""
    free: str
    """Which: "zr xt"."""
    pose: int
    """1 ...: the pose's number within this level; the same target for everybody."""
    help: str
    """steps, axes, outline or none."""
    outcome: str
    """reached, or given up."""
    seconds: float
    """From the first move until the board was at the target to stay, or was given up."""
    moved_by: str
    """What the board was moved with, in order of appearance: "keys gizmo"."""
    path_mm: float
    """How far the board's centre was moved, millimetres."""
    shortest_mm: float
    """The straight line from the start to the target, millimetres."""
    path_deg: float
    """How far the board was turned, all turns added up, degrees."""
    shortest_deg: float
    """The one turn from the start to the target, degrees."""
    off_mm: float
    """What was left to the target at the end, millimetres."""
    off_deg: float
    """The one turn that was left at the end, degrees."""
    xr_deg: float
    yr_deg: float
    zr_deg: float
    xt_mm: float
    yt_mm: float
    zt_mm: float
    """The target, `T_camera_board` as a pose vector."""
    seed: int
    time: str
    """When, by the computer's clock, ISO 8601."""


COLUMNS = columns_of(PracticeRow)


class PracticeFile(RowFile[PracticeRow]):
    """A practice.csv that is open for appending; closed by `close`."""

    def __init__(self, path: Path) -> None:
        """Open, or begin, the file. Raises `StorageError` if it cannot be written or is another."""
        super().__init__(path, PracticeRow, "practice times", "go on with the next pose")

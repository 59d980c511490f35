"""trial.csv: one line for each pose of each participant, on disk before the next pose is shown.

Any number of participants share a file. It is only ever appended to, so that whatever happens,
nothing that was measured is lost.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from venus3d.storage.rows import RowFile, columns_of


@dataclass(frozen=True)
class TrialRow:
    """One pose as it went. The fields are the columns of the file, in their order."""

    participant: str
    number: int
    """1 ...: the participant's, in order of appearance; decides the order of the helps."""
    order: str
    """The helps in this participant's order: "steps axes outline"."""
    attempt: int
    """1; 2 where a help was begun again after a run had been broken off: the last one counts."""
    place: int
    """1 ... 3: whether this was the participant's first, second or third help."""
    help: str
    pose: int
    """1 ...: the pose's number, the same target under every help."""
    outcome: str
    """reached, or given up."""
    seconds: float
    """From when the pose was shown until it was reached and held, or given up."""
    since_first_s: float
    """From when the first pose of this help was done with: the paper's time."""
    since_start_s: float
    """From the start of this help."""
    overlap: float
    """Of the board's silhouette and the target's at the end, 0 ... 1."""
    off_mm: float
    """From the board's centre to its place at the end, millimetres; nan if it was not seen."""
    off_deg: float
    """The turn that was left at the end, degrees; nan if it was not seen."""
    xr_deg: float
    yr_deg: float
    zr_deg: float
    xt_mm: float
    yt_mm: float
    zt_mm: float
    """The target, `T_camera_board` as a pose vector."""
    source: str
    hand: str
    """person, or autopilot: the simulated hand, which is no measurement of people."""
    seed: int
    poses: int
    """How many poses there are under each help."""
    time: str
    """When, by the computer's clock, ISO 8601."""


COLUMNS = columns_of(TrialRow)


class TrialFile(RowFile[TrialRow]):
    """A trial.csv that is open for appending; closed by `close`."""

    def __init__(self, path: Path) -> None:
        """Open, or begin, the file. Raises `StorageError` if it cannot be written or is another."""
        super().__init__(path, TrialRow, "trial times", "start again with the same --participant")

"""practice.csv and trial.csv: one line for each pose that was reached or given up.

Both have the same columns; what only the other exercise knows is empty, 0 or nan. A file is only
ever appended to, and each line is on the disk before anything else happens, so that whatever is
pulled out of the wall, nothing that was measured is lost.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from datetime import datetime, timezone
from io import StringIO
from pathlib import Path
from typing import Literal, TextIO, TypedDict, get_type_hints

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.pose import Pose

ExerciseKind = Literal["practice", "trial"]
Outcome = Literal["reached", "given up"]
REACHED: Outcome = "reached"
GIVEN_UP: Outcome = "given up"
NAN = float("nan")


@dataclass(frozen=True, kw_only=True)
class ExerciseRow:
    """One pose as it went. The fields are the columns of the file, in their order."""

    participant: str
    """The name; where none was given, "guest 1" (practice) or "P1" (trial)."""
    number: int = 0
    """Trial: 1 ..., in order of appearance; decides the order of the helps."""
    order: str = ""
    """Trial: the helps in this participant's order: "steps axes outline"."""
    attempt: int = 1
    """Trial: 2 where a help was begun again after a run had been broken off: the last counts."""
    place: int = 0
    """Trial: 1 ... 3, whether this was the participant's first, second or third help."""
    level: int = 0
    """Practice: 1 ... 6, how many of the six numbers of the pose had to be found."""
    free: str = ""
    """Practice: which, "zr xt"."""
    help: str
    """steps, axes, outline or none."""
    pose: int
    """1 ...: the pose's number within the level or the help; the same target for everybody."""
    poses: int = 0
    """Trial: how many poses there are under each help."""
    outcome: str
    """reached, or given up."""
    seconds: float
    """Until it was reached or given up: practice, from the first move, without the second of
    holding still; trial, from when the pose was shown."""
    since_first_s: float = NAN
    """Trial: from when the first pose of this help was done with: the paper's time."""
    since_start_s: float = NAN
    """Trial: from the start of this help."""
    moved_by: str
    """Practice: what the board was moved with, the last one last, "keys gizmo". Trial: person, or
    autopilot: the simulated hand, which is no measurement of people."""
    path_mm: float = NAN
    """Practice: how far the board's centre was moved, millimetres."""
    shortest_mm: float = NAN
    """Practice: the straight line from the start to the target, millimetres."""
    path_deg: float = NAN
    """Practice: how far the board was turned, all turns added up, degrees."""
    shortest_deg: float = NAN
    """Practice: the one turn from the start to the target, degrees."""
    overlap: float
    """Of the board's silhouette and the target's at the end, 0 ... 1."""
    off_mm: float
    """From the board's centre to its place at the end, millimetres; nan if it was not seen."""
    off_deg: float
    """The one turn that was left at the end, degrees; nan if it was not seen."""
    xr_deg: float
    yr_deg: float
    zr_deg: float
    xt_mm: float
    yt_mm: float
    zt_mm: float
    """The target, `T_camera_board` as a pose vector."""
    source: str = ""
    """Trial: the camera that looked on."""
    seed: int
    time: str = ""
    """When it was written, by the computer's clock, ISO 8601."""


COLUMNS = tuple(field.name for field in fields(ExerciseRow))
_TYPES = get_type_hints(ExerciseRow)
_ONCE_MORE: dict[ExerciseKind, str] = {
    "practice": "go on with the next pose",
    "trial": "start again with the same --participant",
}
"""What a person should do after having made room on a full disk."""


class ExerciseFile:
    """A file of rows that is open for appending; closed by `close`. Used by one thread."""

    def __init__(self, path: Path, kind: ExerciseKind) -> None:
        """Open, or begin, the file; folders are made.

        Raises `StorageError` if the file cannot be written or is another program's.
        """
        self.path = path
        self._kind: ExerciseKind = kind
        self.rows: list[ExerciseRow] = []
        """What is in it, what was appended included."""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: TextIO = path.open("a+", newline="", encoding="utf-8")
        except OSError as error:
            raise StorageError(
                f"{path} cannot be written ({(error.strerror or str(error)).lower()}); choose "
                "another folder with --output."
            ) from error
        try:
            self._file.seek(0)
            text = self._text()
            self.rows = self._rows_of(text)
            if not text:
                self._write(",".join(COLUMNS) + "\n")
            elif not text.endswith(("\n", "\r")):  # a text editor left the last line's end out
                self._write("\n")
        except BaseException:
            self._file.close()
            raise

    def append(self, row: ExerciseRow) -> None:
        """Put one line on the disk, with the time if it has none. Raises `StorageError` if that
        fails."""
        now = datetime.now(timezone.utc).isoformat(timespec="seconds")
        row = row if row.time else replace(row, time=now)
        self.rows.append(row)
        values = {
            name: f"{value:.3f}" if isinstance(value, float) else value
            for name, value in asdict(row).items()
        }
        line = StringIO(newline="")
        csv.DictWriter(line, COLUMNS, lineterminator="\n").writerow(values)
        self._write(line.getvalue())

    def close(self) -> None:
        """Close the file. May be called twice."""
        self._file.close()

    def _write(self, text: str) -> None:
        try:
            self._file.write(text)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise StorageError(
                f"A time could not be written to {self.path} ({(error.strerror or '').lower()}); "
                f"make room on the disk and {_ONCE_MORE[self._kind]}."
            ) from error

    def _text(self) -> str:
        try:
            return self._file.read()
        except (UnicodeDecodeError, OSError) as error:
            raise self._another() from error

    def _another(self) -> StorageError:
        return StorageError(
            f"{self.path} is no file of {self._kind} times, or of another version; move it away or "
            "choose another folder with --output."
        )

    def _rows_of(self, text: str) -> list[ExerciseRow]:
        if not text:
            return []
        # A spreadsheet may have put a byte order mark before the first name.
        reader = csv.reader(StringIO(text.removeprefix("\ufeff"), newline=""))
        try:
            if tuple(next(reader, ())) != COLUMNS:
                raise self._another()
            return [self._row_of(line, reader.line_num) for line in reader if line]
        except csv.Error as error:
            raise self._another() from error

    def _row_of(self, line: Sequence[str], number: int) -> ExerciseRow:
        try:
            pairs = zip(COLUMNS, line, strict=True)
            return ExerciseRow(**{name: _TYPES[name](text) for name, text in pairs})
        except ValueError as error:
            raise StorageError(
                f"Line {number} of {self.path} cannot be read; mend or delete it in a text editor."
            ) from error


class TargetColumns(TypedDict):
    """The columns of a row about its target."""

    xr_deg: float
    yr_deg: float
    zr_deg: float
    xt_mm: float
    yt_mm: float
    zt_mm: float


def target_columns(target: Pose) -> TargetColumns:
    """The columns about a target, `T_camera_board`."""
    xr, yr, zr, xt, yt, zt = (float(value) for value in target.vector())
    return TargetColumns(
        xr_deg=xr, yr_deg=yr, zr_deg=zr, xt_mm=1000 * xt, yt_mm=1000 * yt, zt_mm=1000 * zt
    )

"""practice.csv and trial.csv: one row for each pose that was reached or given up.

Both have the same columns; those that do not apply are empty, 0 or nan. Files are only appended to,
and each row is synced to disk at once, so that a power failure loses no measurement.
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
from venus3d.engine.printable import is_seen
from venus3d.engine.sentences import Sentence
from venus3d.storage.folder import reason

ExerciseKind = Literal["practice", "trial"]
Outcome = Literal["reached", "given up"]
REACHED: Outcome = "reached"
GIVEN_UP: Outcome = "given up"
NAN = float("nan")


@dataclass(frozen=True, kw_only=True)
class ExerciseRow:
    """The record of one pose. The fields are the columns of the file, in order."""

    participant: str
    """The name; by default "guest 1" (practice) or "P1" (trial)."""
    number: int = 0
    """Trial: 1 ..., in order of participation; decides the order of the helps."""
    order: str = ""
    """Trial: the helps in this participant's order: "steps axes outline"."""
    attempt: int = 1
    """Trial: 2 if a help was repeated after an interrupted run: the last counts."""
    place: int = 0
    """Trial: 1 ... 3, whether this was the participant's first, second or third help."""
    level: int = 0
    """Practice: 1 ... 6, the number of pose parameters to find."""
    free: str = ""
    """Practice: which, "zr xt"."""
    help: str
    """steps, axes, outline or none."""
    pose: int
    """1 ...: the pose's number within the level or the help; the same target for everybody."""
    poses: int = 0
    """Trial: number of poses with each help."""
    outcome: str
    """reached, or given up."""
    seconds: float
    """Until the pose was reached or given up: practice, from the first move and without the final
    second of holding still; trial, from when the pose was shown."""
    since_first_s: float = NAN
    """Trial: since the first pose of this help was completed: the paper's time."""
    since_start_s: float = NAN
    """Trial: since the start of this help."""
    moved_by: str
    """Practice: the means of moving the board, in order, "keys gizmo". Trial: person, or autopilot
    for the simulated hand, which does not measure people."""
    path_mm: float = NAN
    """Practice: path length of the board's centre, millimetres."""
    shortest_mm: float = NAN
    """Practice: the straight line from the start to the target, millimetres."""
    path_deg: float = NAN
    """Practice: sum of all turns, degrees."""
    shortest_deg: float = NAN
    """Practice: the single rotation from the start to the target, degrees."""
    overlap: float
    """Of the board's silhouette and the target's at the end, 0 ... 1."""
    off_mm: float
    """Distance of the board's centre from its target at the end, millimetres; nan if not seen."""
    off_deg: float
    """Remaining single rotation at the end, degrees; nan if the board was not seen."""
    xr_deg: float
    yr_deg: float
    zr_deg: float
    xt_mm: float
    yt_mm: float
    zt_mm: float
    """The target, `T_camera_board` as a pose vector."""
    source: str = ""
    """Trial: the camera."""
    seed: int
    time: str = ""
    """When the row was written, by the computer's clock, ISO 8601."""


COLUMNS = tuple(field.name for field in fields(ExerciseRow))
_LONGEST_NAME = 40
_FORMULA = "=+-@|%\uff1d\uff0b\uff0d\uff20\u2212 "
"""What a formula begins with, fullwidth signs and the minus sign too."""
_FREE = ("participant", "source")
"""Columns with a person's words."""
_TYPES = get_type_hints(ExerciseRow)
_NOT_WRITTEN: dict[ExerciseKind, Sentence] = {
    "practice": Sentence(
        "A time could not be written to {path} ({reason}); make room on the disk and go on with "
        "the next pose."
    ),
    "trial": Sentence(
        "A time could not be written to {path} ({reason}); make room on the disk and start again "
        "with the same --participant."
    ),
}


def name_of(text: str) -> str:
    """A person's name as the file holds it: on one line, at most 40 characters that can be seen,
    and nothing that a spreadsheet reads as a formula."""
    return harmless(" ".join(text.split()))[:_LONGEST_NAME].rstrip()


def harmless(text: str) -> str:
    """The text without what nobody sees, and without signs in front that begin a formula."""
    seen = "".join(one for one in text if is_seen(one) or one == "\n")
    bare = seen.lstrip()
    return bare.lstrip(_FORMULA) if bare.startswith(tuple(_FORMULA.strip())) else seen


class ExerciseFile:
    """A file of rows opened for appending. Used by one thread."""

    def __init__(self, path: Path, kind: ExerciseKind) -> None:
        """Open or create the file and its folders.
        Raises `StorageError` if the file cannot be written or is another program's."""
        self.path = path
        self._kind: ExerciseKind = kind
        self.rows: list[ExerciseRow] = []
        """The file's rows, including appended ones."""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file: TextIO = path.open("a+", newline="", encoding="utf-8")
        except OSError as error:
            raise StorageError(
                f"{path} cannot be written ({reason(error)}); choose another folder with --output."
            ) from error
        try:
            self._file.seek(0)
            text = self._text()
            self.rows = self._rows_of(text)
            if not text:
                self._write(",".join(COLUMNS) + "\n")
            elif not text.endswith(("\n", "\r")):  # a text editor omitted the final newline
                self._write("\n")
        except BaseException:
            self._file.close()
            raise

    def append(self, row: ExerciseRow) -> None:
        """Write one row to disk, adding the time if missing. Raises `StorageError` on failure."""
        now = datetime.now(timezone.utc).isoformat(timespec="seconds")
        row = row if row.time else replace(row, time=now)
        self.rows.append(row)
        values = {
            name: f"{value:.3f}" if isinstance(value, float) else value
            for name, value in asdict(row).items()
        }
        values |= {n: harmless(v) for n, v in values.items() if isinstance(v, str) and n in _FREE}
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
                _NOT_WRITTEN[self._kind].format(
                    path=self.path, reason=(error.strerror or "").lower()
                )
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
        # A spreadsheet may have added a byte order mark.
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

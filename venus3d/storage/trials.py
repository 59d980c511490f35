"""trial.csv: one line for each pose of each participant, on disk before the next pose is shown.

Any number of participants share a file. It is only ever appended to, so that whatever happens,
nothing that was measured is lost.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from io import StringIO
from pathlib import Path
from typing import TextIO, get_type_hints

from venus3d.engine.errors import StorageError


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


COLUMNS = tuple(f.name for f in fields(TrialRow))
_TYPES = get_type_hints(TrialRow)


class TrialFile:
    """A trial.csv that is open for appending; closed by `close`."""

    def __init__(self, path: Path) -> None:
        """Open, or begin, the file. Raises `StorageError` if it cannot be written or is another."""
        self.path = path
        self.rows: list[TrialRow] = []
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
            text = _text_of(self._file, path)
            self.rows = _rows_of(text, path)
            if not text:
                self._write(",".join(COLUMNS) + "\n")
            elif not text.endswith(("\n", "\r")):  # a text editor left the last line's end out
                self._write("\n")
        except BaseException:
            self._file.close()
            raise

    def append(self, row: TrialRow) -> None:
        """Put one line on the disk. Raises `StorageError` if that fails."""
        self.rows.append(row)
        values = asdict(row)
        for name, value in values.items():
            if isinstance(value, float):
                values[name] = f"{value:.3f}"
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
                "make room on the disk and start again with the same --participant."
            ) from error


def _text_of(file: TextIO, path: Path) -> str:
    try:
        return file.read()
    except (UnicodeDecodeError, OSError) as error:
        raise _another(path) from error


def _another(path: Path) -> StorageError:
    return StorageError(
        f"{path} is no file of trial times, or of another version; move it away or choose another "
        "folder with --output."
    )


def _rows_of(text: str, path: Path) -> list[TrialRow]:
    """The lines of a trial.csv. Raises `StorageError` for any other text."""
    if not text:
        return []
    # A spreadsheet may have put a byte order mark before the first name.
    reader = csv.reader(StringIO(text.removeprefix("\ufeff"), newline=""))
    try:
        if tuple(next(reader, ())) != COLUMNS:
            raise _another(path)
        return [_row_of(line, path, reader.line_num) for line in reader if line]
    except csv.Error as error:
        raise _another(path) from error


def _row_of(line: Sequence[str], path: Path, number: int) -> TrialRow:
    try:
        values = {name: _TYPES[name](text) for name, text in zip(COLUMNS, line, strict=True)}
        return TrialRow(**values)
    except ValueError as error:
        raise StorageError(
            f"Line {number} of {path} cannot be read; mend or delete it in a text editor."
        ) from error

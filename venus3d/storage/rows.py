"""A table that is only ever appended to: one line of a CSV file for each frozen row.

Each line is on the disk before anything else happens, so that whatever is pulled out of the wall,
nothing that was measured is lost. Which columns there are is the row's own matter.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Sequence
from dataclasses import asdict, fields
from datetime import datetime, timezone
from io import StringIO
from pathlib import Path
from typing import Any, Generic, TextIO, TypeVar, get_type_hints

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.pose import Pose

Row = TypeVar("Row")


class RowFile(Generic[Row]):
    """A file of rows that is open for appending; closed by `close`. Used by one thread."""

    def __init__(self, path: Path, kind: type[Row], what: str, once_more: str) -> None:
        """Open, or begin, the file.

        Args:
            path: where; folders are made.
            kind: the frozen dataclass of a row, of texts and numbers; its fields are the columns.
            what: what such a file holds, "trial times": for the sentence that refuses another.
            once_more: what a person should do after having made room on a full disk.

        Raises `StorageError` if the file cannot be written or is another program's.
        """
        self.path = path
        self._kind, self._what, self._once_more = kind, what, once_more
        self.rows: list[Row] = []
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
                self._write(",".join(columns_of(kind)) + "\n")
            elif not text.endswith(("\n", "\r")):  # a text editor left the last line's end out
                self._write("\n")
        except BaseException:
            self._file.close()
            raise

    def append(self, row: Row) -> None:
        """Put one line on the disk. Raises `StorageError` if that fails."""
        self.rows.append(row)
        values = _values(row)
        line = StringIO(newline="")
        csv.DictWriter(line, columns_of(self._kind), lineterminator="\n").writerow(values)
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
                f"make room on the disk and {self._once_more}."
            ) from error

    def _text(self) -> str:
        try:
            return self._file.read()
        except (UnicodeDecodeError, OSError) as error:
            raise self._another() from error

    def _another(self) -> StorageError:
        return StorageError(
            f"{self.path} is no file of {self._what}, or of another version; move it away or "
            "choose another folder with --output."
        )

    def _rows_of(self, text: str) -> list[Row]:
        if not text:
            return []
        # A spreadsheet may have put a byte order mark before the first name.
        reader = csv.reader(StringIO(text.removeprefix("\ufeff"), newline=""))
        try:
            if tuple(next(reader, ())) != columns_of(self._kind):
                raise self._another()
            return [self._row_of(line, reader.line_num) for line in reader if line]
        except csv.Error as error:
            raise self._another() from error

    def _row_of(self, line: Sequence[str], number: int) -> Row:
        types = get_type_hints(self._kind)
        columns = columns_of(self._kind)
        try:
            values = {name: types[name](text) for name, text in zip(columns, line, strict=True)}
            return self._kind(**values)
        except ValueError as error:
            raise StorageError(
                f"Line {number} of {self.path} cannot be read; mend or delete it in a text editor."
            ) from error


def columns_of(kind: Any) -> tuple[str, ...]:
    """The columns of a file of such rows: the names of the dataclass' fields."""
    return tuple(field.name for field in fields(kind))


def target_columns(target: Pose) -> dict[str, float]:
    """The columns xr_deg ... zt_mm of a row about a target, `T_camera_board`."""
    xr, yr, zr, xt, yt, zt = (float(value) for value in target.vector())
    shifts = {"xt_mm": 1000 * xt, "yt_mm": 1000 * yt, "zt_mm": 1000 * zt}
    return {"xr_deg": xr, "yr_deg": yr, "zr_deg": zr, **shifts}


def time_column() -> str:
    """Now, by the computer's clock, ISO 8601."""
    return datetime.now(timezone.utc).isoformat(timespec="seconds")


def _values(row: Any) -> dict[str, object]:
    return {
        name: f"{value:.3f}" if isinstance(value, float) else value
        for name, value in asdict(row).items()
    }

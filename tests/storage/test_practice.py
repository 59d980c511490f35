"""practice.csv: what is there stays, and another program's file is refused."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from venus3d.engine.errors import StorageError
from venus3d.storage.practice import COLUMNS, PracticeFile, PracticeRow

ROW = PracticeRow(
    "Anna, 3b", 2, "zr xt", 4, "outline", "reached", 12.25, "keys gizmo", 150.0, 120.5, 40.0, 30.0,
    2.5, 0.5, 0.0, 0.0, 30.0, 120.5, 0.0, 500.0, 7, "2026-01-02T03:04:05+00:00",
)  # fmt: skip


def test_a_second_run_appends_and_pythons_reader_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "new" / "practice.csv"
    for row in (ROW, replace(ROW, pose=5, outcome="given up")):
        file = PracticeFile(path)
        file.append(row)
        file.close()
    with path.open(newline="") as text:
        first, second = csv.DictReader(text)
    assert tuple(first) == COLUMNS
    assert (first["trainee"], float(first["seconds"])) == ("Anna, 3b", 12.25)
    assert (second["pose"], second["outcome"]) == ("5", "given up")
    again = PracticeFile(path)
    assert [row.pose for row in again.rows] == [4, 5]
    again.close()


def test_another_programs_file_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "practice.csv"
    path.write_text("time,x\n1,2\n")
    with pytest.raises(StorageError, match=r"no file of practice times.*--output"):
        PracticeFile(path)
    assert path.read_text() == "time,x\n1,2\n"

"""practice.csv: what is there stays, and another program's file is refused."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from venus3d.engine.errors import StorageError
from venus3d.storage.exercise import COLUMNS, ExerciseFile, ExerciseRow, name_of

ROW = ExerciseRow(
    participant="Anna, 3b",
    level=2,
    free="zr xt",
    pose=4,
    help="outline",
    outcome="reached",
    seconds=12.25,
    moved_by="keys gizmo",
    path_mm=150.0,
    shortest_mm=120.5,
    path_deg=40.0,
    shortest_deg=30.0,
    overlap=0.9,
    off_mm=2.5,
    off_deg=0.5,
    xr_deg=0.0,
    yr_deg=0.0,
    zr_deg=30.0,
    xt_mm=120.5,
    yt_mm=0.0,
    zt_mm=500.0,
    seed=7,
)


def test_a_second_run_appends_and_pythons_reader_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "new" / "practice.csv"
    for row in (ROW, replace(ROW, pose=5, outcome="given up")):
        file = ExerciseFile(path, "practice")
        file.append(row)
        file.close()
    with path.open(newline="") as text:
        first, second = csv.DictReader(text)
    assert tuple(first) == COLUMNS
    assert (first["participant"], float(first["seconds"])) == ("Anna, 3b", 12.25)
    assert first["time"] and first["since_first_s"] == "nan", "a trial's column"
    assert (second["pose"], second["outcome"]) == ("5", "given up")
    again = ExerciseFile(path, "practice")
    assert [row.pose for row in again.rows] == [4, 5]
    again.close()


def test_another_programs_file_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "practice.csv"
    path.write_text("time,x\n1,2\n")
    with pytest.raises(StorageError, match=r"no file of practice times.*--output"):
        ExerciseFile(path, "practice")
    assert path.read_text() == "time,x\n1,2\n"


HOSTILE = {
    "=1+1": "1+1",
    "\uff1d1+1": "1+1",
    "\uff20SUM(A1)": "SUM(A1)",
    "\u22122": "2",
    "\0=cmd|x": "cmd|x",
    " \t+ -@x": "x",
    "a\0b\x1b[31mc": "ab[31mc",
    "a\u202eb\ud800": "ab",
    "=": "",
    "x" * 90: "x" * 40,
}


@pytest.mark.parametrize("typed", HOSTILE, ids=ascii)
def test_a_name_is_no_formula_and_has_nothing_unseen(typed: str, tmp_path: Path) -> None:
    assert name_of(typed) == HOSTILE[typed]
    assert name_of("Zoë O'Hara-Łuk (3b)") == "Zoë O'Hara-Łuk (3b)"
    file = ExerciseFile(tmp_path / "practice.csv", "practice")
    file.append(replace(ROW, participant=typed, source=typed))  # by whatever way it came there
    file.close()
    raw = file.path.read_bytes()
    assert b"\0" not in raw and b"\x1b" not in raw
    with file.path.open(newline="", encoding="utf-8") as text:
        (row,) = csv.DictReader(text)
    for cell in (row["participant"], row["source"]):
        assert cell == "" or cell[0].isalnum()

"""trial.csv: what was measured is on the disk at once, and nothing that is there is ever lost."""

from __future__ import annotations

import csv
import errno
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from venus3d.engine.errors import StorageError
from venus3d.storage.exercise import COLUMNS, ExerciseFile, ExerciseRow

ROW = ExerciseRow(
    participant="Anna, 3b",
    number=1,
    order="steps axes outline",
    attempt=1,
    place=2,
    help="axes",
    pose=4,
    outcome="reached",
    seconds=12.25,
    since_first_s=40.5,
    since_start_s=52.125,
    overlap=0.875,
    off_mm=3.5,
    off_deg=1.25,
    xr_deg=-10.0,
    yr_deg=20.5,
    zr_deg=0.0,
    xt_mm=100.0,
    yt_mm=-50.0,
    zt_mm=600.0,
    source="sim",
    moved_by="person",
    seed=0,
    poses=10,
    time="2026-01-02T03:04:05+00:00",
)


def written(path: Path, *rows: ExerciseRow) -> None:
    file = ExerciseFile(path, "trial")
    for row in rows:
        file.append(row)
    file.close()


def test_pythons_own_csv_reader_reads_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "new folder" / "trial.csv"
    written(path, ROW, replace(ROW, pose=5, outcome="given up", off_mm=float("nan")))
    with path.open(newline="") as file:
        first, second = csv.DictReader(file)
    assert tuple(first) == COLUMNS
    assert first["participant"] == "Anna, 3b"
    assert float(first["seconds"]) == 12.25 and float(first["xt_mm"]) == 100.0
    assert (second["outcome"], second["off_mm"]) == ("given up", "nan")


def test_a_line_is_on_the_disk_before_the_file_is_closed(tmp_path: Path) -> None:
    """A teacher may pull the plug: nothing waits in a buffer."""
    file = ExerciseFile(tmp_path / "trial.csv", "trial")
    file.append(ROW)
    assert len((tmp_path / "trial.csv").read_text().splitlines()) == 2
    file.close()
    file.close()


@pytest.mark.parametrize("name", ['a "nick" name', "two\nlines", "comma, too", "Zoë", " P1 "])
def test_any_name_comes_back_as_it_was(tmp_path: Path, name: str) -> None:
    row = replace(ROW, participant=name)
    written(tmp_path / "trial.csv", row, row)
    file = ExerciseFile(tmp_path / "trial.csv", "trial")
    assert [str(r) for r in file.rows] == 2 * [str(row)]
    file.close()


TOUCHES: dict[str, Callable[[bytes], bytes]] = {
    "the last line's end is gone": lambda text: text.rstrip(b"\n"),
    "Windows line ends": lambda text: text.replace(b"\n", b"\r\n"),
    "a spreadsheet's byte order mark": lambda text: b"\xef\xbb\xbf" + text,
    "empty lines at the end": lambda text: text + b"\n\n",
}


@pytest.mark.parametrize("how", TOUCHES)
def test_a_file_that_went_through_an_editor_is_gone_on_with(tmp_path: Path, how: str) -> None:
    path = tmp_path / "trial.csv"
    written(path, ROW)
    path.write_bytes(TOUCHES[how](path.read_bytes()))
    written(path, replace(ROW, pose=5))
    file = ExerciseFile(path, "trial")
    assert [row.pose for row in file.rows] == [4, 5]
    file.close()


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"time,x,y\n1,2,3\n", id="another table"),
        pytest.param(b"\n", id="an empty line"),
        pytest.param(b"\xef\xbb\xbf", id="only a byte order mark"),
        pytest.param(b"\xff\xfe\x00\x9c" * 50, id="no text"),
        pytest.param(b"a\x00b\n", id="a zero byte"),
    ],
)
def test_another_file_is_refused_and_left_alone(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "trial.csv"
    path.write_bytes(content)
    with pytest.raises(StorageError, match=r"no file of trial times.*--output"):
        ExerciseFile(path, "trial")
    assert path.read_bytes() == content


@pytest.mark.parametrize("damage", [("12.250", "12.x"), (",reached", "")])
def test_a_damaged_line_is_named(tmp_path: Path, damage: tuple[str, str]) -> None:
    path = tmp_path / "trial.csv"
    written(path, ROW, ROW)
    head, first, second = path.read_text().splitlines(keepends=True)
    path.write_text(head + first + second.replace(*damage))
    with pytest.raises(StorageError, match=r"Line 3 of .*trial.csv"):
        ExerciseFile(path, "trial")


def test_a_place_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(StorageError, match=r"cannot be written .* --output"):
        ExerciseFile(tmp_path / "taken" / "trial.csv", "trial")
    (tmp_path / "trial.csv").mkdir()
    with pytest.raises(StorageError, match=r"cannot be written .*is a directory"):
        ExerciseFile(tmp_path / "trial.csv", "trial")


def test_a_full_disk_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = ExerciseFile(tmp_path / "trial.csv", "trial")

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StorageError, match=r"no space left.*make room"):
        file.append(ROW)
    file.close()

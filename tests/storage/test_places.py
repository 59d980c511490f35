"""Where a command may write."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from venus3d.engine.errors import StorageError
from venus3d.storage.folder import prepare, write_bytes
from venus3d.storage.places import free_place


@pytest.fixture
def session(tmp_path: Path) -> Path:
    """A folder that is a session to whoever looks, without a result."""
    folder = tmp_path / "session"
    (folder / "views").mkdir(parents=True)
    for name in ("session.json", "events.jsonl", "views/001.png"):
        (folder / name).write_text(name)
    return folder


@pytest.mark.parametrize(
    "name",
    [
        *("session.json", "events.jsonl", "views/001.png", "views/new.png", "views/sub/new.png"),
        *("camera.yaml", "result.json", "views/../events.jsonl"),
    ],
)
def test_nothing_else_writes_a_sessions_files(session: Path, name: str) -> None:
    """There already or not, as a session writes its result later."""
    before = {path: path.read_bytes() for path in session.rglob("*") if path.is_file()}
    with pytest.raises(StorageError, match=r"session is the folder of a session.*--output"):
        free_place(session / name, replaces=True)
    with pytest.raises(StorageError, match=r"session is the folder of a session.*another place"):
        write_bytes(session / name, b"other")
    assert before == {path: path.read_bytes() for path in session.rglob("*") if path.is_file()}


def test_no_folder_of_results_is_made_among_a_sessions_pictures(session: Path) -> None:
    for folder in (session / "views", session / "views" / "new"):
        with pytest.raises(StorageError, match="name another with --export"):
            prepare(folder, "--export")
    assert not (session / "views" / "new").exists()


def test_a_link_leads_to_nothing_else(session: Path, tmp_path: Path) -> None:
    """Neither a link to the folder, nor a link in the place of the session's file."""
    os.symlink(session, tmp_path / "link")
    (session / "events.jsonl").rename(tmp_path / "journal")
    os.symlink(tmp_path / "journal", session / "events.jsonl")
    for path in (tmp_path / "link" / "camera.yaml", session / "events.jsonl"):
        with pytest.raises(StorageError, match="folder of a session"):
            write_bytes(path, b"other")


def test_new_names_are_free(session: Path, tmp_path: Path) -> None:
    """In a session's folder too; and its names elsewhere."""
    for path in (session / "report.html", session / "views.pdf", tmp_path / "views" / "1.png"):
        assert write_bytes(free_place(path, replaces=True), b"1").read_bytes() == b"1"
        assert write_bytes(free_place(path, replaces=True), b"2").read_bytes() == b"2"
    for name in ("camera.yaml", "result.json"):
        assert free_place(tmp_path / name, replaces=False)
    assert prepare(session) == session


def test_a_calibrations_two_files_stay_together(tmp_path: Path) -> None:
    for name in ("camera.yaml", "result.json"):
        (tmp_path / name).write_text(name)
        assert name == "result.json" or free_place(tmp_path / name, replaces=True)
    for name in ("camera.yaml", "result.json"):
        with pytest.raises(StorageError, match=r"belongs to the calibration.*with --save"):
            free_place(tmp_path / name, replaces=True, option="--save")


def test_a_source_is_not_written_over(tmp_path: Path) -> None:
    source = tmp_path / "a.yaml"
    source.write_text("a")
    with pytest.raises(StorageError, match="is the source itself"):
        free_place(tmp_path / "." / "a.yaml", source, replaces=True)
    with pytest.raises(StorageError, match="exists already"):
        free_place(source, replaces=False)
    assert free_place(source, tmp_path / "none.yaml", replaces=True) == source

"""Whatever is pulled out of the wall, and whoever else writes there: no result is lost."""

from __future__ import annotations

import json
import multiprocessing
import os
import re
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.storage.conftest import SUMMARY, Write
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.storage import folder as folder_module
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.storage.folder import write_bytes
from venus3d.storage.result_folder import ResultFolder

STAMP = r"-\d{4}-\d\d-\d\dT\d\d-\d\d-\d\d(-\d+)?"
NOON = time.mktime((2026, 11, 28, 13, 27, 42, 0, 0, -1))
KEPT = ("camera-2026-11-28T13-27-42.yaml", "result-2026-11-28T13-27-42.json")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def marks(folder: Path) -> dict[str, Any]:
    return {p.name: json.loads(p.read_text())["mark"] for p in folder.glob("result*.json")}


def earlier(folder: Path, **texts: str) -> Mapping[str, bytes]:
    """Files of another session, or of another program, from that noon."""
    for name, text in texts.items():
        path = folder / {"camera": "camera.yaml", "result": "result.json"}[name]
        path.write_text(text)
        os.utime(path, (NOON, NOON))
    return contents(folder)


def test_files_are_on_the_disk_before_they_take_their_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, write: Write
) -> None:
    if not Path("/proc/self/fd").exists():
        pytest.skip("only /proc tells which file is synced")
    done: list[str] = []
    fsync, replace = os.fsync, os.replace

    def synced(handle: int) -> None:
        name = os.readlink(f"/proc/self/fd/{handle}")
        done.append("folder" if Path(name) == tmp_path else f"sync {Path(name).name[1:7]}")
        fsync(handle)

    def replaced(old: Path, new: Path) -> None:
        done.append(f"name {new.name[:6]}")
        replace(old, new)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(os, "replace", replaced)
    renamed = ["name camera", "name result", "folder"]
    files = ResultFolder(tmp_path)
    write(files)
    assert done == ["sync camera", "sync result", *renamed]
    done.clear()
    write(ResultFolder(tmp_path))
    # The names under which the earlier pair is kept come first, too.
    assert done == ["sync camera", "sync result", "folder", *renamed]
    done.clear()
    write_bytes(tmp_path / "result.json", b"x")
    assert done == ["sync result", "name result", "folder"]


def test_an_earlier_result_is_kept_under_another_name_once(tmp_path: Path, write: Write) -> None:
    before = earlier(tmp_path, camera="their camera", result="their result")
    told: list[str] = []
    files = ResultFolder(tmp_path, told.append)
    assert contents(tmp_path) == before and not files.is_written, "nothing was written yet"
    for view in (1, 2, 3):
        assert write(files, view) == (tmp_path / "camera.yaml", tmp_path / "result.json")
    assert told == [f"The earlier result in {tmp_path} is kept as {KEPT[0]} and {KEPT[1]}."]
    after = contents(tmp_path)
    assert set(after) == {"camera.yaml", "result.json", *KEPT}
    assert [after[name] for name in KEPT] == [before["camera.yaml"], before["result.json"]]
    assert json.loads(after["result.json"])["mark"] == 3 and files.is_written
    read_camera_yaml(tmp_path / "camera.yaml")


def test_a_new_calibration_keeps_the_last_ones_result(tmp_path: Path, write: Write) -> None:
    files = ResultFolder(tmp_path)
    for mark, run in (("first", 1), ("first again", 1), ("second", 2), ("second again", 2)):
        write(files, mark, run)
    kept = marks(tmp_path)
    assert kept.pop("result.json") == "second again" and list(kept.values()) == ["first again"]
    assert len(list(tmp_path.glob("camera*.yaml"))) == 2 and files.is_written


@pytest.mark.parametrize("name", ["camera", "result"])
def test_one_file_alone_is_kept_as_well(tmp_path: Path, write: Write, name: str) -> None:
    """A foreign camera.yaml, a result whose camera was taken elsewhere."""
    earlier(tmp_path, **{name: "foreign"})
    told: list[str] = []
    write(ResultFolder(tmp_path, told.append))
    kept = KEPT[name == "result"]
    assert told == [f"The earlier result in {tmp_path} is kept as {kept}."]
    assert (tmp_path / kept).read_text() == "foreign"
    assert len(list(tmp_path.iterdir())) == 3


def test_ten_sessions_within_a_second_leave_ten_pairs(tmp_path: Path, write: Write) -> None:
    for number in range(10):
        write(ResultFolder(tmp_path), number)
        for path in (tmp_path / "camera.yaml", tmp_path / "result.json"):
            os.utime(path, (NOON, NOON))
    assert sorted(marks(tmp_path).values()) == list(range(10))
    tails = [f"-2026-11-28T13-27-42{tail}" for tail in ("", *(f"-{n}" for n in range(2, 10)))]
    names = {f"camera{tail}.yaml" for tail in ("", *tails)}
    assert set(contents(tmp_path)) == names | {f"result{tail}.json" for tail in ("", *tails)}


def test_halves_of_different_results_get_no_common_time(tmp_path: Path, write: Write) -> None:
    (tmp_path / KEPT[0]).write_text("somebody's")
    earlier(tmp_path, result="their result")
    write(ResultFolder(tmp_path))
    assert (tmp_path / KEPT[0]).read_text() == "somebody's"
    assert (tmp_path / "result-2026-11-28T13-27-42-2.json").read_text() == "their result"


def test_where_no_second_name_can_be_given_the_file_is_renamed(
    tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a memory stick with FAT."""

    def refused(*_: object) -> None:
        raise OSError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", refused)
    earlier(tmp_path, camera="their camera", result="their result")
    write(ResultFolder(tmp_path), 1)
    assert [(tmp_path / name).read_text() for name in KEPT] == ["their camera", "their result"]
    assert json.loads((tmp_path / "result.json").read_text())["mark"] == 1


def test_what_stood_there_is_kept_whatever_it_is(tmp_path: Path, write: Write) -> None:
    (tmp_path / "camera.yaml").mkdir()
    (tmp_path / "result.json").symlink_to("elsewhere")
    write(ResultFolder(tmp_path))
    kept = [path for path in tmp_path.iterdir() if re.fullmatch(rf".*{STAMP}\..*", path.name)]
    assert sorted((path.is_dir(), path.is_symlink()) for path in kept) == [
        (False, True),
        (True, False),
    ]


def test_a_full_disk_changes_nothing_and_is_tried_again(
    tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = earlier(tmp_path, camera="their camera", result="their result")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    files = ResultFolder(tmp_path)
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        for _ in range(3):
            with pytest.raises(StorageError, match=r"\(no space left on device\); make room"):
                write(files)
    assert contents(tmp_path) == before
    write(files, 1)
    assert len(list(tmp_path.iterdir())) == 4


def test_a_pair_that_cannot_be_replaced_is_not_kept_again_and_again(
    tmp_path: Path, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    earlier(tmp_path, camera="their camera", result="their result")
    files = ResultFolder(tmp_path)

    def locked(*_: object) -> None:
        raise PermissionError(13, "Permission denied")

    with monkeypatch.context() as patch:
        patch.setattr(folder_module.os, "replace", locked)
        for _ in range(3):
            with pytest.raises(StorageError, match="permission denied"):
                write(files)
    write(files)
    assert set(contents(tmp_path)) == {"camera.yaml", "result.json", *KEPT}


def test_a_folder_that_was_removed_comes_back(tmp_path: Path, write: Write) -> None:
    folder = tmp_path / "out"
    files = ResultFolder(folder)
    for path in write(files):
        path.unlink()
    folder.rmdir()
    write(files, 2)
    assert marks(folder) == {"result.json": 2}


def test_a_file_in_the_folders_place_is_told_until_it_is_gone(tmp_path: Path, write: Write) -> None:
    folder = tmp_path / "out"
    folder.write_text("in the way")
    files = ResultFolder(folder)
    with pytest.raises(StorageError, match=r"written to .*/out \(not a directory\)"):
        write(files)
    folder.unlink()
    write(files)
    assert set(contents(folder)) == {"camera.yaml", "result.json"}


def test_a_file_that_was_edited_meanwhile_is_kept(tmp_path: Path, write: Write) -> None:
    files = ResultFolder(tmp_path)
    camera, _ = write(files, 1)
    camera.write_text(camera.read_text() + "# by hand\n")
    write(files, 2)
    kept = [path for path in tmp_path.glob("camera-*.yaml") if "# by hand" in path.read_text()]
    assert len(kept) == 1 and len(list(tmp_path.iterdir())) == 3


def test_two_sessions_at_a_time_each_keep_their_newest(tmp_path: Path, write: Write) -> None:
    """Whose files were put aside goes on under the new names: two pairs, not one for each view."""
    first, second = ResultFolder(tmp_path), ResultFolder(tmp_path)
    for view in range(1, 6):
        write(first, f"first {view}")
        if view > 2:
            write(second, f"second {view}")
    assert second.paths[1].name == "result.json" and re.search(STAMP, first.paths[1].name)
    assert marks(tmp_path) == {
        "result.json": "second 5",
        first.paths[1].name: "first 5",
    }
    assert len(list(tmp_path.iterdir())) == 4


def _session(
    folder: Path, who: int, go: Any, calibration: Calibration, board: Board, views: int
) -> None:
    files = ResultFolder(folder)
    go.wait()
    for view in range(views):
        files.write(calibration, {**SUMMARY, "mark": [who, view]})


@pytest.mark.slow
def test_sessions_that_begin_at_the_same_moment_lose_nothing(
    tmp_path: Path, calibration: Calibration, default_board: Board
) -> None:
    """Four programs, three views each, twenty times: they meet at the first view or never."""
    context = multiprocessing.get_context("fork")
    for attempt in range(20):
        folder, go = tmp_path / str(attempt), context.Barrier(4)
        arguments = (calibration, default_board, 3)
        sessions = [
            context.Process(target=_session, args=(folder, who, go, *arguments)) for who in range(4)
        ]
        for session in sessions:
            session.start()
        for session in sessions:
            session.join(60)
            assert session.exitcode == 0
        assert sorted(marks(folder).values()) == [[who, 2] for who in range(4)]
        assert len(list(folder.iterdir())) == 8


def test_a_reader_never_meets_half_a_file_nor_none(tmp_path: Path, write: Write) -> None:
    write(ResultFolder(tmp_path), "first")
    stop = threading.Event()
    looks: list[int] = []
    wrong: list[BaseException] = []

    def look() -> None:
        while not stop.is_set():
            try:
                json.loads((tmp_path / "result.json").read_text())
                read_camera_yaml(tmp_path / "camera.yaml")
                looks.append(1)
            except BaseException as error:
                wrong.append(error)

    reader = threading.Thread(target=look)
    reader.start()
    for _ in range(10):
        session = ResultFolder(tmp_path)
        for _ in range(5):
            write(session)
    stop.set()
    reader.join()
    assert not wrong and len(looks) > 5


def test_a_withdrawn_result_leaves_what_others_wrote(tmp_path: Path, write: Write) -> None:
    earlier(tmp_path, camera="theirs", result="{}")
    files = ResultFolder(tmp_path)
    write(files)
    files.withdraw()
    assert not files.is_written and set(contents(tmp_path)) == set(KEPT)
    files.withdraw()
    write(files)
    assert files.is_written and len(contents(tmp_path)) == 4
    (tmp_path / "camera.yaml").write_text("edited")
    files.withdraw()
    assert set(contents(tmp_path)) == {*KEPT, "camera.yaml"}

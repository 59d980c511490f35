"""A session on disk: what is read is what was written, and no half of it is ever believed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.engine.calibration.test_adjustment import GOOD, observe
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.record import SessionState
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.views import CapturedView
from venus3d.storage.places import EVENTS
from venus3d.storage.session_folder import SessionFolder
from venus3d.storage.session_reader import kept_pictures, pictures_of, read_header


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[SessionFolder]:
    opened = SessionFolder.create(tmp_path / "session", {"options": {}}, lambda _: None)
    yield opened
    opened.close()


def run(
    session: Session, camera: Camera, rng: np.random.Generator, vectors: list[list[float]]
) -> None:
    """Capture a view at each pose; the pictures are noise, and each another."""
    for vector in vectors:
        picture = rng.integers(0, 255, (camera.height, camera.width, 3), np.uint8)
        seen = observe(camera, session.board, vector, rng, 0.1)
        session.observe(replace(seen, image=picture, name="frame"))
        assert session.capture()
        session.run_pending()


SETTINGS = Settings(auto_capture=False, method="venus")


@pytest.fixture
def session(default_board: Board, paper_camera: Camera, folder: SessionFolder) -> Session:
    return Session(default_board, paper_camera.image_size, SETTINGS, folder)


def reopened(folder: SessionFolder, said: list[str] | None = None) -> SessionFolder:
    folder.close()
    tell = (lambda _: None) if said is None else said.append
    return SessionFolder.open(folder.directory, tell)


def test_a_session_goes_on_where_it_was(
    session: Session, folder: SessionFolder, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """The same views, history and rule give the same next target."""
    run(session, paper_camera, rng, GOOD[:4])
    session.drop_view(2)
    session.run_pending()
    session.skip_target()
    before = session.run_pending()
    again = reopened(folder)
    state = again.state()
    assert state is not None and [view.number for view in state.views] == [1, 3, 4]
    other = Session(Board(), paper_camera.image_size, SETTINGS, again)
    other.restore(state)
    after = other.run_pending()
    assert before.target is not None and after.target is not None
    np.testing.assert_array_equal(after.target.pose.matrix, before.target.pose.matrix)
    assert after.target.number == before.target.number
    assert before.calibration is not None and after.calibration is not None
    np.testing.assert_array_equal(
        after.calibration.camera.parameters, before.calibration.camera.parameters
    )
    assert [p.views for p in after.history] == [p.views for p in before.history]
    again.close()


def test_pictures_are_kept_as_captured(
    session: Session, folder: SessionFolder, paper_camera: Camera, rng: np.random.Generator
) -> None:
    pictures: list[np.ndarray] = []
    for vector in GOOD[:2]:
        picture = rng.integers(0, 255, (720, 1280, 3), np.uint8)
        pictures.append(picture)
        session.observe(replace(observe(paper_camera, session.board, vector, rng), image=picture))
        session.capture()
        session.count_kept(wait=True)
    state = folder.state()
    assert state is not None
    found = dict(folder.pictures(state))
    for number, picture in enumerate(pictures, start=1):
        np.testing.assert_array_equal(found[number], picture)
        on_disk = cv2.imread(str(folder.directory / "views" / f"{number:03d}.png"))
        np.testing.assert_array_equal(on_disk, picture)


@pytest.mark.parametrize("cut", [1, 40, 500])
def test_a_line_cut_off_is_left_out_and_said(
    session: Session,
    folder: SessionFolder,
    paper_camera: Camera,
    rng: np.random.Generator,
    cut: int,
) -> None:
    """Of the last view's two lines the second is cut: the view is there all the same."""
    run(session, paper_camera, rng, GOOD[:3])
    path = folder.directory / EVENTS
    os.truncate(path, path.stat().st_size - cut)
    said: list[str] = []
    again = reopened(folder, said)
    state = again.state()
    assert state is not None and [view.number for view in state.views] == [1, 2, 3]
    assert "cut off" in said[0]
    assert again.state() is not None and len(said) == 1  # the file is whole now
    again.close()


def test_a_journal_that_is_none_is_refused(
    session: Session, folder: SessionFolder, paper_camera: Camera, rng: np.random.Generator
) -> None:
    run(session, paper_camera, rng, GOOD[:1])
    path = folder.directory / EVENTS
    good = path.read_bytes()
    no_picture = b'{"event":"captured","number":1}\n'
    for content in (b"{}\n", b"[1]\n", b"nonsense\n", no_picture, good.replace(b'"ids"', b'"x"')):
        path.write_bytes(content)
        again = reopened(folder)
        with pytest.raises(StorageError, match="damaged"):
            again.state()
        again.close()
    path.write_bytes(no_picture)
    with pytest.raises(StorageError, match="damaged"):
        list(kept_pictures(folder.directory, [1]))


def test_a_session_is_never_overwritten(folder: SessionFolder) -> None:
    with pytest.raises(StorageError, match="--resume"):
        SessionFolder.create(folder.directory, {}, lambda _: None)
    assert read_header(folder.directory)["options"] == {}


def test_a_session_without_a_view_does_not_take_its_name(tmp_path: Path) -> None:
    for _ in range(2):
        SessionFolder.create(tmp_path / "new", {}, lambda _: None).close()
        assert not (tmp_path / "new").exists()


def test_two_processes_do_not_share_a_session(
    session: Session, folder: SessionFolder, paper_camera: Camera, rng: np.random.Generator
) -> None:
    run(session, paper_camera, rng, GOOD[:1])
    code = (
        "import sys; from pathlib import Path\n"
        "from venus3d.storage.session_folder import SessionFolder\n"
        "SessionFolder.open(Path(sys.argv[1]), print)"
    )
    command = [sys.executable, "-c", code, str(folder.directory)]
    refused = subprocess.run(command, capture_output=True, text=True)
    assert "is open in another venus3d" in refused.stderr
    folder.close()
    assert subprocess.run(command, capture_output=True).returncode == 0


def test_a_slow_disk_is_not_waited_for(
    default_board: Board, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """Frames go on while a view is written; it counts when it is kept, once, and who undoes, ends
    or begins anew meanwhile means it too."""
    disk: list[Future[None]] = []

    class SlowDisk:
        def captured(self, view: CapturedView) -> Future[None]:
            disk.append(Future())
            return disk[-1]

        def changed(self, state: SessionState) -> None:
            pass

    def held(index: int) -> Session:
        session = Session(default_board, paper_camera.image_size, SETTINGS, SlowDisk())
        session.observe(observe(paper_camera, default_board, GOOD[index], rng))
        assert session.capture() and session.capture()
        assert session.observe(session.snapshot().observation).captured == ()
        return session

    session = held(0)
    assert len(disk) == 1 and session.pending is None and session.phase == "startup"
    disk[0].set_result(None)
    assert session.observe(session.snapshot().observation).captured == (1,)
    assert session.pending is not None and len(disk) == 1
    meanwhile: list[tuple[Callable[[Session], object], tuple[int, ...]]] = [
        (Session.undo_view, ()),
        (Session.finish, (1,)),
        (Session.restart, ()),
    ]
    for act, left in meanwhile:
        session = held(1)
        threading.Timer(0.05, disk[-1].set_result, [None]).start()
        act(session)
        assert session.snapshot().captured == left


def test_a_view_that_cannot_be_kept_is_not_captured(
    session: Session, folder: SessionFolder, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """A folder that is gone, as a full disk: the views before stay, and it is said why."""
    run(session, paper_camera, rng, GOOD[:2])
    views = folder.directory / "views"
    views.rename(folder.directory / "elsewhere")
    views.write_text("a file where the folder was")
    session.observe(
        replace(
            observe(paper_camera, session.board, GOOD[2], rng),
            image=np.zeros((720, 1280, 3), np.uint8),
        )
    )
    session.capture()
    session.count_kept(wait=True)
    snapshot = session.snapshot()
    assert len(snapshot.views) == 2 and "not captured" in snapshot.warnings[0]
    views.unlink()
    views.mkdir()
    assert session.capture()
    session.count_kept(wait=True)
    assert not any("not captured" in said for said in session.snapshot().warnings)
    session.run_pending()
    assert len(session.snapshot().views) == 3


@pytest.mark.skipif(os.name == "nt" or os.geteuid() != 0, reason="only root mounts a small disk")
def test_a_full_disk_loses_nothing(
    tmp_path: Path, default_board: Board, paper_camera: Camera, rng: np.random.Generator
) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8m", "tmpfs", str(disk)])
    if mounted.returncode != 0:
        pytest.skip("no disk can be mounted here")
    try:
        folder = SessionFolder.create(disk / "session", {}, lambda _: None)
        session = Session(default_board, paper_camera.image_size, SETTINGS, folder)
        for vector in GOOD:
            picture = rng.integers(0, 255, (720, 1280, 3), np.uint8)  # 2.8 MB as a PNG
            seen = observe(paper_camera, default_board, vector, rng)
            session.observe(replace(seen, image=picture))
            session.capture()
            session.run_pending()
        kept = len(session.snapshot().captured or ())
        assert 2 <= kept < len(GOOD)
        assert "No space left" in session.snapshot().warnings[0] or (
            "no space left" in session.snapshot().warnings[0]
        )
        lines = (folder.directory / EVENTS).read_bytes().splitlines()
        assert [json.loads(line)["event"] for line in lines].count("captured") == kept
        state = folder.state()
        assert state is not None and len(list(folder.pictures(state))) == kept
        folder.close()
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_the_pictures_of_a_results_views_are_those_that_were_captured(
    session: Session, folder: SessionFolder, paper_camera: Camera
) -> None:
    """A session begun anew has each number twice: only the corners tell which picture it is."""
    rng = np.random.default_rng(4)
    run(session, paper_camera, rng, GOOD[:2])
    first = session.state.views
    session.restart()
    run(session, paper_camera, rng, GOOD[2:4])
    again = session.state.views
    found = [pictures_of(folder.directory, views) for views in (first, again)]
    assert [sorted(one) for one in found] == [[1, 2], [1, 2]]
    assert not set(found[0].values()) & set(found[1].values())
    moved = replace(again[0].observation, corners=again[0].observation.corners + 0.5)
    assert not pictures_of(folder.directory, [replace(again[0], observation=moved)])
    assert not pictures_of(folder.directory / "views", first)

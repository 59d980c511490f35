"""Fixtures that every room's tests share."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

# The programs that tests start would compile our modules anew each, at nearly a second.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# A shell starts what shall run in its background deaf to Ctrl-C, and so are all programs that tests
# start from there and end by it.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:  # nohup: heeded here, not by what is started
    signal.signal(signal.SIGHUP, lambda *_: None)

# Before numpy and OpenCV come: workers side by side leave each other a core.
if "PYTEST_XDIST_WORKER" in os.environ:
    for _library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

import cv2
import numpy as np
import pytest
from hypothesis import settings

from tests.scene.guided import guided_session
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.offscreen import Offscreen
from venus3d.sources.opencv_log import silence_opencv

# FFmpeg reads how much it may say when a process opens its first video, which some tests do by
# OpenCV alone.
silence_opencv()

# A busy machine is no failure.
settings.register_profile("venus3d", deadline=None)
settings.load_profile("venus3d")

if "PYTEST_XDIST_WORKER" in os.environ:
    cv2.setNumThreads(1)

_ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real recordings; they are not part of the project, so a test may go without."""
    folder = Path(os.environ.get("VENUS3D_DATA", _ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no real recordings at {folder}; set VENUS3D_DATA to their folder")
    return folder


@pytest.fixture(scope="session")
def paper_camera() -> Camera:
    """The paper's simulated camera (4.1.2), its distortion read in OpenCV's order."""
    return Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)


@pytest.fixture(scope="session")
def default_board() -> Board:
    """The paper's board: 9 x 6 squares of 28 mm."""
    return Board()


@pytest.fixture(scope="session")
def two_views(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The result of a simulated session, 640x360, from which others go on: a live one takes long
    for its first views."""
    from venus3d.cli import main

    folder = tmp_path_factory.mktemp("two-views")
    headless = ("guide", "sim", "--headless", "--camera-size", "640x360")
    assert main([*headless, "--max-views", "2", "--no-record", "--output", str(folder)]) == 0
    return folder / "result.json"


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers that are the same in every run."""
    return np.random.default_rng(20200720)


@pytest.fixture(scope="session")
def gl() -> Iterator[Offscreen]:
    """The OpenGL renderer; tests that need it are skipped where OpenGL cannot be had."""
    offscreen = Offscreen()
    if offscreen.backend != "gl":
        offscreen.close()
        pytest.skip(offscreen.note)
    yield offscreen
    offscreen.close()


@pytest.fixture(scope="session")
def painter() -> Iterator[Offscreen]:
    """The OpenCV painter."""
    with Offscreen("painter") as offscreen:
        yield offscreen


@pytest.fixture(params=["gl", "painter"])
def renderer(request: pytest.FixtureRequest) -> Offscreen:
    """Either of the two."""
    offscreen: Offscreen = request.getfixturevalue(request.param)
    return offscreen


@pytest.fixture(scope="session")
def guided(paper_camera: Camera, default_board: Board) -> Snapshot:
    """A session after five views; tests only read it."""
    return guided_session(paper_camera, default_board, Settings())

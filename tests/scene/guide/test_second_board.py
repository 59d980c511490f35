"""A second board in view is told on the guide's page while the right one is guided, and goes again;
the look for it holds nothing up."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.calibration.board_finding import FoundBoard
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources import second_board_watch
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.observation_stream import ObservationStream

CAMERA = Camera(1280, 720, 1000, 1000, 640, 360)
POSE = Pose.from_vector([15, -20, 8, 0, 0, 0.42])
FIRST, SECOND = Board(6, 5), Board(6, 5, first_id=15)


class Desk:
    """A camera over a desk on which two boards lie, or one."""

    image_size, is_live, notes = (1280, 720), True, ()

    def __init__(self) -> None:
        one, other = (picture_of(b, CAMERA, POSE)[:, 320:960] for b in (FIRST, SECOND))
        self.both: NDArray[np.uint8] = np.hstack([one, other])
        self.alone: NDArray[np.uint8] = np.hstack([one, np.full_like(one, 120)])
        self.image = self.both

    def read(self) -> Frame | None:
        time.sleep(0.05)
        return Frame(self.image, time.monotonic(), "")

    def close(self) -> None:
        pass


@pytest.fixture
def viewer() -> Iterator[Viewer]:
    page = Viewer(port=free_port())
    yield page
    page.close()


def test_the_page_tells_of_the_second_board_until_it_is_gone(
    viewer: Viewer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(second_board_watch, "EVERY_S", 0.1)
    monkeypatch.setattr(second_board_watch, "SHARE", 1.0)
    desk = Desk()
    session = Session(FIRST, desk.image_size)
    tracker = BoardTracker(Detector(FIRST, find_layout=False), look_beside=True)
    live = LiveGuide(session, desk, tracker, viewer, lambda _: None, lambda: desk)
    running = threading.Thread(target=live.run, daemon=True)
    running.start()
    try:
        wait_until(lambda: "ids from 15" in viewer.view.diagnoses.content)
        assert "Beside the board asked for" in viewer.view.diagnoses.content
        desk.image = desk.alone
        wait_until(lambda: "ids from 15" not in viewer.view.diagnoses.content)
    finally:
        live.stop()
        running.join(20)
        tracker.close()


def test_nothing_waits_for_the_look_beside_the_board() -> None:
    looked, may_end = threading.Event(), threading.Event()

    class Slow(Detector):
        def look_beside(self, image: Any, seen: Observation) -> FoundBoard | None:
            looked.set()
            may_end.wait(30)
            return super().look_beside(image, seen)

    shown: list[Frame] = []
    tracker = BoardTracker(Slow(FIRST, find_layout=False), look_beside=True)
    stream = ObservationStream(Desk(), tracker, on_picture=shown.append)
    seen: list[Observation] = []

    def step() -> None:
        observation = stream.take(timeout=0.05)
        if observation is not None and looked.is_set():
            seen.append(observation)
        if len(seen) >= 5:
            may_end.set()
            stream.stop()

    with closing(tracker):
        stream.run(step)
    stream.check()
    assert len(seen) == 5 and all(one.count for one in seen) and len(shown) >= 5


def test_what_a_look_beside_raises_is_told_with_the_next_frame() -> None:
    class Broken(Detector):
        def look_beside(self, image: Any, seen: Observation) -> FoundBoard | None:
            raise RuntimeError("boom")

    frame = Desk().read()
    assert frame is not None

    def told() -> bool:
        try:
            tracker.track(frame)
        except RuntimeError as error:
            return error.args == ("boom",)
        return False

    with closing(BoardTracker(Broken(FIRST, find_layout=False), look_beside=True)) as tracker:
        wait_until(told)

"""What both pages and the terminal say of a network camera that is gone, comes back, and changes
its size; and that the session goes on."""

from __future__ import annotations

import threading
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.ports import free_port
from tests.sources.network_camera import network_camera
from tests.sources.test_recordings import write_video
from tests.waiting import wait_until
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import Board
from venus3d.engine.guidance.session import Session
from venus3d.scene.pages.audience.sound import ALARM_S, Alarm
from venus3d.scene.pages.guide import texts
from venus3d.scene.pages.guide.intents import PageAction
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Source
from venus3d.sources.live import Live
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.source_news import tell_of_trouble


class Grey:
    size = (64, 48)

    def __call__(self, number: int) -> NDArray[np.uint8]:
        return np.full((self.size[1], self.size[0], 3), 120, np.uint8)


def test_a_camera_that_is_gone_or_changes_its_size_does_not_end_the_session():
    grey, printed = Grey(), list[str]()
    with network_camera(grey) as camera:
        source = open_frame_source(camera.address)
        assert isinstance(source, Live)
        tell_of_trouble(source, printed.append)
        viewer = Viewer(port=free_port())
        session = Session(Board(), source.image_size)
        tracker = BoardTracker(Detector(Board(), find_layout=False))
        live = LiveGuide(session, source, tracker, viewer, lambda _: None, lambda: source)
        running = threading.Thread(target=live.run, daemon=True)
        running.start()
        try:
            wait_until(lambda: session.snapshot().number > 2)
            camera.unplug()
            wait_until(lambda: "opened again" in viewer.state.no_pictures)
            wait_until(lambda: escape(viewer.state.no_pictures) in viewer.view.guidance.content)
            assert texts.NO_PICTURES in viewer.view.guidance.content
            camera.plug_in()
            wait_until(lambda: not viewer.state.no_pictures)
            grey.size = (96, 48)
            wait_until(lambda: viewer.state.other_size)
            wait_until(lambda: texts.OTHER_SIZE in viewer.view.guidance.content)
            assert "96 x 48 px, not 64 x 48" in viewer.state.no_pictures
            assert session.image_size == (64, 48)
            viewer._ask(PageAction.NEW_SESSION)
            wait_until(lambda: not viewer.state.other_size)
            wait_until(lambda: session.snapshot().observation.image_size == (96, 48))
            assert session.snapshot().run == 2
        finally:
            live.stop()
            running.join(20)
            viewer.close()
    assert not running.is_alive()
    said = "\n".join(printed)
    for part in ("no pictures since", "try 1: ", "pictures again, after", "96 x 48"):
        assert part in said, printed


def test_a_recording_that_ends_begins_again_until_its_file_is_gone(tmp_path: Path):
    """The views stay; what ends the session is told on the page."""
    video = write_video(tmp_path / "short.avi", "MJPG", frames=8, rate=40.0)
    source = open_frame_source(str(video), realtime=True)
    viewer = Viewer(port=free_port())
    session = Session(Board(), source.image_size)
    tracker = BoardTracker(Detector(Board(), find_layout=False))
    opened = list[Source]()

    def again() -> Source:
        opened.append(open_frame_source(str(video), realtime=True))
        return opened[-1]

    failed = list[BaseException]()

    def run() -> None:
        try:
            live.run()
        except SourceError as error:
            failed.append(error)

    live = LiveGuide(session, source, tracker, viewer, lambda _: None, again)
    running = threading.Thread(target=run, daemon=True)
    running.start()
    try:
        wait_until(lambda: len(opened) >= 3)
        seen = session.snapshot().number
        wait_until(lambda: session.snapshot().number > seen)
        assert running.is_alive() and not viewer.state.no_pictures
        video.unlink()
        wait_until(lambda: failed)
        assert "short.avi" in str(failed[0]) and viewer.state.no_pictures
    finally:
        live.stop()
        running.join(20)
        viewer.close()


def test_the_alarm_sounds_after_half_a_minute_and_again():
    alarm = Alarm()
    due = [second for second in range(100) if alarm.due(5 <= second < 80, float(second))]
    assert due == [5 + ALARM_S, 5 + 2 * ALARM_S]

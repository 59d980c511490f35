"""A network camera on loopback, read by FFmpeg: it stalls, is restarted, changes its size, sends
damaged pictures."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.sources.network_camera import NetworkCamera, network_camera
from tests.waiting import wait_until
from venus3d.sources import stream
from venus3d.sources.frame import Frame
from venus3d.sources.live import Live, OtherSize
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.reconnection import Outage


class Painter:
    """Pictures of a gradient, whose size can be changed."""

    size = (64, 48)

    def __call__(self, number: int) -> NDArray[np.uint8]:
        ramp = np.linspace(60, 180, self.size[0]).astype(np.uint8)
        return np.ascontiguousarray(np.broadcast_to(ramp[None, :, None], (*self.size[::-1], 3)))


class Reading:
    """Reads a source on a thread, as the guide does."""

    def __init__(self, source: Live) -> None:
        self.source, self.frames, self.news = source, list[Frame](), list[object]()
        source.on_trouble = self.news.append
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self) -> None:
        while (frame := self.source.read()) is not None:
            self.frames.append(frame)


@contextmanager
def reading(camera: NetworkCamera) -> Iterator[Reading]:
    source = open_frame_source(camera.address)
    assert isinstance(source, Live)
    one = Reading(source)
    try:
        yield one
    finally:
        source.close()
        one.thread.join(10)
        assert not one.thread.is_alive()


def test_a_restarted_camera_comes_back():
    with network_camera(Painter()) as camera, reading(camera) as one:
        wait_until(lambda: len(one.frames) > 2)
        assert one.source.image_size == (64, 48) and abs(one.frames[0].image.mean() - 120) < 2
        camera.unplug()
        wait_until(lambda: isinstance(one.source.trouble, Outage))
        wait_until(lambda: isinstance(t := one.source.trouble, Outage) and t.tries > 0)
        before = len(one.frames)
        camera.plug_in()
        wait_until(lambda: len(one.frames) > before)
        assert one.source.trouble is None and one.frames[-1].time_s > one.frames[0].time_s
        assert one.news[-1] is None and camera.connections == 2


def test_a_stall_of_three_seconds_needs_no_new_connection():
    with network_camera(Painter()) as camera, reading(camera) as one:
        wait_until(lambda: one.frames)
        camera.stalled = True
        time.sleep(3)
        before = len(one.frames)
        camera.stalled = False
        wait_until(lambda: len(one.frames) > before + 2)
        assert camera.connections == 1 and not one.news


def test_a_camera_that_stalls_for_longer_is_opened_again(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stream, "READ_TIMEOUT_S", 0.4)
    with network_camera(Painter()) as camera, reading(camera) as one:
        wait_until(lambda: one.frames)
        camera.stalled = True
        wait_until(lambda: isinstance(t := one.source.trouble, Outage) and t.tries > 0)
        camera.stalled = False
        wait_until(lambda: one.source.trouble is None)
        assert camera.connections >= 2
        assert isinstance(one.news[0], Outage) and "nothing came for" in one.news[0].reason


def test_another_size_in_mid_stream_is_seen_and_not_stretched():
    """OpenCV scaled such pictures to the first one's size, and they joined the set."""
    painter = Painter()
    with network_camera(painter) as camera, reading(camera) as one:
        wait_until(lambda: one.frames)
        painter.size = (96, 48)
        wait_until(lambda: one.source.trouble == OtherSize((64, 48), (96, 48)))
        assert {frame.image_size for frame in one.frames} == {(64, 48)}
        assert one.source.accept_size() == (96, 48)
        wait_until(lambda: one.frames[-1].image_size == (96, 48))
        assert camera.connections == 1


def test_damaged_pictures_are_left_out_and_counted():
    with network_camera(Painter()) as camera, reading(camera) as one:
        wait_until(lambda: one.frames)
        camera.damaged = True
        wait_until(lambda: one.source.damaged > 3)
        camera.damaged = False
        before = len(one.frames)
        wait_until(lambda: len(one.frames) > before + 3)
        # Half a picture would be grey below.
        assert all(frame.image[-1].std() > 20 for frame in one.frames)

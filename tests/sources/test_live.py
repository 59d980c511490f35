"""Cameras and streams: the newest frame wins, a broken one says so."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.waiting import wait_until
from venus3d.engine.errors import SourceError
from venus3d.sources import stream
from venus3d.sources.frame import Frame
from venus3d.sources.live import Live, OtherSize
from venus3d.sources.open_frame_source import open_frame_source


class ScriptedCapture:
    """A camera whose pictures come when the test lets them."""

    def __init__(self) -> None:
        self.size = (64, 48)
        self.broken = False
        self.released = False
        self.given = 0
        self.allowed = threading.Semaphore(0)

    def read(self) -> tuple[bool, NDArray[np.uint8]]:
        while not self.allowed.acquire(timeout=0.01):
            if self.broken:
                return False, np.zeros(0, np.uint8)
            if self.released:
                break
        self.given += 1
        return True, np.full((self.size[1], self.size[0], 3), self.given, np.uint8)

    def release(self) -> None:
        self.released = True


@pytest.fixture
def capture() -> ScriptedCapture:
    return ScriptedCapture()


def wait_until_read(source: Live, capture: ScriptedCapture, number: int) -> None:
    """Wait until the reading thread has put frame `number` into its box."""
    for _ in range(3000):
        newest = source._box.peek()
        if newest is not None and newest.image[0, 0, 0] == number:
            return
        threading.Event().wait(0.01)
    raise AssertionError(f"frame {number} of {capture.given} never came")


def test_the_newest_frame_wins(capture: ScriptedCapture):
    capture.allowed.release()
    source = Live(lambda: capture, "Camera 0", timeout_s=30)
    assert source.is_live and source.image_size == (64, 48)
    first = source.read()
    assert first is not None and first.image[0, 0, 0] == 1, "the first frame is not lost"
    for _ in range(9):
        capture.allowed.release()
    wait_until_read(source, capture, 10)
    frame = source.read()
    assert frame is not None and frame.image[0, 0, 0] == 10 and frame.time_s >= first.time_s
    capture.broken = True
    source.close()
    source.close()
    assert source.read() is None and capture.released


def test_a_camera_that_is_pulled_out_is_opened_again(capture: ScriptedCapture):
    """Ended for good, it took the session with it."""
    pulled, again = capture, ScriptedCapture()
    captures = iter([pulled, again])
    pulled.allowed.release()
    source = Live(lambda: next(captures), "Camera 0", timeout_s=30)
    news: list[object] = []
    source.on_trouble = news.append
    assert source.read() is not None and source.trouble is None
    again.allowed.release()
    pulled.broken = True
    frame = source.read()
    assert frame is not None and frame.image[0, 0, 0] == 1 and again.given == 1
    assert pulled.released, "two captures would keep the device busy"
    assert [getattr(trouble, "tries", None) for trouble in news] == [0, 1, None]
    again.broken = True
    source.close()


def test_a_read_that_never_returns_does_not_hold_up_the_end(capture: ScriptedCapture):
    capture.allowed.release()
    source = Live(lambda: capture, "Camera 0", timeout_s=30)
    assert source.read() is not None
    waiting = threading.Thread(target=source.read, daemon=True)
    waiting.start()
    began = time.monotonic()
    source.close()
    waiting.join(5)
    assert not waiting.is_alive() and time.monotonic() - began < 4
    capture.broken = True


def test_a_camera_that_never_sends(capture: ScriptedCapture):
    capture.broken = True
    with pytest.raises(SourceError, match="Camera 0 opens but sends no picture"):
        Live(lambda: capture, "Camera 0", timeout_s=30)
    assert capture.released


def test_a_picture_that_changes_its_size(capture: ScriptedCapture):
    """Refused until it is set back, or until a new session takes the new size."""
    for _ in range(2):
        capture.allowed.release()
    source = Live(lambda: capture, "Camera 0", timeout_s=30)
    frames: list[Frame] = []

    def read() -> None:
        while (frame := source.read()) is not None:
            frames.append(frame)

    reading = threading.Thread(target=read, daemon=True)
    reading.start()
    wait_until(lambda: frames)
    capture.size = (32, 24)
    capture.allowed.release()
    wait_until(lambda: source.trouble is not None)
    assert source.trouble == OtherSize((64, 48), (32, 24)) and source.image_size == (64, 48)
    capture.size = (64, 48)
    capture.allowed.release()
    wait_until(lambda: source.trouble is None)
    capture.size = (32, 24)
    capture.allowed.release()
    wait_until(lambda: source.trouble is not None)
    assert {frame.image_size for frame in frames} == {(64, 48)}
    assert source.accept_size() == (32, 24)
    capture.allowed.release()
    wait_until(lambda: source.trouble is None and frames[-1].image_size == (32, 24))
    capture.broken = True
    source.close()
    reading.join(5)
    assert not reading.is_alive()


def test_cameras_that_are_not_there(capfd: pytest.CaptureFixture[str]):
    for spec in ("97", "/dev/video97"):
        with pytest.raises(SourceError) as caught:
            open_frame_source(spec)
        assert f"amera {spec}" in str(caught.value) and "choose another" in str(caught.value)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("address", ["rtsp://127.0.0.1:1/x", "http://127.0.0.1:1/x", "foo://x"])
def test_streams_that_do_not_answer(
    address: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(stream, "OPEN_TIMEOUT_S", 1.0)
    with pytest.raises(SourceError) as caught:
        open_frame_source(address)
    assert str(caught.value) == (
        f"No stream can be opened at {address}; check the address, and that the sender runs and "
        "can be reached from this machine."
    )
    assert capfd.readouterr().err == ""


def test_a_file_without_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "m.mp4"
    path.write_bytes(b"x")
    monkeypatch.setattr("os.access", lambda *_: False)  # root may read everything
    with pytest.raises(SourceError, match="may not be read by you; check its permissions"):
        open_frame_source(str(path))

"""Cameras and streams: the newest frame wins, a broken one says so."""

from __future__ import annotations

import http.server
import threading
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.sources import live
from venus3d.sources.live import Live
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
    source = Live(capture, "Camera 0", timeout_s=30)
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


def test_a_camera_that_breaks_says_so(capture: ScriptedCapture):
    capture.allowed.release()
    source = Live(capture, "Camera 0", timeout_s=30)
    assert source.read() is not None
    capture.broken = True
    with pytest.raises(SourceError) as caught:
        source.read()
    assert str(caught.value) == (
        "Camera 0 sends no more pictures; check its cable or its sender, then start again."
    )
    source.close()
    assert capture.released


def test_a_camera_that_never_sends(capture: ScriptedCapture):
    capture.broken = True
    with pytest.raises(SourceError, match="Camera 0 opens but sends no picture"):
        Live(capture, "Camera 0", timeout_s=30)
    assert capture.released


def test_a_picture_that_changes_its_size(capture: ScriptedCapture):
    capture.allowed.release()
    source = Live(capture, "Camera 0", timeout_s=30)
    assert source.read() is not None
    capture.size = (32, 24)
    capture.allowed.release()
    with pytest.raises(SourceError, match="from 64 x 48 to 32 x 24 px"):
        source.read()
    capture.broken = True
    source.close()


def test_cameras_that_are_not_there(capfd: pytest.CaptureFixture[str]):
    for spec in ("97", "/dev/video97"):
        with pytest.raises(SourceError) as caught:
            open_frame_source(spec)
        assert f"amera {spec}" in str(caught.value) and "choose another" in str(caught.value)
    assert capfd.readouterr().err == ""


class MjpegServer(http.server.BaseHTTPRequestHandler):
    """Sends frames as network cameras do, over and over; or one picture after another of a file."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 120, np.uint8))[1].tobytes()
        head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n"
        try:
            while not self.server.quitting.wait(0.01):  # type: ignore[attr-defined]
                self.wfile.write(head.encode() + jpeg + b"\r\n")
        except OSError:
            pass  # the reader hung up

    def log_message(self, format: str, *args: object) -> None:
        pass


@pytest.fixture
def server() -> Iterator[http.server.ThreadingHTTPServer]:
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), MjpegServer)
    server.quitting = threading.Event()  # type: ignore[attr-defined]
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield server
    server.quitting.set()  # type: ignore[attr-defined]
    server.shutdown()
    server.server_close()
    thread.join(timeout=10)


def test_a_network_camera_from_opening_to_breaking(server: http.server.ThreadingHTTPServer):
    source = open_frame_source(f"http://127.0.0.1:{server.server_port}/stream.mjpg")
    assert isinstance(source, Live) and source.image_size == (64, 48)
    frames = [source.read() for _ in range(3)]
    assert all(f is not None and abs(f.image.mean() - 120) < 2 for f in frames)
    server.quitting.set()  # type: ignore[attr-defined]
    with pytest.raises(SourceError, match="sends no more pictures"):
        while source.read() is not None:
            pass
    source.close()


@pytest.mark.parametrize("address", ["rtsp://127.0.0.1:1/x", "http://127.0.0.1:1/x", "foo://x"])
def test_streams_that_do_not_answer(
    address: str, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(live, "OPEN_TIMEOUT_S", 1.0)
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

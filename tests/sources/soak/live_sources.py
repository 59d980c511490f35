"""Live sources that fail, on real servers on loopback, for minutes: `make soak-live`.

The real video as MJPEG over HTTP and, where GStreamer's RTSP server is installed (setup.sh's
system-soak), as H.264 over RTSP: stalls of 3, 10 and 30 s, restarts, damaged pictures and lost
packets, 1 and 120 pictures a second. Prints a row for each and ends with 1 if one did not come
back.
"""

from __future__ import annotations

import itertools
import os
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.sources.network_camera import NetworkCamera, network_camera
from tests.sources.soak.rtsp_camera import RtspCamera, has_rtsp, rtsp_camera
from venus3d.engine.errors import SourceError
from venus3d.sources.live import Live
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.reconnection import Outage

_VIDEO = Path(os.environ.get("VENUS3D_DATA", "../shared/data")) / "wpilib-charuco-12x8.mp4"
_PATIENCE_S = 40.0
_WRONG = 12.0
"""Grey values by which a part of a picture differs from all that were sent."""


class Watcher:
    """Reads a source and keeps what has happened."""

    def __init__(self, address: str) -> None:
        end_s = time.monotonic() + 20
        while True:
            try:
                source = open_frame_source(address)
                break
            except SourceError:  # the server is not up yet
                if time.monotonic() > end_s:
                    raise
                time.sleep(0.5)
        assert isinstance(source, Live), f"{address} has an end"
        self.source = source
        self.frames, self.tries = 0, 0
        self.look: Callable[[NDArray[np.uint8]], None] = lambda picture: None
        source.on_trouble = self._note
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _note(self, trouble: object) -> None:
        self.tries += isinstance(trouble, Outage) and trouble.tries > 0

    def _read(self) -> None:
        while (frame := self.source.read()) is not None:
            self.frames += 1
            self.look(frame.image)

    def run(self, name: str, spoil: Callable[[], None], mend: Callable[[], None], s: float) -> bool:
        """Spoil for so many seconds, mend, and wait for pictures; prints the row."""
        time.sleep(1.0)
        tries = self.tries
        spoil()
        time.sleep(s)
        mend()
        mended_s, before = time.monotonic(), self.frames
        while self.frames < before + 3 or self.source.trouble is not None:
            if time.monotonic() - mended_s > _PATIENCE_S:
                print(f"{name:<28} did not come back within {_PATIENCE_S:g} s", flush=True)
                return False
            time.sleep(0.01)
        back_s = time.monotonic() - mended_s
        print(
            f"{name:<28} back after {back_s:5.2f} s, tries {self.tries - tries}, damaged "
            f"{self.source.damaged}",
            flush=True,
        )
        return True

    def close(self) -> None:
        self.source.close()
        self._thread.join(10)
        assert not self._thread.is_alive()


def _pictures() -> list[NDArray[np.uint8]]:
    capture, pictures = cv2.VideoCapture(str(_VIDEO)), list[NDArray[np.uint8]]()
    while len(pictures) < 40:
        good, picture = capture.read()
        if not good:
            break
        pictures.append(np.asarray(cv2.resize(picture, (1280, 720)), dtype=np.uint8))
    return pictures or [np.full((720, 1280, 3), 128, np.uint8)]


def mjpeg() -> bool:
    pictures = _pictures()

    def picture(number: int) -> NDArray[np.uint8]:
        return pictures[number % len(pictures)]

    with network_camera(picture, rate=25) as camera:
        watcher = Watcher(camera.address)
        good = [
            *(
                watcher.run(
                    f"MJPEG, stall of {s} s",
                    lambda: setattr(camera, "stalled", True),
                    lambda: setattr(camera, "stalled", False),
                    s,
                )
                for s in (3, 10, 30)
            ),
            watcher.run("MJPEG, gone for 5 s", camera.unplug, camera.plug_in, 5),
            watcher.run(
                "MJPEG, damaged for 3 s",
                lambda: setattr(camera, "damaged", True),
                lambda: setattr(camera, "damaged", False),
                3,
            ),
            _often(watcher, camera),
            _at_rate(watcher, camera, 1),
            _at_rate(watcher, camera, 120, pictures),
        ]
        watcher.close()
    return all(good)


def _often(watcher: Watcher, camera: NetworkCamera) -> bool:
    """50 restarts in a minute."""
    began_s, threads = time.monotonic(), threading.active_count()
    good = True
    for _ in range(50):
        camera.unplug()
        time.sleep(0.3)
        camera.plug_in()
        before, end_s = watcher.frames, time.monotonic() + _PATIENCE_S
        while watcher.frames == before and time.monotonic() < end_s:
            time.sleep(0.01)
        good = good and watcher.frames > before
    left = threading.active_count() - threads
    print(
        f"MJPEG, 50 restarts in {time.monotonic() - began_s:.0f} s: threads {left:+d}", flush=True
    )
    return good and left < 5


def _at_rate(
    watcher: Watcher,
    camera: NetworkCamera,
    rate: float,
    pictures: list[NDArray[np.uint8]] | None = None,
) -> bool:
    """Ten seconds at another rate; small pictures where the sender could not keep up."""
    if pictures is not None:
        pictures[:] = [np.ascontiguousarray(picture[::4, ::4]) for picture in pictures]
        camera.rate = rate
        time.sleep(1.0)
        watcher.source.accept_size()
    camera.rate = rate
    time.sleep(1.0)
    sent, read, tries = camera.sent, watcher.frames, watcher.tries
    time.sleep(10)
    sent, read = camera.sent - sent, watcher.frames - read
    print(f"MJPEG, {rate:g} pictures/s: {sent / 10:.1f} sent, {read / 10:.1f} read", flush=True)
    return watcher.tries == tries and read > 0.7 * min(sent, 60 * 10)


def rtsp() -> bool:
    if not has_rtsp():
        print("RTSP: not run, python3-gi with gir1.2-gst-rtsp-server-1.0 is missing")
        return True
    sent = _pictures()
    pictures = itertools.cycle(sent)
    with rtsp_camera(lambda: next(pictures), (1280, 720), 25) as camera:
        watcher = Watcher(camera.address)
        good = [
            *(
                watcher.run(f"RTSP, stall of {s} s", camera.stall, camera.go_on, s)
                for s in (3, 10, 30)
            ),
            *(watcher.run(f"RTSP, killed, {n}", camera.kill, camera.start, 3) for n in (1, 2, 3)),
            _rtsp_damaged(watcher, camera, sent),
        ]
        watcher.close()
    return all([*good, _rtsp_at_rate(sent, (640, 360), 1), _rtsp_at_rate(sent, (320, 180), 120)])


def _rtsp_damaged(watcher: Watcher, camera: RtspCamera, sent: list[NDArray[np.uint8]]) -> bool:
    """Ten seconds of lost packets. FFmpeg paints over what is missing, and PyAV does not tell: so
    wrong pictures are taken meanwhile, but none from the next key picture on."""
    small = np.array([_small(picture) for picture in sent])
    off: list[float] = []
    watcher.look = lambda picture: off.append(
        float(np.abs(small - _small(picture)).max(axis=(1, 2)).min())
    )
    good = watcher.run("RTSP, packets lost for 10 s", camera.damage, camera.damage, 10)
    wrong, taken = sum(value > _WRONG for value in off), len(off)
    time.sleep(1.5)  # a key picture comes every second
    off.clear()
    time.sleep(3.0)
    worst = max(off)
    print(f"  {wrong} of {taken} pictures wrong; afterwards off by {worst:.0f} grey values at most")
    return good and worst <= _WRONG


def _small(picture: NDArray[np.uint8]) -> NDArray[np.float64]:
    grey = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY)
    return np.asarray(cv2.resize(grey, (64, 36), interpolation=cv2.INTER_AREA), np.float64)


def _rtsp_at_rate(sent: list[NDArray[np.uint8]], size: tuple[int, int], rate: int) -> bool:
    """Ten seconds at another rate."""
    pictures = itertools.cycle([np.asarray(cv2.resize(one, size), np.uint8) for one in sent])
    with rtsp_camera(lambda: next(pictures), size, rate) as camera:
        watcher = Watcher(camera.address)
        time.sleep(3.0)
        before = camera.sent, watcher.frames, watcher.source.received, watcher.tries
        time.sleep(10.0)
        now = camera.sent, watcher.frames, watcher.source.received, watcher.tries
        given, read, came, tries = (after - one for one, after in zip(before, now, strict=True))
        watcher.close()
    print(
        f"RTSP, {rate} pictures/s: {given / 10:.1f} sent, {came / 10:.1f} came, "
        f"{read / 10:.1f} read, tries {tries}",
        flush=True,
    )
    return tries == 0 and came > 0.7 * given


if __name__ == "__main__":
    chosen = {"mjpeg": mjpeg, "rtsp": rtsp}
    sys.exit(0 if all([chosen[name]() for name in sys.argv[1:] or chosen]) else 1)

"""Cameras and streams: a thread reads continuously, `read()` gives the newest frame."""

from __future__ import annotations

import glob
import os
import sys
import threading
import time
from typing import Any, Protocol

import cv2

from venus3d.engine.errors import SourceError
from venus3d.sources.frame import Frame
from venus3d.sources.opencv_log import silence_opencv
from venus3d.threads.latest import Latest

OPEN_TIMEOUT_S = 8.0
READ_TIMEOUT_S = 5.0
_FAILURES_ALLOWED = 30  # consecutive reads: a starting camera drops a few frames


class CaptureDevice(Protocol):
    """The part of `cv2.VideoCapture` used here."""

    def read(self) -> tuple[bool, Any]:
        """Whether there was a frame, and the frame."""
        ...

    def release(self) -> None:
        """Release the device."""
        ...


class Live:
    """A live source. `Frame.time_s` counts from the opening."""

    is_live = True
    flip = False
    """Whether left and right are exchanged: for mirrored pictures."""

    def __init__(
        self, capture: CaptureDevice, name: str, *, timeout_s: float = READ_TIMEOUT_S
    ) -> None:
        """Start reading an opened `capture`, called `name` in messages.
        Raises `SourceError` if no frame comes within `timeout_s`."""
        self._capture, self._name, self._timeout_s = capture, name, timeout_s
        self._box: Latest[Frame] = Latest()
        self._stop = threading.Event()
        self.notes: tuple[str, ...] = ()
        self._thread = threading.Thread(target=self._watch, name=f"read {name}", daemon=True)
        self._thread.start()
        first = self._box.take(timeout_s)
        if first is None:
            self.close()
            raise SourceError(
                f"{name} opens but sends no picture; check that nothing covers or uses it, "
                "then start again."
            )
        self._size = first.image_size
        self._first: Frame | None = first

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        return self._size

    def read(self) -> Frame | None:
        """The newest unread frame; waits for one. None after `close()`.
        Raises `SourceError` if none comes within the timeout, or if the frame size changes."""
        if self._stop.is_set():
            return None
        frame = self._box.take(0 if self._first is not None else self._timeout_s) or self._first
        self._first = None
        if frame is None:
            if self._stop.is_set():
                return None
            raise SourceError(
                f"{self._name} sends no more pictures; check its cable or its sender, then start "
                "again."
            )
        if frame.image_size != self._size:
            raise SourceError(
                f"{self._name} changed its picture size from {self._size[0]} x {self._size[1]} to "
                f"{frame.image_size[0]} x {frame.image_size[1]} px; start again with one size."
            )
        return frame.flipped(self.flip)

    def close(self) -> None:
        """Stop reading and release the device. May be called twice."""
        self._stop.set()
        self._box.close()
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout=2.0)

    def _watch(self) -> None:
        # Only this thread uses and releases the device: OpenCV's captures are not thread-safe.
        start, number, failures = time.monotonic(), 0, 0
        try:
            while not self._stop.is_set() and failures < _FAILURES_ALLOWED:
                good, image = self._capture.read()
                if not good:
                    failures += 1
                    self._stop.wait(0.05)
                    continue
                failures, number = 0, number + 1
                self._box.put(Frame(image, time.monotonic() - start, f"frame {number}"))
        finally:
            self._box.close()
            self._capture.release()


def open_camera(device: str, size: tuple[int, int] | None = None) -> Live:
    """The camera with a number ("0") or device ("/dev/video0").

    `size` (width, height) is requested; without it the camera chooses. Raises `SourceError` if the
    camera does not exist, is not accessible, or does not offer this size.
    """
    silence_opencv()
    name = f"Camera {device}"
    _check_device(device)
    capture = cv2.VideoCapture(int(device) if device.isdecimal() else device)
    if not capture.isOpened():
        raise SourceError(
            f"{name} cannot be opened; close the program that uses it, or choose another "
            f"({_present()})."
        )
    if size is not None:
        # USB 2 reaches the full rate at this size with compressed images only; a camera without
        # compression is unaffected.
        capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    live = Live(capture, name)
    if size is not None and live.image_size != size:
        live.close()
        raise SourceError(
            f"{name} gives {live.image_size[0]} x {live.image_size[1]} px, not {size[0]} x "
            f"{size[1]}; ask for a size that it has, or for none."
        )
    return live


def stream_capture(address: str) -> cv2.VideoCapture:
    """An opened capture of a stream's address. Raises `SourceError` if nothing answers in time."""
    silence_opencv()
    timeouts = [
        cv2.CAP_PROP_OPEN_TIMEOUT_MSEC,
        int(OPEN_TIMEOUT_S * 1000),
        cv2.CAP_PROP_READ_TIMEOUT_MSEC,
        int(READ_TIMEOUT_S * 1000),
    ]
    capture = cv2.VideoCapture(address, cv2.CAP_FFMPEG, timeouts)
    if not capture.isOpened():
        raise SourceError(
            f"No stream can be opened at {address}; check the address, and that the sender runs "
            "and can be reached from this machine."
        )
    return capture


def _present() -> str:
    found = ", ".join(sorted(glob.glob("/dev/video*")))
    return f"there is {found}" if found else "this machine shows none"


def _check_device(device: str) -> None:
    """Raise for a camera that does not exist; only Linux shows cameras as files."""
    if not sys.platform.startswith("linux"):
        return
    path = f"/dev/video{device}" if device.isdecimal() else device
    if not os.path.exists(path):
        raise SourceError(
            f"There is no camera {device}; plug it in, or choose another ({_present()})."
        )
    if not os.access(path, os.R_OK | os.W_OK):
        raise SourceError(
            f"Camera {device} may not be used by you; join the group that owns {path} "
            "(mostly: video) and log in again."
        )

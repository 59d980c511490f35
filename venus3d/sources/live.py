"""Live sources: a thread reads continuously, `read()` gives the newest frame. A source that is gone
is opened again, for ever (`reconnection.py`)."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.engine.sentences import said_by
from venus3d.sources.camera_controls import CameraControls
from venus3d.sources.frame import Frame, RealSource
from venus3d.sources.reconnection import Outage, Reconnection
from venus3d.sources.stream import OPEN_TIMEOUT_S, READ_TIMEOUT_S, StreamCapture
from venus3d.threads.latest import Latest

_FAILURES_ALLOWED = 30  # consecutive reads: a starting camera drops a few frames
_LOOK_S = 0.1
_MOST_READERS = 3
"""Connections that may hang in a read that does not return; no further one is made meanwhile."""


class CaptureDevice(Protocol):
    """An opened camera or stream: the part of `cv2.VideoCapture` used here."""

    def read(self) -> tuple[bool, Any]:
        """Whether there was a frame, and the frame. May raise `SourceError` at the end."""
        ...

    def release(self) -> None:
        """Release the device."""
        ...


@dataclass(frozen=True)
class OtherSize:
    """A live source whose pictures have another size than the session's: they are not used."""

    was: tuple[int, int]
    now: tuple[int, int]


Trouble = Outage | OtherSize


class Live(RealSource):
    """A live source. `Frame.time_s` counts from the opening."""

    is_live = True

    def __init__(
        self,
        opening: Callable[[], CaptureDevice],
        name: str,
        *,
        opened: CaptureDevice | None = None,
        controls: CameraControls | None = None,
        timeout_s: float = READ_TIMEOUT_S,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Open the source and start reading.

        Args:
            opening: opens it, also later when it is gone; raises `SourceError` if that fails.
            name: for messages.
            opened: what `opening` would give now, if it has been called already.
            controls: of a camera; what is asked for is set between two reads.
            timeout_s: without a picture for so long, it is opened again.
            clock: seconds, for when that is done.

        Raises `SourceError` if it cannot be opened, or if no frame comes within `timeout_s`.
        """
        self._opening, self.name, self.controls = opening, name, controls
        self.notes: tuple[str, ...] = ()
        self.on_trouble: Callable[[Trouble | None], None] = lambda trouble: None
        """Called by `read` with the trouble as it begins, changes and ends."""
        self._told: tuple[type, int] | None = None
        self._box: Latest[Frame] = Latest()
        self._stop = threading.Event()
        self._began_s = time.monotonic()
        self.received = 0
        """Number of pictures that have come, read or not."""
        self._readers = [self._reader(opened or opening())]
        first = self._first_frame(timeout_s)
        if first is None:
            self.close()
            raise SourceError(
                f"{name} opens but sends no picture; check that nothing covers or uses it, "
                "then start again."
            )
        self._size = first.image_size
        self._first: Frame | None = first
        self._refused: tuple[int, int] | None = None
        self._connection = Reconnection(timeout_s, OPEN_TIMEOUT_S + timeout_s, clock)

    @property
    def trouble(self) -> Trouble | None:
        """What keeps frames from coming; None if they come."""
        if self._refused is not None and self._connection.outage is None:
            return OtherSize(self._size, self._refused)
        return self._connection.outage

    @property
    def damaged(self) -> int:
        """Number of pictures of this connection that came damaged and were left out."""
        return self._readers[-1].damaged

    def read(self) -> Frame | None:
        """The newest unread frame; waits for one, however long it takes. None after `close()`."""
        while not self._stop.is_set():
            frame = self._box.take(0 if self._first is not None else _LOOK_S) or self._first
            self._first = None
            self._look_after(frame is not None)
            if frame is not None:
                self._refused = None if frame.image_size == self._size else frame.image_size
            self._tell()
            if frame is not None and self._refused is None:
                return frame.flipped(self.flip)
        return None

    def accept_size(self) -> tuple[int, int]:
        """Go on with the size that the pictures have now, which is returned: for a new session.
        From any thread."""
        self._size = self._refused or self._size
        return self._size

    def resume(self) -> None:
        """Nothing was read for a while, on purpose. From the reading thread."""
        self._connection.resume()

    def close(self) -> None:
        """Stop reading and release the device; from any thread. May be called twice."""
        self._stop.set()
        self._box.close()
        for reader in self._readers:
            reader.leave()
        # A device that hangs in a read does not hold up the program's end.
        self._readers[-1].join(timeout_s=2.0)

    # -- within ------------------------------------------------------------------------------------

    def _first_frame(self, timeout_s: float) -> Frame | None:
        end_s = time.monotonic() + timeout_s
        while time.monotonic() < end_s and self._readers[0].is_alive:
            if (frame := self._box.take(_LOOK_S)) is not None:
                return frame
        return self._box.take(0)

    def _receive(self, image: NDArray[np.uint8]) -> None:
        self.received += 1
        time_s = time.monotonic() - self._began_s
        self._box.put(Frame(image, time_s, f"frame {self.received}"))

    def _look_after(self, came: bool) -> None:
        """Open the source again if that is due."""
        reader = self._readers[-1]
        alive, reason = reader.is_alive, reader.reason
        if not self._connection.observe(picture=came, alive=alive, reason=reason):
            return
        reader.leave()
        hanging = [reader for reader in self._readers if reader.is_alive]
        if len(hanging) < _MOST_READERS and not self._stop.is_set():
            self._readers = [*hanging, self._reader()]

    def _reader(self, opened: CaptureDevice | None = None) -> _Reader:
        return _Reader(self.name, self._opening, self._receive, self._attend, opened)

    def _attend(self, capture: Any) -> None:
        if self.controls is not None:
            self.controls.attend(capture)

    def _tell(self) -> None:
        trouble = self.trouble
        tries = trouble.tries if isinstance(trouble, Outage) else 0
        now = None if trouble is None else (type(trouble), tries)
        if now != self._told:
            self._told = now
            self.on_trouble(trouble)


class _Reader:
    """One connection: a thread that opens the source and reads until that fails or it is left."""

    def __init__(
        self,
        name: str,
        opening: Callable[[], CaptureDevice],
        receive: Callable[[NDArray[np.uint8]], None],
        attend: Callable[[Any], None],
        opened: CaptureDevice | None = None,
    ) -> None:
        self._opening, self._receive, self._attend = opening, receive, attend
        self._capture = opened
        self._left = threading.Event()
        self.reason = ""
        self._thread = threading.Thread(target=self._run, name=f"read {name}", daemon=True)
        self._thread.start()

    @property
    def is_alive(self) -> bool:
        return self._thread.is_alive()

    @property
    def damaged(self) -> int:
        return self._capture.damaged if isinstance(self._capture, StreamCapture) else 0

    def leave(self) -> None:
        """End as soon as the device lets us; nothing more is received."""
        self._left.set()

    def join(self, timeout_s: float) -> None:
        if threading.current_thread() is not self._thread:
            self._thread.join(timeout_s)

    def _run(self) -> None:
        # Only this thread uses and releases the device: captures are not thread-safe.
        try:
            self._capture = self._capture or self._opening()
        except Exception as error:
            self.reason = said_by(error)
            return
        try:
            self._read(self._capture)
        except Exception as error:  # whatever a driver raises
            self.reason = said_by(error)
        finally:
            self._capture.release()

    def _read(self, capture: CaptureDevice) -> None:
        failures = 0
        while not self._left.is_set() and failures < _FAILURES_ALLOWED:
            good, image = capture.read()
            if self._left.is_set():
                return
            if not good:
                failures += 1
                self._left.wait(0.05)
                continue
            failures = 0
            self._receive(image)
            self._attend(capture)

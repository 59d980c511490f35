"""Runs a source on two threads: images as they come, and observations of the board.

    watch   source -> `on_picture` at once, and the frame box
    detect  frame box -> detection -> observation box

    stream = ObservationStream(source, BoardTracker(Detector(board)), on_picture=show)
    stream.run(lambda: use(stream.take(timeout=0.05)))   # until stop() or a signal

All boxes hold the newest value only: the image never waits for detection, nor detection for the
user of its observations.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from venus3d.engine.calibration.observation import Observation
from venus3d.sources.board_tracker import Tracker
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Frame, Source
from venus3d.sources.live import Live
from venus3d.sources.looped import Looped
from venus3d.sources.source_news import Remarks
from venus3d.sources.video import Video
from venus3d.sources.watched_folder import WatchedFolder
from venus3d.threads.flow import Flow
from venus3d.threads.latency import low_latency
from venus3d.threads.latest import Latest
from venus3d.threads.signals import on_stop_signal

# Seconds for which each image of a folder is shown.
_STILL_S = 1.0


class ObservationStream:
    """The observations of one source, until `stop` is called or the source fails."""

    def __init__(
        self,
        source: Source,
        tracker: Tracker,
        *,
        on_picture: Callable[[Frame], None],
        reopen: Callable[[], Source] | None = None,
        flow: Flow | None = None,
    ) -> None:
        """Nothing is read until `run`.

        Args:
            source: closed at the end of `run`.
            on_picture: called with every frame, on the watching thread; must not block.
            reopen: reopens a recording when it has ended; None: `source` continues by itself.
            flow: counts the frames that come and that are searched.
        """
        self.source, self.tracker = source, tracker
        self._on_picture = on_picture
        self._looped = None if reopen is None else Looped(reopen)
        self._flow, self._counted = flow or Flow(), 0
        self._frames: Latest[Frame] = Latest()
        self._observations: Latest[Observation] = Latest()
        self._stop = threading.Event()
        self._running = threading.Event()  # cleared while paused
        self._running.set()
        self._failure: BaseException | None = None
        self._read_s = time.monotonic()
        self._remarks = Remarks()

    @property
    def remarks(self) -> int:
        """How many remarks on the source were printed."""
        return self._remarks.count

    @property
    def silent_s(self) -> float:
        """Seconds since the last frame; 0 while paused."""
        return time.monotonic() - self._read_s if self._running.is_set() else 0.0

    @property
    def failed(self) -> bool:
        """Whether the source or the detection has failed."""
        return self._failure is not None

    def stop(self) -> None:
        """Request the end; from any thread."""
        self._stop.set()

    def pause(self, on: bool) -> None:
        """Stop reading frames, or resume; from any thread."""
        (self._running.clear if on else self._running.set)()

    def take(self, timeout: float) -> Observation | None:
        """The newest observation not taken yet; None after `timeout` seconds."""
        return self._observations.take(timeout)

    @low_latency()
    def run(self, step: Callable[[], None], at_end: Callable[[], None] = lambda: None) -> None:
        """Call `step` repeatedly, until `stop`, a signal that asks to end, or a failure.

        Args:
            step: does what is due, waiting only briefly for the next observation.
            at_end: called before the source is closed, whatever ended the run.

        Raises what `step` raised. The source's exception is kept for `check`.
        """
        loops = {"watch": self._watch, "detect": self._detect}
        threads = [
            threading.Thread(target=self._guarded, args=(loop,), name=name, daemon=True)
            for name, loop in loops.items()
        ]
        for thread in threads:
            thread.start()
        try:
            # Instead of being interrupted anywhere.
            with on_stop_signal(self.stop):
                while not self._stop.is_set():
                    step()
        finally:
            self._stop.set()
            self._running.set()
            self._frames.close()
            self._observations.close()
            at_end()
            if isinstance(self.source, (Live, WatchedFolder)):  # they may wait for ever
                self.source.close()
            for thread in threads:
                thread.join(timeout=2)
            self.source.close()
            if self._looped is not None:
                self._looped.close()

    def check(self) -> None:
        """Raises the exception that ended the source or the detection, if any."""
        if self._failure is not None:
            raise self._failure

    # -- threads ---------------------------------------------------------------------------------

    def _guarded(self, loop: Callable[[], None]) -> None:
        try:
            while not self._stop.is_set():
                loop()
        except BaseException as error:  # passed on to the thread that called run()
            self._failure = error
            self._stop.set()

    def _watch(self) -> None:
        if not self._running.is_set():
            self._running.wait()
            self._read_s = time.monotonic()
            if isinstance(self.source, (Video, Live)):
                self.source.resume()
        frame = self.source.read()
        self._remarks.look(self.source)
        if frame is None:
            self._begin_again()
            return
        self._read_s = time.monotonic()
        self._count()
        self._on_picture(frame)
        self._frames.put(frame)
        if self._looped is not None:
            self._looped.open_ahead(self.source)
        if isinstance(self.source, Folder):
            self._stop.wait(_STILL_S)

    def _count(self) -> None:
        """Count the frames that have come: of a live source also those that were not read."""
        if isinstance(self.source, Live):
            self._flow.note("came", self.source.received - self._counted)
            self._counted = self.source.received
        else:
            self._flow.note("came")

    def _begin_again(self) -> None:
        if self._looped is None or self._stop.is_set():
            return
        self.source = self._looped.again(self.source)
        if self._stop.is_set():  # the end has closed the old one
            self.source.close()

    def _detect(self) -> None:
        frame = self._frames.take(timeout=0.2)
        if frame is not None:
            self._observations.put(self.tracker.track(frame))
            self._flow.note("searched")

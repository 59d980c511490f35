"""A source watched by two threads: its pictures as they come, and what is seen of the board.

    watch   source -> `on_picture` at once, and the frame box
    detect  frame box -> detection -> observation box

    stream = ObservationStream(source, BoardTracker(Detector(board)), on_picture=show)
    stream.run(lambda: use(stream.take(timeout=0.05)))   # until stop() or a signal

Both boxes have one slot in which the newest wins: the picture never waits for detection, detection
never for what is done with its observations.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from venus3d.engine.calibration.observation import Observation
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Frame, Source
from venus3d.sources.video import Video
from venus3d.threads.latency import low_latency
from venus3d.threads.latest import Latest
from venus3d.threads.signals import on_stop_signal

# How long a still of a folder is shown.
_STILL_S = 1.0


class ObservationStream:
    """The observations of one source, until `stop` was called or the source broke."""

    def __init__(
        self,
        source: Source,
        tracker: BoardTracker,
        *,
        on_picture: Callable[[Frame], None],
        reopen: Callable[[], Source] | None = None,
    ) -> None:
        """Nothing is read until `run`.

        Args:
            source: closed at the end of `run`.
            on_picture: called with every frame, on the watching thread; must not block.
            reopen: opens a recording anew when it has ended; None: `source` goes on by itself.
        """
        self.source, self.tracker = source, tracker
        self._on_picture, self._reopen = on_picture, reopen
        self._frames: Latest[Frame] = Latest()
        self._observations: Latest[Observation] = Latest()
        self._stop = threading.Event()
        self._running = threading.Event()  # cleared while paused
        self._running.set()
        self._failure: BaseException | None = None

    def stop(self) -> None:
        """Ask for the end; from any thread."""
        self._stop.set()

    def pause(self, on: bool) -> None:
        """Read no frames for now, or go on; from any thread."""
        (self._running.clear if on else self._running.set)()

    def take(self, timeout: float) -> Observation | None:
        """The newest observation that was not taken yet; None after `timeout` seconds."""
        return self._observations.take(timeout)

    @low_latency()
    def run(self, step: Callable[[], None], at_end: Callable[[], None] = lambda: None) -> None:
        """Call `step` again and again, until `stop`, a signal that asks to end, or a failure.

        Args:
            step: does what is due, waiting only briefly for the next observation.
            at_end: called before the source is closed, whatever ended the run.

        Raises what `step` raised. What broke the source is kept for `check`.
        """
        threads = [
            threading.Thread(target=self._guarded, args=(loop,), name=name, daemon=True)
            for name, loop in (("watch", self._watch), ("detect", self._detect))
        ]
        for thread in threads:
            thread.start()
        try:
            # Instead of breaking off wherever we are.
            with on_stop_signal(self.stop):
                while not self._stop.is_set():
                    step()
        finally:
            self._stop.set()
            self._running.set()
            self._frames.close()
            self._observations.close()
            at_end()
            for thread in threads:
                thread.join(timeout=2)
            self.source.close()

    def check(self) -> None:
        """Raises what broke the source, or the detection, if anything has."""
        if self._failure is not None:
            raise self._failure

    # -- threads ---------------------------------------------------------------------------------

    def _guarded(self, loop: Callable[[], None]) -> None:
        try:
            while not self._stop.is_set():
                loop()
        except BaseException as error:  # handed to the thread that called run()
            self._failure = error
            self._stop.set()

    def _watch(self) -> None:
        if not self._running.is_set():
            self._running.wait()
            if isinstance(self.source, Video):
                self.source.resume()
        frame = self.source.read()
        if frame is None:
            self._begin_again()
            return
        self._on_picture(frame)
        self._frames.put(frame)
        if isinstance(self.source, Folder):
            self._stop.wait(_STILL_S)

    def _begin_again(self) -> None:
        # Seconds of video are no calibration: it plays on until a person ends it.
        if self._reopen is None or self._stop.is_set():
            return
        self.source.close()
        self.source = self._reopen()
        if self._stop.is_set():  # the end has closed the old one
            self.source.close()

    def _detect(self) -> None:
        frame = self._frames.take(timeout=0.2)
        if frame is not None:
            self._observations.put(self.tracker.track(frame))

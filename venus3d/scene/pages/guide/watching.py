"""The threads that every live run has: pictures in, observations out, until somebody stops it.

    watch   source -> frame box, and the picture to the viewer at once
    look    frame box -> detection -> observation box
    guide   (the caller's thread) observation box -> `_guide`, which is a subclass's

What is done with an observation is left to `live` (a calibration) and `trial` (an experiment).
"""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Callable

from venus3d.engine.calibration.observation import Observation
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Frame, Source
from venus3d.sources.video import Video
from venus3d.threads.latency import prompt
from venus3d.threads.latest import Latest
from venus3d.threads.signals import taken

# How long a still of a folder is shown.
_STILL_S = 1.0


class Watching(ABC):
    """One source with its viewer, watched until `stop` was called or the source broke."""

    def __init__(
        self,
        source: Source,
        eyes: BoardTracker,
        viewer: Viewer,
        again: Callable[[], Source],
        audience: Audience | None = None,
    ) -> None:
        """`again` opens a recording anew when it has ended; `source` is closed at the end."""
        self._source, self._eyes, self._viewer = source, eyes, viewer
        self._again, self._audience = again, audience
        self._frames: Latest[Frame] = Latest()
        self._observations: Latest[Observation] = Latest()
        self._looked: tuple[tuple[Observation, Frame], ...] = ()
        self._stop = threading.Event()
        self._running = threading.Event()  # cleared while paused
        self._running.set()
        self._failure: BaseException | None = None

    def stop(self) -> None:
        """Ask for the end; from any thread."""
        self._stop.set()

    @abstractmethod
    def _guide(self) -> None:
        """Do what is due now, waiting only briefly for the next observation."""

    @abstractmethod
    def _end(self) -> None:
        """End what a subclass has running, before the source is closed."""

    @prompt()
    def _watch_until_stopped(self) -> None:
        """Run the threads and `_guide`, until `stop`, a signal that asks to end, or a failure."""
        threads = [
            threading.Thread(target=self._guarded, args=(step,), name=name, daemon=True)
            for name, step in (("watch", self._watch), ("look", self._look))
        ]
        for thread in threads:
            thread.start()
        try:
            # Instead of breaking off wherever we are.
            with taken(self.stop):
                while not self._stop.is_set():
                    self._guide()
        finally:
            self._stop.set()
            self._running.set()
            self._frames.close()
            self._observations.close()
            self._end()
            for thread in threads:
                thread.join(timeout=2)
            self._source.close()

    # -- threads ---------------------------------------------------------------------------------

    def _guarded(self, step: Callable[[], None]) -> None:
        try:
            while not self._stop.is_set():
                step()
        except BaseException as error:  # handed to the thread that called run()
            self._failure = error
            self._stop.set()

    def _watch(self) -> None:
        if not self._running.is_set():
            self._running.wait()
            if isinstance(self._source, Video):
                self._source.resume()
        frame = self._source.read()
        if frame is None:
            if not self._stop.is_set():
                # Seconds of video are no calibration: it plays on until a person ends it.
                self._source.close()
                self._source = self._again()
                if self._stop.is_set():  # the end has closed the old one
                    self._source.close()
            return
        self._viewer.show_picture(frame.image)
        if self._audience is not None:
            self._audience.show_picture(frame.image)
        self._frames.put(frame)
        if isinstance(self._source, Folder):
            self._stop.wait(_STILL_S)

    def _look(self) -> None:
        frame = self._frames.take(timeout=0.2)
        if frame is not None:
            seen = self._eyes.look(frame)
            # Replaced as a whole, since another thread looks up in it which frame a view is of.
            self._looked = (*self._looked[-2:], (seen, frame))
            self._observations.put(seen)

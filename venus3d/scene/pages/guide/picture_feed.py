"""The live picture's own loop: newest picture in, drawn on and shown, at most so many a second.

So the picture waits for nothing else that is drawn, and nothing else for the picture.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from venus3d.engine.calibration.observation import Observation
from venus3d.scene.render.annotated_picture import LivePicture

_PERIOD_S = 1 / 15

Came = tuple[LivePicture, Observation | None]
"""A picture, and what was found in it if that is known."""


class PictureFeed:
    """A box with one slot in which the newest picture wins, and the loop that empties it."""

    def __init__(self, draw: Callable[[Came], None]) -> None:
        """`draw` shows one picture."""
        self._draw = draw
        self.newest: Came | None = None
        self._came, self._stop = threading.Event(), threading.Event()

    def put(self, image: LivePicture, observation: Observation | None) -> None:
        """Show this one next."""
        self.newest = (image, observation)
        self._came.set()

    def again(self) -> None:
        """Show the newest one once more: what is drawn on it has changed."""
        self._came.set()

    def stop(self) -> None:
        """End the loop, after what is being drawn."""
        self._stop.set()
        self._came.set()

    def loop(self) -> None:
        """Show what comes, until `stop`."""
        while not self._stop.is_set():
            self._came.wait()
            self._came.clear()
            started, newest = time.monotonic(), self.newest
            if newest is None or self._stop.is_set():
                continue
            self._draw(newest)
            self._stop.wait(max(0.0, started + _PERIOD_S - time.monotonic()))

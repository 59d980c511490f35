"""The live picture's own loop: newest picture in, drawn on and shown, at most so many a second.

So the picture waits for nothing else that is drawn, and nothing else for the picture.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from venus3d.engine.calibration.observation import Observation
from venus3d.render.annotated_picture import LivePicture

PICTURE_PERIOD_S = 1 / 15


class SeenPicture(NamedTuple):
    """A picture (BGR or grey), and what was found in it if that is known."""

    image: LivePicture
    observation: Observation | None = None


class PictureFeed:
    """A box with one slot in which the newest picture wins, and the loop that empties it."""

    def __init__(
        self,
        draw: Callable[[SeenPicture], None],
        period_s: Callable[[], float] = lambda: PICTURE_PERIOD_S,
    ) -> None:
        """`draw` shows one picture; there are at least `period_s()` seconds between two."""
        self._draw, self._period_s = draw, period_s
        self.newest: SeenPicture | None = None
        self._came, self._stop = threading.Event(), threading.Event()

    def put(self, image: LivePicture, observation: Observation | None) -> None:
        """Show this one next."""
        self.newest = SeenPicture(image, observation)
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
            self._stop.wait(max(0.0, started + self._period_s() - time.monotonic()))

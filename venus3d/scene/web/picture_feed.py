"""The live picture's own loop: draws and shows the newest at a limited rate. Neither the picture
nor the rest of the page waits for the other."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import NamedTuple

from venus3d.engine.calibration.observation import Observation
from venus3d.render.annotated_picture import LivePicture

PICTURE_PERIOD_S = 1 / 18


class SeenPicture(NamedTuple):
    """A picture (BGR or grey), and what was detected in it, if known."""

    image: LivePicture
    observation: Observation | None = None
    came_s: float | None = None
    """When it came from its source, by `time.monotonic`, if that is known."""


class PictureFeed:
    """A one-slot queue that keeps the newest picture, and the loop that empties it."""

    def __init__(
        self,
        draw: Callable[[SeenPicture], None],
        period_s: Callable[[], float] = lambda: PICTURE_PERIOD_S,
    ) -> None:
        """`draw` shows one picture, at least every `period_s()` seconds apart."""
        self._draw, self._period_s = draw, period_s
        self.newest: SeenPicture | None = None
        self._came, self._stop = threading.Event(), threading.Event()

    def put(
        self,
        image: LivePicture,
        observation: Observation | None,
        came_s: float | None = None,
    ) -> None:
        """Queue this picture."""
        self.newest = SeenPicture(image, observation, came_s)
        self._came.set()

    def again(self) -> None:
        """Show the newest picture again: its overlay has changed."""
        self._came.set()

    def stop(self) -> None:
        """End the loop after the current picture."""
        self._stop.set()
        self._came.set()

    def loop(self) -> None:
        """Show pictures until `stop`."""
        while not self._stop.is_set():
            self._came.wait()
            self._came.clear()
            started, newest = time.monotonic(), self.newest
            if newest is None or self._stop.is_set():
                continue
            self._draw(newest)
            self._stop.wait(max(0.0, started + self._period_s() - time.monotonic()))

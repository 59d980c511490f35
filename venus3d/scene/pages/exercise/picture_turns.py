"""Chooses which tab's picture to draw next when there is no time for all. A tab's new request
replaces its old one; the tab that has waited longest for a picture is next."""

from __future__ import annotations

import threading
from collections.abc import Callable
from itertools import count

Job = Callable[[], None]
"""Draws one picture and delivers it."""


class PictureTurns:
    """The queue of pictures to draw; thread-safe."""

    def __init__(self) -> None:
        """An empty queue."""
        self._wanted: dict[tuple[int, str], Job] = {}
        self._drawn: dict[tuple[int, str], int] = {}  # turn of the last picture
        self._count = count(1)
        self._lock = threading.Lock()

    def ask(self, tab: int, what: str, job: Job) -> None:
        """Queue this job for the tab."""
        with self._lock:
            self._wanted[tab, what] = job

    def forget(self, tab: int) -> None:
        """Drop the tab's requests: it has closed."""
        with self._lock:
            for of_all in (self._wanted, self._drawn):
                for key in [key for key in of_all if key[0] == tab]:
                    del of_all[key]

    def take(self) -> tuple[int, Job] | None:
        """The next tab and its job; None if the queue is empty."""
        with self._lock:
            if not self._wanted:
                return None
            key = min(self._wanted, key=lambda key: self._drawn.get(key, 0))
            self._drawn[key] = next(self._count)
            return key[0], self._wanted.pop(key)


def fitting(size: tuple[int, int], room: tuple[int, int]) -> tuple[int, int]:
    """The largest (width, height) of this aspect within `room`; at least one pixel each."""
    scale = min(room[0] / size[0], room[1] / size[1])
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))

"""Whose picture is drawn next, where many tabs want theirs and the time does not do for all.

Who asks again before it was their turn replaces their own request: the newest wins. The next one
is who had no picture for longest, so that a class shares evenly what can be drawn.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from itertools import count

Job = Callable[[], None]
"""Draws one picture and hands it over."""


class PictureTurns:
    """The pictures that are still to be drawn. May be used from any thread."""

    def __init__(self) -> None:
        """Nothing is waited for."""
        self._wanted: dict[tuple[int, str], Job] = {}
        self._drawn: dict[tuple[int, str], int] = {}  # when last, counted in turns
        self._count = count(1)
        self._lock = threading.Lock()

    def ask(self, tab: int, what: str, job: Job) -> None:
        """Do this when it is that tab's turn."""
        with self._lock:
            self._wanted[tab, what] = job

    def forget(self, tab: int) -> None:
        """That tab looks at no picture any more."""
        with self._lock:
            for of_all in (self._wanted, self._drawn):
                for key in [key for key in of_all if key[0] == tab]:
                    del of_all[key]

    def take(self) -> tuple[int, Job] | None:
        """Whose turn it is, and what is to be done; None if nobody waits."""
        with self._lock:
            if not self._wanted:
                return None
            key = min(self._wanted, key=lambda key: self._drawn.get(key, 0))
            self._drawn[key] = next(self._count)
            return key[0], self._wanted.pop(key)


def fitting(size: tuple[int, int], room: tuple[int, int]) -> tuple[int, int]:
    """The largest (width, height) of this shape within `room`; at least one pixel a side."""
    scale = min(room[0] / size[0], room[1] / size[1])
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))

"""Whose picture is drawn next: what each trainee's camera sees, in turns.

Whoever asks again before it was their turn replaces their own wish: the newest wins, and nobody
waits for more than one picture of each of the others.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
Job = Callable[[], None]
"""Draws one picture and hands it over."""


class Turns:
    """The pictures that are still to be drawn. May be used from any thread."""

    def __init__(self) -> None:
        """Nothing is waited for."""
        self._wanted: OrderedDict[tuple[int, str], Job] = OrderedDict()
        self._lock = threading.Lock()

    def ask(self, who: int, what: str, job: Job) -> None:
        """Do this when it is their turn. Whoever waits for it already keeps the place."""
        with self._lock:
            self._wanted[who, what] = job

    def forget(self, who: int) -> None:
        """They look at no picture any more."""
        with self._lock:
            for key in [key for key in self._wanted if key[0] == who]:
                del self._wanted[key]

    def take(self) -> tuple[int, Job] | None:
        """Whose turn it is, and what is to be done; None if nobody waits."""
        with self._lock:
            if not self._wanted:
                return None
            (who, _), job = self._wanted.popitem(last=False)
            return who, job


def fitting(size: tuple[int, int], room: tuple[int, int]) -> tuple[int, int]:
    """The largest (width, height) of this shape within `room`; at least one pixel a side."""
    scale: Any = min(room[0] / size[0], room[1] / size[1])
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))

"""What each trainee's camera sees, drawn by one renderer for all, in turns.

Whoever asks again before it was their turn replaces their own wish: the newest wins, and nobody
waits for more than one picture of each of the others.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
Draw = Callable[[], Picture]
"""Renders one picture; called on the pictures' own thread."""
Deliver = Callable[[Picture], None]


class FairPictures:
    """One thread that draws pictures; `ask` from any thread."""

    def __init__(self, on_error: Callable[[Hashable, Exception], None]) -> None:
        """`on_error` is told on the pictures' thread whose picture could not be drawn, and why."""
        self._wanted: OrderedDict[Hashable, tuple[Draw, Deliver]] = OrderedDict()
        self._wake = threading.Condition()
        self._stop = False
        self._on_error = on_error
        self._thread = threading.Thread(target=self._run, name="pictures", daemon=True)
        self._thread.start()

    def ask(self, who: Hashable, draw: Draw, deliver: Deliver) -> None:
        """Draw this when it is their turn. Whoever waits already keeps the place in the queue."""
        with self._wake:
            self._wanted[who] = (draw, deliver)
            self._wake.notify()

    def forget(self, who: Hashable) -> None:
        """Nobody looks at these pictures any more."""
        with self._wake:
            self._wanted.pop(who, None)

    def close(self) -> None:
        """Stop. May be called twice."""
        with self._wake:
            self._stop = True
            self._wake.notify()
        self._thread.join(timeout=5)

    def _run(self) -> None:
        while True:
            with self._wake:
                while not (self._wanted or self._stop):
                    self._wake.wait()
                if self._stop:
                    return
                who, (draw, deliver) = self._wanted.popitem(last=False)
            try:
                deliver(draw())
            except Exception as error:
                self._on_error(who, error)


def fitting(size: tuple[int, int], room: tuple[int, int]) -> tuple[int, int]:
    """The largest (width, height) of this shape within `room`; at least one pixel a side."""
    scale: Any = min(room[0] / size[0], room[1] / size[1])
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))

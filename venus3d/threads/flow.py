"""How pictures flow through a program: how many a second in each stage, how old when sent."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median
from typing import Literal

Stage = Literal["came", "searched", "sent"]
"""From the source; searched for the board; sent to the browsers."""
_WINDOW_S = 5.0


@dataclass(frozen=True)
class FlowFigures:
    """The last seconds in numbers, and all since the beginning."""

    per_second: dict[Stage, float] = field(default_factory=dict[Stage, float])
    age_s: float = float("nan")
    """Median age of the pictures when they were sent; NaN if none was."""
    came: int = 0
    """All pictures that have come."""
    skipped: int = 0
    """Those of them that were not searched, since newer ones came meanwhile."""
    damaged: int = 0
    """Pictures that came damaged and were left out."""


class Flow:
    """Counts pictures, and the ages of those that are sent. Any thread may call it."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._lock, self._began_s = clock, threading.Lock(), clock()
        self._times: dict[Stage, deque[float]] = {
            "came": deque(maxlen=2000),
            "searched": deque(maxlen=2000),
            "sent": deque(maxlen=2000),
        }
        self._ages: deque[float] = deque(maxlen=200)
        self._totals: dict[Stage, int] = dict.fromkeys(self._times, 0)

    def note(self, stage: Stage, count: int = 1) -> None:
        """So many pictures have reached this stage now."""
        now_s = self._clock()
        with self._lock:
            self._times[stage].extend([now_s] * count)
            self._totals[stage] += count

    def note_sent(self, came_s: float) -> None:
        """A picture that came at this time of the clock has been sent."""
        self.note("sent")
        with self._lock:
            self._ages.append(self._clock() - came_s)

    def figures(self, damaged: int = 0) -> FlowFigures:
        """The figures now."""
        now_s = self._clock()
        with self._lock:
            window_s = max(1.0, min(_WINDOW_S, now_s - self._began_s))
            rates: dict[Stage, float] = {
                stage: sum(now_s - time_s < window_s for time_s in times) / window_s
                for stage, times in self._times.items()
            }
            age_s = median(self._ages) if self._ages else float("nan")
            came, searched = self._totals["came"], self._totals["searched"]
        return FlowFigures(rates, age_s, came, max(0, came - searched), damaged)

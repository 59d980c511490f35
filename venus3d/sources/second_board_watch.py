"""Looks for another board beside the one detected, now and then."""

from __future__ import annotations

import threading
import time
from collections import deque

from venus3d.engine.calibration.board_finding import FoundBoard
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.threads.latest import Latest

EVERY_S, SHARE = 3.0, 0.05
"""How often, and the largest share of one core's time."""
_LOOKS = 2
"""Looks that count: a board that is not seen in so many is gone."""


class SecondBoardWatch:
    """Tells the detector of another board beside its own; a thread calls `look` again and again."""

    def __init__(self, detector: Detector, stop: threading.Event) -> None:
        """`stop`: set when it shall end."""
        self._detector, self._stop = detector, stop
        self._seen: Latest[Observation] = Latest()
        self._looks: deque[FoundBoard | None] = deque(maxlen=_LOOKS)

    def put(self, observation: Observation) -> None:
        """The newest image with the board; never waits."""
        if observation.count:
            self._seen.put(observation)

    def look(self) -> None:
        """Look at the newest image, and wait until the next look is due."""
        seen = self._seen.take(timeout=0.2)
        if seen is None:
            return
        began = time.thread_time()
        self._looks.append(self._detector.look_beside(seen.image, seen))
        self._detector.note_beside(self._looks)
        self._stop.wait(max(EVERY_S, (time.thread_time() - began) / SHARE))

    def close(self) -> None:
        """Wake `look`."""
        self._seen.close()

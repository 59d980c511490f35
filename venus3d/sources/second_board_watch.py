"""Looks for another board beside the one detected, now and then."""

from __future__ import annotations

import threading
import time
from collections import deque

from venus3d.engine.calibration.detection import Beside, Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.threads.latest import Latest

EVERY_S, SHARE = 3.0, 0.05
"""How often, and the largest share of one core's time."""
_LOOKS = 2
"""Looks that count: a board that is not seen in so many is gone."""


class SecondBoardWatch:
    """Tells the detector of another board beside its own, on a thread of its own."""

    def __init__(self, detector: Detector) -> None:
        """Starts the thread."""
        self._detector = detector
        self._seen: Latest[Observation] = Latest()
        self._looks: deque[Beside | None] = deque(maxlen=_LOOKS)
        self._failure: Exception | None = None
        self._end = threading.Event()
        threading.Thread(target=self._look, name="beside", daemon=True).start()

    def put(self, observation: Observation) -> None:
        """The newest image with the board; never waits. Raises what the last look raised."""
        if self._failure is not None:
            raise self._failure
        if observation.count:
            self._seen.put(observation)

    def close(self) -> None:
        """End the thread, once its look is over."""
        self._end.set()
        self._seen.close()

    def _look(self) -> None:
        try:
            while not self._end.is_set():
                seen = self._seen.take()
                if seen is None:
                    continue
                began = time.thread_time()
                self._looks.append(self._detector.look_beside(seen.image, seen))
                self._detector.note_beside(self._looks)
                self._end.wait(max(EVERY_S, (time.thread_time() - began) / SHARE))
        except Exception as error:
            self._failure = error

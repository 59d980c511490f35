"""The small threads that draw a page: started together, ended together, and what broke one is told.

What they draw and what they wait for is the page's own.
"""

from __future__ import annotations

import threading
from collections.abc import Callable


class DrawingThreads:
    """Loops that run until `stop` is set. What breaks one is raised where the page is fed."""

    def __init__(self, **loops: Callable[[], None]) -> None:
        """One thread for each loop, by its name; `start` starts them."""
        self.stop = threading.Event()
        """Set when the page is closed; a loop that has broken does not set it."""
        self._ended = threading.Event()
        self._failure: BaseException | None = None
        self._threads = [
            threading.Thread(target=self._guarded, args=(loop,), name=name, daemon=True)
            for name, loop in loops.items()
        ]

    def start(self) -> None:
        """Let them run."""
        for thread in self._threads:
            thread.start()

    def raise_failure(self) -> None:
        """Raise what has broken a loop, if anything has."""
        if self._failure is not None:
            raise self._failure

    def wait(self, seconds: float) -> None:
        """Wait while they run; raises what has broken one."""
        self._ended.wait(seconds)
        self.raise_failure()

    def end(self, wake: Callable[[], None]) -> bool:
        """Stop them; `wake` rouses those that wait. False if it was done before."""
        if self.stop.is_set():
            return False
        self.stop.set()
        self._ended.set()
        wake()
        for thread in self._threads:
            thread.join(timeout=5)
        return True

    def _guarded(self, loop: Callable[[], None]) -> None:
        try:
            loop()
        except BaseException as error:  # raised in the thread that feeds the page
            if not self.stop.is_set():
                self._failure = error
                self._ended.set()

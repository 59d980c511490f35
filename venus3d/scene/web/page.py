"""The base of a page that one server shows to all who open it, drawn by threads of its own.

    class Counter(Page[int]):
        def __init__(self, port: int = 8080) -> None:
            super().__init__(*start_server("127.0.0.1", port), state=0, period_s=1 / 30)
            self._open()                                  # lays the page out and starts drawing

        def _lay_out(self, server: LocalServer) -> None:  # again after a failure, on a new server
            self._text = server.gui.add_markdown("")
            row = ButtonRow(server.gui, "Count", {"more": "+1"}, lambda *_: self.change(more))

        def _draw(self, changed: bool, seconds: float) -> None:
            if changed:
                self._text.content = str(self.state)

    page = Counter(); page.change(more); page.wait(10); page.close()

State is frozen and changed by any thread with `change`; one thread draws it, and the newest wins.
What fails in drawing stays here: it is logged once, a new server takes the old one's place on the
same port, the page is laid out on it, and whoever looks is told why. Whoever feeds the page hears
nothing of it. Pages of which every tab has its own are `exercise`'s.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from typing import Generic, TypeVar

from venus3d.scene.web import texts
from venus3d.scene.web.drawing import DrawingThreads, tell_of_failure
from venus3d.scene.web.server import LocalServer, serve_anew

State = TypeVar("State")
_IDLE_S = 0.5


class Page(ABC, Generic[State]):
    """One page, shared by all tabs that are open on it; any thread may call it."""

    def __init__(
        self, server: LocalServer, *notes: str, state: State, period_s: float = 1 / 50
    ) -> None:
        """Take a running server; `_open` then shows the page on it.

        Args:
            notes: what the terminal is to be told; empty ones are left out.
            state: what is shown first.
            period_s: at least so long between two calls of `_draw`.
        """
        self.server = server
        self.notes = tuple(note for note in notes if note)
        self.host, self.port = server.get_host(), server.get_port()
        self._state, self._period = state, period_s
        self._lock = threading.Condition()
        self._changed = True
        self._threads = DrawingThreads(self._draw_anew)

    @property
    def url(self) -> str:
        """The page's address on this machine."""
        return self.server.url

    @property
    def state(self) -> State:
        """What is shown now."""
        return self._state

    def change(self, change: Callable[[State], State]) -> State:
        """Show something else; the new state. Nothing is drawn for the very same state."""
        with self._lock:
            before, self._state = self._state, change(self._state)
            if self._state is not before:
                self._changed = True
                self._lock.notify_all()
            return self._state

    def wake(self) -> None:
        """Have the page drawn again: something that it shows has changed."""
        with self._lock:
            self._changed = True
            self._lock.notify_all()

    def nudge(self) -> None:
        """Have `_draw` called soon, although nothing that it shows has changed."""
        with self._lock:
            self._lock.notify_all()

    def wait(self, seconds: float) -> None:
        """Wait while the page is open."""
        self._threads.stop.wait(seconds)

    def close(self) -> None:
        """Stop drawing and serving. May be called twice."""
        if self._threads.end(self._wake_loops):
            self.server.stop()

    # -- a page's own ----------------------------------------------------------------------------

    @abstractmethod
    def _lay_out(self, server: LocalServer) -> None:
        """Put an empty page on a server without one."""

    @abstractmethod
    def _draw(self, changed: bool, seconds: float) -> None:
        """Bring the page up to date; on its own thread, again and again.

        Args:
            changed: whether `change` or `wake` was called since the last time.
            seconds: since the last time.
        """

    @property
    def _is_moving(self) -> bool:
        """Whether `_draw` has something to do soon although nothing changes."""
        return False

    @property
    def _period_s(self) -> float:
        """At least so long between two calls of `_draw`."""
        return self._period

    def _wake_loops(self) -> None:
        """Let every loop go on: the page is closed, or was laid out anew."""
        self.wake()

    def _tell_of_failure(self, error: Exception) -> None:
        """The page was laid out anew after this error: tell whoever is to know."""
        tell_of_failure(self.server, error)

    # -- the machinery ---------------------------------------------------------------------------

    def _open(self, **loops: Callable[[], None]) -> None:
        """Lay the page out and start drawing; `loops` are further threads, by their names."""
        self._lay_out(self.server)
        self._threads = DrawingThreads(self._draw_anew, scene=self._loop, **loops)
        self._threads.start()

    @property
    def _stopping(self) -> threading.Event:
        """Set when the page is closed."""
        return self._threads.stop

    def _advance(self, change: Callable[[State], State]) -> State:
        """Let the state go on by itself while it is drawn."""
        with self._lock:
            self._state = change(self._state)
            return self._state

    def _draw_anew(self, error: Exception) -> None:
        """A new server in the old one's place: whatever broke, nothing of it is left."""
        self.server = serve_anew(self.server, self._threads.stop)
        self._lay_out(self.server)
        self._tell_of_failure(error)
        self._wake_loops()

    def _loop(self) -> None:
        before, stop = time.monotonic(), self._threads.stop
        while not stop.is_set():
            with self._lock:
                if not self._changed:
                    self._lock.wait(timeout=self._period_s if self._is_moving else _IDLE_S)
                changed, self._changed = self._changed, False
            now = time.monotonic()
            before, seconds = now, now - before
            self._draw(changed, seconds)
            stop.wait(max(0.0, now + self._period_s - time.monotonic()))


def announce(*lines: str) -> None:
    """Print these lines, empty ones left out; a terminal that is gone stops no page."""
    with suppress(OSError):
        for line in filter(None, lines):
            print(line, flush=True)


def announce_page(title: str, url: str, *notes: str) -> None:
    """Print where a page is and how it is ended."""
    announce(*notes, texts.PAGE_ANNOUNCED.format(title=title, url=url))

"""Base of a page that one server shows to all its visitors, drawn by its own threads.

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

State is frozen and changed with `change` by any thread; one thread draws the newest. A drawing
error never reaches the page's caller: it is logged once, the page is laid out again on a new server
on the same port, and visitors are told why. Pages with one instance per tab are `exercise`'s.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from contextlib import suppress
from typing import Generic, TypeVar

from venus3d.engine.printable import printable
from venus3d.languages import PageLanguage
from venus3d.scene.web import terminal_texts
from venus3d.scene.web.drawing import DrawingThreads, tell_of_failure
from venus3d.scene.web.qr_code import qr_code_if_seen
from venus3d.scene.web.server import LocalServer, serve_anew

State = TypeVar("State")
_IDLE_S = 0.5


class Page(ABC, Generic[State]):
    """One page, shared by all its tabs; any thread may call it."""

    def __init__(
        self, server: LocalServer, *notes: str, state: State, period_s: float = 1 / 50
    ) -> None:
        """Take a running server; `_open` then shows the page on it.

        Args:
            notes: lines for the terminal; empty ones are left out.
            state: the initial state.
            period_s: shortest time between two calls of `_draw`.
        """
        self.server = server
        self.notes = tuple(note for note in notes if note)
        self.host, self.port = server.get_host(), server.get_port()
        self._state, self._period = state, period_s
        self._lock = threading.Condition()
        self._changed = True
        self._another_language = False
        self._threads = DrawingThreads(self._draw_anew)

    @property
    def url(self) -> str:
        """The page's address on this machine, with its token."""
        return self.server.url

    @property
    def language(self) -> PageLanguage:
        """The language of the page; who words something for it does so while it is spoken."""
        return self.server.language

    @property
    def state(self) -> State:
        """The state shown."""
        return self._state

    def change(self, change: Callable[[State], State]) -> State:
        """Change the state and return the new one; nothing is drawn if it is the same object."""
        with self._lock:
            before, self._state = self._state, change(self._state)
            if self._state is not before:
                self.wake()
            return self._state

    def wake(self) -> None:
        """Redraw: something that is shown has changed."""
        with self._lock:
            self._changed = True
            self._lock.notify_all()

    def nudge(self) -> None:
        """Have `_draw` called soon although nothing shown has changed."""
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
        """Lay the page out on an empty server."""

    @abstractmethod
    def _draw(self, changed: bool, seconds: float) -> None:
        """Update the page; called repeatedly on its own thread.

        Args:
            changed: whether `change` or `wake` was called since the last time.
            seconds: since the last time.
        """

    @property
    def _is_moving(self) -> bool:
        """Whether `_draw` is due soon without a change."""
        return False

    @property
    def _period_s(self) -> float:
        """Shortest time between two calls of `_draw`."""
        return self._period

    def _wake_loops(self) -> None:
        """Wake every loop: the page was closed or laid out again."""
        self.wake()

    def _tell_of_failure(self, error: Exception) -> None:
        tell_of_failure(self.server, error)

    # -- the machinery ---------------------------------------------------------------------------

    def _open(self, **loops: Callable[[], None]) -> None:
        """Lay the page out and start drawing; `loops` are more threads, by name."""
        with self.language.spoken():
            self._put_onto(self.server)
            self._threads = DrawingThreads(self._draw_anew, scene=self._loop, **loops)
        self._threads.start()

    def _put_onto(self, server: LocalServer) -> None:
        server.on_first_browser = self._translate
        self._lay_out(server)

    def _translate(self) -> None:
        """Lay the page out again soon: its first browser speaks another language."""
        self._another_language = True
        self.wake()

    @property
    def _stopping(self) -> threading.Event:
        """Set when the page is closed."""
        return self._threads.stop

    def _advance(self, change: Callable[[State], State]) -> State:
        """Advance the state by itself while drawing."""
        with self._lock:
            self._state = change(self._state)
            return self._state

    def _draw_anew(self, error: Exception | None) -> None:
        """Lay the page out on a new server in the old one's place, free of whatever failed."""
        self.server = serve_anew(self.server, self._threads.stop)
        self._put_onto(self.server)
        if error is not None:
            self._tell_of_failure(error)
        self._wake_loops()

    def _loop(self) -> None:
        before, stop = time.monotonic(), self._threads.stop
        while not stop.is_set():
            with self._lock:
                if not self._changed:
                    self._lock.wait(timeout=self._period_s if self._is_moving else _IDLE_S)
                changed, self._changed = self._changed, False
            if self._another_language:
                self._another_language = False
                self._threads.draw_anew()
            now = time.monotonic()
            before, seconds = now, now - before
            self._draw(changed, seconds)
            stop.wait(max(0.0, now + self._period_s - time.monotonic()))


def announce(*lines: str) -> None:
    """Print these lines without empty ones; a closed terminal is ignored."""
    with suppress(OSError):
        for line in filter(None, lines):
            print(printable(line), flush=True)


def announce_page(title: str, server: LocalServer, *notes: str) -> None:
    """Print a page's address and how to end it, and the address for other machines, if any."""
    here = terminal_texts.PAGE_ANNOUNCED.format(title=title, url=server.url)
    announce(*notes, here, *outside_lines(server))


def outside_lines(server: LocalServer) -> tuple[str, ...]:
    """What is said of a page that other machines can open; nothing of any other."""
    url = server.outside_url
    if not url:
        return ()
    reach = terminal_texts.WITHOUT_TOKEN if server.token is None else terminal_texts.WITH_TOKEN
    return terminal_texts.FROM_ELSEWHERE.format(url=url, reach=reach), qr_code_if_seen(url)

"""Threads that draw a page; they start and stop together, and a failure in one does not stop the
others."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from contextvars import copy_context
from traceback import extract_tb

import viser

from venus3d.scene.web import terminal_texts, texts

_LOG = logging.getLogger(__name__)
_LONGEST_WAIT_S = 30.0
_FORGIVEN_S = 60.0
"""Seconds after the last failure after which the next one counts as the first."""
_TOLD_S = 20.0
"""Seconds during which returning tabs are told that their page was reloaded."""


class Failures:
    """Logs errors that do not end the program, each once."""

    def __init__(self) -> None:
        self._told: set[tuple[object, ...]] = set()

    def tell(self, error: Exception, what: str) -> None:
        """Log the error, with `what` failed (one of the texts), unless it was logged before."""
        place = extract_tb(error.__traceback__)[-1:]
        key = (what, type(error), *((frame.filename, frame.lineno) for frame in place))
        if key not in self._told:
            self._told.add(key)
            _LOG.error(terminal_texts.FAILED_ONCE, what, exc_info=error)


class DrawingThreads:
    """Loops that draw one page until `stop` is set. An error in a loop is logged and never reaches
    the page's caller; the page is reloaded and the loops go on. Repeated failures are retried less
    and less often."""

    def __init__(
        self, draw_anew: Callable[[Exception | None], None], **loops: Callable[[], None]
    ) -> None:
        """One thread per loop, named by its keyword.

        Args:
            draw_anew: replaces the page after this error, or without one. Called by one thread at a
            time, while the others may still draw on the old page.
        """
        self.stop = threading.Event()
        """Set when the page is closed, not when a loop fails."""
        self._draw_anew = draw_anew
        self._failures = Failures()
        self._mending = threading.Lock()
        self._page = 0  # counts the pages
        self._wait_s, self._failed_at = 0.0, -_FORGIVEN_S
        # They speak the language in which they are made.
        self._threads = [
            threading.Thread(
                target=copy_context().run, args=(self._guarded, loop), name=name, daemon=True
            )
            for name, loop in loops.items()
        ]

    def start(self) -> None:
        """Start the threads."""
        for thread in self._threads:
            thread.start()

    def end(self, wake: Callable[[], None]) -> bool:
        """Stop them; `wake` wakes those that wait. False if already stopped."""
        if self.stop.is_set():
            return False
        self.stop.set()
        wake()
        for thread in self._threads:
            thread.join(timeout=5)
        return True

    def draw_anew(self) -> None:
        """Replace the page although nothing has failed. Called by one of the threads."""
        with self._mending:
            self._draw_anew(None)
            self._page += 1

    def _guarded(self, loop: Callable[[], None]) -> None:
        while not self.stop.is_set():
            page = self._page
            try:
                loop()
            except Exception as error:
                if not self.stop.is_set():
                    self._mend(error, page)

    def _mend(self, error: Exception, page: int) -> None:
        with self._mending:
            if page != self._page:
                return  # it failed on a page that another thread has already replaced
            self._failures.tell(error, terminal_texts.DRAWING_FAILED)
            if time.monotonic() - self._failed_at > _FORGIVEN_S:
                self._wait_s = 0.0
            while not self._is_drawn_anew(error):
                pass
            self._page += 1
            self._failed_at = time.monotonic()

    def _is_drawn_anew(self, error: Exception) -> bool:
        """Try to reload once, after a delay; whether nothing is left to do."""
        self.stop.wait(self._wait_s)
        self._wait_s = min(_LONGEST_WAIT_S, max(1.0, 2 * self._wait_s))
        if self.stop.is_set():
            return True
        try:
            self._draw_anew(error)
        except Exception as again:
            self._failures.tell(again, terminal_texts.DRAWING_ANEW_FAILED)
            return False
        return True


def tell_of_failure(server: viser.ViserServer, error: Exception) -> None:
    """Tell every tab that connects to the new page why it was reloaded."""
    until = time.monotonic() + _TOLD_S

    def came(tab: viser.ClientHandle) -> None:
        if time.monotonic() < until:
            tell_tab(tab, error)

    server.on_client_connect(came)


def tell_tab(tab: viser.ClientHandle, error: Exception) -> None:
    """Tell this tab that its page was reloaded, why, and that nothing is lost."""
    text = texts.DRAWN_ANEW_WHY.format(cause=type(error).__name__)
    tab.add_notification(texts.DRAWN_ANEW, text, color="yellow")

"""A server where every tab has a page of its own.

    viser's pool  lays pages out for new tabs; queues requests
    the caller's  `step`, repeatedly: requests and the clock -> each tab's model -> its page;
    thread        then the pictures, in turns

Scenes and pictures share one thread on purpose: two would contend for Python's lock at each of the
hundreds of OpenGL calls per picture, and both would be slower.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Iterable
from contextlib import nullcontext
from dataclasses import dataclass
from itertools import count
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
import viser

from venus3d.engine.errors import StorageError
from venus3d.languages import Language, PageLanguage
from venus3d.scene.web import texts
from venus3d.scene.web.camera_rig import FAR, NEAR
from venus3d.scene.web.drawing import Failures, tell_tab
from venus3d.scene.web.server import LocalServer
from venus3d.scene.web.terminal_texts import DRAWING_FAILED, TAB_STOPPED

Job = Callable[[], None]
"""Draws one picture and delivers it."""
Ask = Callable[[Any], None]
"""Called on viser's threads; only queues the request."""


class TabModel(Protocol):
    """What one tab is about: its state machine. Used by one thread, but for `last_view`."""

    def handle(self, request: Any, /) -> None:
        """Carry out a person's request."""

    def tick(self, now_s: float, /) -> None:
        """Advance the clock."""

    def view(self) -> Any:
        """What is to be shown now; the same object until something has changed."""
        ...

    @property
    def last_view(self) -> Any:
        """The view made last, for other threads."""
        ...


class TabPage(Protocol):
    """One tab's panels and scene."""

    @property
    def is_moving(self) -> bool:
        """Whether something on it moves by itself."""
        ...

    def show(self, view: Any, /) -> None:
        """Show one view."""

    def advance(self) -> None:
        """Go on with what moves."""

    def pictures(self) -> Iterable[tuple[str, Job]]:
        """The pictures that are due, by name: those whose contents have changed."""
        ...

    def warn(self, text: str, /) -> None:
        """Report an error in a persistent note."""


Model = TypeVar("Model", bound=TabModel)
_FORGIVEN_S = 60.0
"""Seconds after a page was reloaded after which the next failure counts as the first."""
_PERIOD_S = 1 / 30
_ROUND_S = 0.12
"""Time budget of a round for drawing pictures, seconds; the rest wait."""


@dataclass(eq=False)
class Tab(Generic[Model]):
    """One tab, its model and its page."""

    client: viser.ClientHandle
    model: Model
    page: TabPage
    requests: queue.SimpleQueue[Any]
    language: PageLanguage
    shown: Any = None
    """None: to be drawn."""
    failed_at: float = -np.inf
    """Clock time at which its page was reloaded, seconds."""


class TabServer(Generic[Model]):
    """All tabs of one server. Closing a tab discards its page."""

    def __init__(
        self,
        server: LocalServer,
        title: str,
        model_of: Callable[[int], Model],
        make_page: Callable[[viser.ClientHandle, Ask, Any], TabPage],
        *,
        wishes: Callable[[Model], Language | None] = lambda _: None,
    ) -> None:
        """Accept visitors. The caller closes the server afterwards.

        Args:
            title: of notes to a tab without a page.
            model_of: the model for the tab of this number; called on viser's threads.
            make_page: lays out a page with this view; on viser's threads, or after a failure.
            wishes: the language that a tab's model wants meanwhile; None: its browser's.
        """
        self.server = server
        self._title, self._model_of, self._make_page = title, model_of, make_page
        server.shares_language, self._wishes = False, wishes
        self._tabs: dict[int, Tab[Model]] = {}
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._stop = threading.Event()
        self._turns = PictureTurns()
        self._failures = Failures()
        camera = server.initial_camera
        camera.near, camera.far = NEAR, FAR
        server.on_client_connect(self._enter)
        server.on_client_disconnect(self._leave)

    @property
    def tabs(self) -> tuple[Tab[Model], ...]:
        """The open tabs."""
        with self._lock:
            return tuple(self._tabs.values())

    def run(self) -> None:
        """Serve until another thread calls `close`."""
        while not self._stop.is_set():
            started = time.monotonic()
            more = self.step()
            self._stop.wait(_PERIOD_S - (time.monotonic() - started))
            # Clocks, flights and window sizes change without requests.
            self._wake.wait(timeout=0 if more else 0.1)
            self._wake.clear()

    def step(self) -> bool:
        """Serve every tab once; whether more is due at once. Raises `StorageError` if a time cannot
        be written."""
        started = time.monotonic()
        moving = [self._serve(tab) for tab in self.tabs]
        return self._draw_until(started + _ROUND_S) or any(moving)

    def close(self) -> None:
        """Accept no more requests. May be called twice."""
        self._stop.set()
        self._wake.set()
        with self._lock:
            self._tabs.clear()

    # -- on viser's threads ------------------------------------------------------------------------

    def _enter(self, client: viser.ClientHandle) -> None:
        number = client.client_id
        if number not in self.server.get_clients():  # already closed
            return
        requests: queue.SimpleQueue[Any] = queue.SimpleQueue()
        language = PageLanguage(self.server.language_of(number))
        self.server.languages[number] = language
        with language.spoken():
            try:
                model = self._model_of(number)
                page = self._make_page(client, self._asking(requests), model.last_view)
            except Exception as error:
                self._failures.tell(error, TAB_STOPPED)
                client.add_notification(self._title, texts.TAB_BROKEN, color="red")
                return
        with self._lock:
            self._tabs[number] = Tab(client, model, page, requests, language)
        # It may have closed while its page was laid out; nobody else would remove it then.
        if number not in self.server.get_clients():
            self._leave(client)
        self._wake.set()

    def _asking(self, requests: queue.SimpleQueue[Any]) -> Ask:
        def ask(request: Any) -> None:
            requests.put(request)
            self._wake.set()

        return ask

    def _leave(self, client: viser.ClientHandle) -> None:
        with self._lock:
            self._tabs.pop(client.client_id, None)
            self.server.languages.pop(client.client_id, None)
        self._turns.forget(client.client_id)

    # -- on the caller's thread --------------------------------------------------------------------

    def _serve(self, tab: Tab[Model]) -> bool:
        """Update one tab; whether something on its page still moves. An error affects only this
        tab."""
        with tab.language.spoken():
            try:
                return self._update(tab)
            except StorageError:
                raise
            except Exception as error:
                self._failed(tab, error)
                return False

    def _update(self, tab: Tab[Model]) -> bool:
        model = tab.model
        model.tick(time.monotonic())
        while not tab.requests.empty():  # the only reader, so nothing is taken in between
            model.handle(tab.requests.get())
        view = model.view()
        self._translate(tab)
        page = tab.page
        if view is not tab.shown:
            tab.shown = view
            page.show(view)
        for what, job in page.pictures():
            self._turns.ask(tab.client.client_id, what, job)
        if page.is_moving:
            page.advance()
        return page.is_moving

    def _translate(self, tab: Tab[Model]) -> None:
        """Lay the tab's page out again if its model wants another language."""
        wanted = self._wishes(tab.model) or self.server.language_of(tab.client.client_id)
        if wanted != tab.language.code:
            tab.language.code = wanted
            self._lay_out_again(tab)

    def _draw_until(self, end_s: float) -> bool:
        """Draw pictures, at least one, until this time; whether others are waiting."""
        while (turn := self._turns.take()) is not None:
            number, draw = turn
            with self._lock:
                tab = self._tabs.get(number)
            with nullcontext() if tab is None else tab.language.spoken():
                try:
                    draw()
                except Exception as error:
                    if tab is not None:
                        self._failed(tab, error)
            if time.monotonic() >= end_s:
                return True
        return False

    def _failed(self, tab: Tab[Model], error: Exception) -> None:
        """Reload one tab's page; one that fails again at once stays as it is."""
        client, now = tab.client, time.monotonic()
        if client.client_id not in self.server.get_clients():
            self._leave(client)  # drawing for a tab that has just closed may fail in any way
            return
        self._failures.tell(error, DRAWING_FAILED)
        again, tab.failed_at = now - tab.failed_at < _FORGIVEN_S, now
        try:
            if again:
                raise error
            self._lay_out_again(tab)
            tell_tab(client, error)
        except Exception as worse:
            self._failures.tell(worse, TAB_STOPPED)
            self._leave(client)
            tab.page.warn(texts.TAB_BROKEN)

    def _lay_out_again(self, tab: Tab[Model]) -> None:
        client = tab.client
        self._turns.forget(client.client_id)
        client.gui.reset()
        client.scene.reset()
        tab.page = self._make_page(client, self._asking(tab.requests), tab.model.view())
        tab.shown = None


class PictureTurns:
    """The queue of pictures to draw when there is no time for all; thread-safe. A tab's new request
    replaces its old one; the tab that has waited longest is next."""

    def __init__(self) -> None:
        """An empty queue."""
        self._wanted: dict[tuple[int, str], Job] = {}
        self._drawn: dict[tuple[int, str], int] = {}  # turn of the last picture
        self._count = count(1)
        self._lock = threading.Lock()

    def ask(self, tab: int, what: str, job: Job) -> None:
        """Queue this job for the tab."""
        with self._lock:
            self._wanted[tab, what] = job

    def forget(self, tab: int) -> None:
        """Drop the tab's requests: it has closed."""
        with self._lock:
            for of_all in (self._wanted, self._drawn):
                for key in [key for key in of_all if key[0] == tab]:
                    del of_all[key]

    def take(self) -> tuple[int, Job] | None:
        """The next tab and its job; None if the queue is empty."""
        with self._lock:
            if not self._wanted:
                return None
            key = min(self._wanted, key=lambda key: self._drawn.get(key, 0))
            self._drawn[key] = next(self._count)
            return key[0], self._wanted.pop(key)

"""The server of an exercise: every tab has its own page.

    viser's pool  lays pages out for new tabs; queues requests
    the caller's  `step`, repeatedly: requests and the clock -> each exercise -> its page;
    thread        then the pictures, in turns

Scenes and pictures share one thread on purpose: two would contend for Python's lock at each of the
hundreds of OpenGL calls per picture, and both would be slower.
"""

from __future__ import annotations

import queue
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic

import numpy as np
import viser

from venus3d.scene.pages.exercise.exercise import Exercise, View
from venus3d.scene.pages.exercise.page import ExercisePage
from venus3d.scene.pages.exercise.picture_turns import PictureTurns
from venus3d.scene.pages.exercise.texts import BROKEN, STANDS_STILL
from venus3d.scene.pages.exercise.view_model import Request
from venus3d.scene.web.drawing import Failures, tell_tab
from venus3d.scene.web.server import LocalServer
from venus3d.scene.web.texts import DRAWING_FAILED

_FORGIVEN_S = 60.0
"""Seconds after a page was reloaded after which the next failure counts as the first."""
_ROUND_S = 0.12
"""Time budget of a round for drawing pictures, seconds; the rest wait."""


@dataclass(eq=False)
class Tab(Generic[View]):
    """One tab and its exercise."""

    client: viser.ClientHandle
    exercise: Exercise[View]
    page: ExercisePage[View]
    requests: queue.SimpleQueue[Request]
    shown: View | None = field(default=None)
    """None: to be drawn."""
    failed_at: float = -np.inf
    """Clock time at which its page was reloaded, seconds."""

    def drain(self) -> list[Request]:
        """Requests since the last call, in order."""
        drained: list[Request] = []
        while not self.requests.empty():  # the only reader, so nothing is taken in between
            drained.append(self.requests.get())
        return drained


class ExerciseServer(ABC, Generic[View]):
    """All tabs of one server. Closing a tab discards its page."""

    _title: str
    """Title of notes to a tab without a page."""

    def __init__(self, server: LocalServer) -> None:
        """Nobody is accepted before `_open`; the caller closes the server afterwards."""
        self.server = server
        self._tabs: dict[int, Tab[View]] = {}
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._stop = threading.Event()
        self._turns = PictureTurns()
        self._failures = Failures()

    @property
    def tabs(self) -> tuple[Tab[View], ...]:
        """The open tabs."""
        with self._lock:
            return tuple(self._tabs.values())

    def step(self) -> bool:
        """Serve every tab once; whether more is due at once."""
        started = time.monotonic()
        moving = [self._serve(tab) for tab in self.tabs]
        return self._draw_until(started + _ROUND_S) or any(moving)

    def close(self) -> None:
        """Accept no more requests. May be called twice."""
        self._stop.set()
        self._wake.set()
        with self._lock:
            self._tabs.clear()

    # -- for subclasses ----------------------------------------------------------------------------

    @abstractmethod
    def _exercise_of(self, number: int) -> Exercise[View]:
        """The exercise for the tab of this number; on viser's threads."""

    @abstractmethod
    def _make_page(
        self,
        client: viser.ClientHandle,
        exercise: Exercise[View],
        ask: Callable[[Request], None],
    ) -> ExercisePage[View]:
        """Lay a page out; on viser's threads, or again after a failure."""

    @abstractmethod
    def _next_view(self, tab: Tab[View]) -> View | None:
        """The view this tab should show now; None if it shows it already."""

    @abstractmethod
    def _order_pictures(self, tab: Tab[View], view: View, before: View | None) -> None:
        """Queue the pictures that have changed since `before`."""

    # -- on viser's threads ------------------------------------------------------------------------

    def _open(self) -> None:
        camera = self.server.initial_camera
        camera.near, camera.far = 0.01, 50.0
        self.server.on_client_connect(self._enter)
        self.server.on_client_disconnect(self._leave)

    def _enter(self, client: viser.ClientHandle) -> None:
        number = client.client_id
        if number not in self.server.get_clients():  # already closed
            return
        requests: queue.SimpleQueue[Request] = queue.SimpleQueue()
        try:
            exercise = self._exercise_of(number)
            page = self._make_page(client, exercise, self._asking(requests))
        except Exception as error:
            self._failures.tell(error, STANDS_STILL)
            client.add_notification(self._title, BROKEN, color="red")
            return
        with self._lock:
            self._tabs[number] = Tab(client, exercise, page, requests)
        # It may have closed while its page was laid out; nobody else would remove it then.
        if number not in self.server.get_clients():
            self._leave(client)
        self._wake.set()

    def _asking(self, requests: queue.SimpleQueue[Request]) -> Callable[[Request], None]:
        def ask(request: Request) -> None:
            requests.put(request)
            self._wake.set()

        return ask

    def _leave(self, client: viser.ClientHandle) -> None:
        with self._lock:
            self._tabs.pop(client.client_id, None)
        self._turns.forget(client.client_id)

    # -- on the caller's thread --------------------------------------------------------------------

    def _serve(self, tab: Tab[View]) -> bool:
        """Update one tab; whether something on its page still moves. An error affects only this
        tab."""
        try:
            view = self._next_view(tab)
            if view is not None:
                before, tab.shown = tab.shown, view
                tab.page.show(view)
                self._order_pictures(tab, view, before)
            if tab.page.is_moving:
                tab.page.advance()
            return tab.page.is_moving
        except Exception as error:
            self._failed(tab, error)
            return False

    def _draw_until(self, end_s: float) -> bool:
        """Draw pictures, at least one, until this time; whether others are waiting."""
        while (turn := self._turns.take()) is not None:
            number, draw = turn
            try:
                draw()
            except Exception as error:
                with self._lock:
                    tab = self._tabs.get(number)
                if tab is not None:
                    self._failed(tab, error)
            if time.monotonic() >= end_s:
                return True
        return False

    def _failed(self, tab: Tab[View], error: Exception) -> None:
        """Reload one tab's page; one that fails again at once stays as it is."""
        client, now = tab.client, time.monotonic()
        if client.client_id not in self.server.get_clients():
            self._leave(client)  # drawing for a tab that has just closed may fail in any way
            return
        self._failures.tell(error, DRAWING_FAILED)
        self._turns.forget(client.client_id)
        again, tab.failed_at = now - tab.failed_at < _FORGIVEN_S, now
        try:
            if again:
                raise error
            client.gui.reset()
            client.scene.reset()
            tab.page = self._make_page(client, tab.exercise, self._asking(tab.requests))
            tab.shown = None
            tell_tab(client, error)
        except Exception as worse:
            self._failures.tell(worse, STANDS_STILL)
            self._leave(client)
            tab.page.warn(BROKEN)

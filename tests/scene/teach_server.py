"""A teaching page that is served while a test looks at it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach.learner import Learner
from venus3d.scene.pages.teach.page import TeachPage
from venus3d.scene.pages.teach.run import TeachServer
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import AnalysePose
from venus3d.scene.web.server import start_server


class ServedTeaching:
    """The server, and what its tabs show; a tab is known by when it came."""

    def __init__(self, server: TeachServer) -> None:
        self.server = server
        self.url = server.server.url
        self.port = server.server.get_port()

    def learner(self, tab: int = 0) -> Learner:
        wait_until(lambda: len(self.server.tabs) > tab, f"tab {tab}")
        return self.server.tabs[tab].model

    def page(self, tab: int = 0) -> TeachPage:
        self.learner(tab)
        page = self.server.tabs[tab].page
        assert isinstance(page, TeachPage)
        return page

    @property
    def state(self) -> TeachState:
        """What the first tab shows."""
        return self.learner().state

    def change(self, change: Callable[[TeachState], TeachState]) -> TeachState:
        """Change what the first tab shows."""
        return self.learner().change(change)


@contextmanager
def served_teaching(
    analyse: AnalysePose, offscreen: Offscreen, **options: Any
) -> Iterator[ServedTeaching]:
    """The page on a free port, with its loop in a thread of its own."""
    server, _ = start_server("127.0.0.1", free_port())
    teach = TeachServer(server, analyse, offscreen, **options)
    loop = threading.Thread(target=teach.run)
    loop.start()
    try:
        yield ServedTeaching(teach)
    finally:
        teach.close()
        loop.join(timeout=10)
        server.stop()

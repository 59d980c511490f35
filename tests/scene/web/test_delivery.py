"""What has been drawn is on its way before the next drawing begins."""

from __future__ import annotations

import threading
import time

import pytest

from tests.scene.raw_client import RawClient
from venus3d.scene.web.delivery import deliver
from venus3d.scene.web.server import LocalServer
from venus3d.scene.web.viser_private import loop_of, sockets_of


def test_a_drawing_that_begins_at_once_does_not_hold_back_the_last(server: LocalServer) -> None:
    """The thread that sends is late, as where it has no core: flushing alone fails here."""
    loop, _ = loop_of(sockets_of(server))
    with RawClient(server.get_port()) as tab:
        tab.backlog()
        with server.atomic():
            server.scene.add_frame("/drawn")
            loop.call_soon_threadsafe(time.sleep, 0.02)
        deliver(server)
        with server.atomic():
            names = [message.get("name") for message in tab.window(timeout=10)]
    assert "/drawn" in names


def test_a_browser_that_takes_nothing_does_not_stop_the_drawing(server: LocalServer) -> None:
    loop, _ = loop_of(sockets_of(server))
    stuck, again = threading.Event(), threading.Event()

    def wait() -> None:
        stuck.set()
        again.wait()

    with RawClient(server.get_port()) as tab:
        tab.backlog()
        loop.call_soon_threadsafe(wait)
        stuck.wait()
        server.scene.add_frame("/drawn")
        deliver(server)
        assert not again.is_set()  # nothing was sent, and here we are
        again.set()
        assert tab.window(timeout=10)


def test_a_page_without_a_tab_waits_for_nothing(
    server: LocalServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("venus3d.scene.web.delivery.time.sleep", pytest.fail)
    server.scene.add_frame("/drawn")
    deliver(server)

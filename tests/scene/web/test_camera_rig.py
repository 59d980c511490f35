"""The scene cameras of a page's tabs, asked of a connection by hand.

A browser that is still setting up its scene drops or changes the first view: on a phone, with the
page from the browser's cache, viser's usual view stayed.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.server import LocalServer, start_server

EYE, AT = np.array([-0.5, -0.6, -0.7]), np.array([0.0, 0.0, 0.3])
USUAL: dict[str, Any] = {"position": (3.0, 3.0, 3.0), "look_at": (0.0, 0.0, 0.0)}


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[LocalServer]:
    """A page whose rig has a view, and whose loop turns the cameras when that is due. A view is
    sent again after 0.05, 0.15, 0.35, 0.75 and 1.55 s."""
    monkeypatch.setattr("venus3d.scene.web.camera_rig._FIRST_RESENT_S", 0.05)
    server, _ = start_server("127.0.0.1", free_port())
    rig, stop = CameraRig(server), threading.Event()
    rig.go(lambda aspect: SceneCamera(EYE, AT, 0.7), at_once=True)

    def loop() -> None:
        while not stop.wait(0.02):
            if rig.is_due:
                rig.advance()

    thread = threading.Thread(target=loop, daemon=True)
    thread.start()
    yield server
    stop.set()
    thread.join()
    server.stop()


def sent(client: RawClient, seconds: float) -> list[tuple[float, ...]]:
    """The positions that the tab's camera was sent within this time."""
    end = time.monotonic() + seconds
    got: list[tuple[float, ...]] = []
    while (left := end - time.monotonic()) > 0:
        try:
            window = client.window(timeout=left)
        except TimeoutError:
            break
        got += [m["position"] for m in window if m["type"] == "SetCameraPositionMessage"]
    return got


def test_a_view_is_sent_again_until_the_browser_shows_it(server: LocalServer) -> None:
    with RawClient(server.get_port()) as client:
        client.backlog()
        client.look(**USUAL)
        first = sent(client, 0.25)
        assert len(first) in (2, 3) and np.allclose(first, EYE), "dropped, and nothing came back"
        client.look(**USUAL)  # changed again
        assert len(sent(client, 0.3)) in (1, 2)
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        assert sent(client, 1.3) == []


def test_a_browser_that_never_answers_is_left_alone_in_the_end(server: LocalServer) -> None:
    with RawClient(server.get_port()) as client:
        client.backlog()
        client.look(**USUAL)
        assert len(sent(client, 2.2)) == 6


def test_a_person_who_turns_an_unconfirmed_view_is_left_alone(server: LocalServer) -> None:
    with RawClient(server.get_port()) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, 0.1)
        for step in range(3):
            client.look(position=(3.0, 2.9 - 0.1 * step, 3.0), look_at=(0.0, 0.0, 0.0))
        sent(client, 0.1)
        assert sent(client, 1.5) == []

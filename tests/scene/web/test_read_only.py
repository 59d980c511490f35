"""What servers hear of a browser: ours what a person could do, one for those who only look nothing.

A page without inputs is not enough: any program on the network can open the websocket and send
what it likes. So one does here, all there is, at viser's own server, which obeys, and at ours.
"""

from __future__ import annotations

import contextlib
import time
from typing import Any

import numpy as np
import pytest
import viser

from tests.ports import free_port
from tests.scene.raw_client import RawClient, every_message
from tests.waiting import wait_until
from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.server import LocalServer, ReadOnlyServer, start_read_only_server


def with_everything_that_listens(server: viser.ViserServer) -> list[str]:
    """Give the server one of each thing that can be acted on; returns who has heard something."""
    heard: list[str] = []

    def hears(name: str) -> Any:
        return lambda *_: heard.append(name)

    gui, scene = server.gui, server.scene
    gui.add_checkbox("box", False).on_update(hears("box"))
    gui.add_button("button").on_click(hears("button"))
    gui.add_button("held").on_hold(hears("held"))
    gui.add_upload_button("upload").on_upload(hears("upload"))
    with gui.add_form("form") as form:
        gui.add_text("text", "")
    form.on_submit(hears("form"))
    gui.add_command("command").on_trigger(hears("command"))
    gizmo = scene.add_transform_controls("/gizmo")
    gizmo.on_update(hears("gizmo"))
    box = scene.add_box("/box")
    box.on_click(hears("click"))
    box.on_drag("left")(hears("drag"))
    scene.on_click()(hears("pointer"))
    return heard


def say_everything(port: int, clients: Any, operator: int = 0) -> None:
    """Send all there is, and wait until the server has taken it all in.

    Several tabs say it, each of some of the things: of one it takes 200 messages a second.
    """
    backlog = list[dict[str, Any]]()
    if operator:
        with RawClient(operator) as spy:
            backlog += spy.backlog()
    with contextlib.ExitStack() as stack:
        tabs = [stack.enter_context(RawClient(port)) for _ in range(16 if operator else 1)]
        for tab in tabs:
            shown = tab.backlog()
        backlog += shown
        uuids = sorted({m["uuid"] for m in backlog if "uuid" in m})
        names = sorted({m["name"] for m in backlog if "name" in m})
        assert uuids and names
        for number, tab in enumerate(tabs):
            tab.look()
            share = slice(number, None, len(tabs))
            for message in every_message(uuids[share], names[share]):
                tab.send(message)
            # Messages are taken in order: once this one is known, so are all before it.
            tab.look(width=4321)
        wait_until(
            lambda: [c.camera.image_width for c in clients().values()].count(4321) == len(tabs)
        )


def drain(client: RawClient) -> None:
    """Take what is on its way."""
    with contextlib.suppress(TimeoutError):
        while True:
            client.window(timeout=0.5)


def buffer_of(server: Any) -> dict[int, str]:
    """What every browser is shown, message by message."""
    buffer = server._websock_server._broadcast_buffer
    return {key: repr(message) for key, message in dict(buffer.message_from_id).items()}


class ObedientServer(viser.ViserServer):
    """viser's own, which would only ask a public host for a tunnel as well."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        return None


@pytest.mark.parametrize(
    ("make", "kinds"),
    [
        # The other tests would hold nothing down if these messages reached nobody anywhere.
        (ObedientServer, "box button held upload form command gizmo click drag pointer"),
        # No page of ours has buttons that are held, uploads or forms.
        (LocalServer, "box button command gizmo click drag pointer"),
        (ReadOnlyServer, ""),
    ],
)
def test_which_messages_reach_a_callback(make: type[viser.ViserServer], kinds: str) -> None:
    server = make("127.0.0.1", free_port(), verbose=False)
    try:
        heard = with_everything_that_listens(server)
        say_everything(server.get_port(), server.get_clients)
        server._thread_executor.shutdown(wait=True)
        assert set(heard) == set(kinds.split())
    finally:
        server.stop()


def test_a_read_only_server_hears_nothing_whatever_is_on_it() -> None:
    server = start_read_only_server("127.0.0.1", free_port())
    try:
        heard = with_everything_that_listens(server)
        with RawClient(server.get_port()) as other:
            other.backlog()
            before = buffer_of(server)
            say_everything(server.get_port(), server.get_clients)
            server._thread_executor.shutdown(wait=True)
            assert heard == []
            assert buffer_of(server) == before
            with pytest.raises(TimeoutError):
                other.window(timeout=0.3)
        assert server._share_tunnel is None
    finally:
        server.stop()


def test_the_second_monitor_hears_nothing_and_the_operator_is_not_disturbed() -> None:
    """All of it at a real audience page beside a real operator's page."""
    viewer = Viewer(port=free_port(), draggable_board=True)
    audience = Audience("127.0.0.1", free_port(), AudienceState(mirror=False))
    try:
        AudienceControls(viewer.server, audience)
        with RawClient(audience.port) as other, RawClient(viewer.port) as operator:
            other.backlog(), operator.backlog()
            # Once the first sentence stands, nothing moves any more.
            wait_until(lambda: texts.STARTING[2] in str(buffer_of(audience.server)))
            drain(other), drain(operator)
            before = buffer_of(audience.server), buffer_of(viewer.server)
            # With the names of the operator's entities, too: nobody says that they are secret.
            say_everything(audience.port, audience.server.get_clients, operator=viewer.port)
            assert (buffer_of(audience.server), buffer_of(viewer.server)) == before
            assert viewer.drain_intents() == [] and audience.state == AudienceState(mirror=False)
            for client in (other, operator):
                with pytest.raises(TimeoutError):
                    client.window(timeout=0.3)
    finally:
        audience.close()
        viewer.close()


NONSENSE: tuple[dict[str, Any], ...] = (
    {"position": ("a", "b", "c")},
    {"position": ("nan", "0", "1e300")},
    {"up_direction": ("nan", "0", "1")},
    {"image_width": "1" * 310},
    {"position": (1, 2)},
    {"position": (float("nan"), 0, 0)},
    {"look_at": (1e300, 0, 0)},
    {"position": (0, 0, 0), "look_at": (0, 0, 0)},
    {"up_direction": (0, 0, 0)},
    {"wxyz": (0, 0, 0, 0)},
    {"fov": None},
    {"image_width": -5},
    {"image_height": 0},
)


def test_a_browser_that_says_nonsense_stops_nobody() -> None:
    """Where it looks from is computed with: a string or a zero there must not end the program."""
    audience = Audience("127.0.0.1", free_port())
    failures: list[str] = []
    audience.on_failure = failures.append
    try:
        talkers = [RawClient(audience.port) for _ in NONSENSE]
        for talker, said in zip(talkers, NONSENSE, strict=True):
            talker.backlog()
            talker.look(position=(1, 1, 1))  # astray: it is to be put back
            talker.look(**{"position": (1, 1, 1)} | said)
        for _ in range(40):  # it has half a second and more to break something
            audience.pause(True)
            time.sleep(0.02)
        for talker in talkers:
            talker.close()
        with RawClient(audience.port) as client:
            wait_until(lambda: texts.PAUSED[2] in str(buffer_of(audience.server)))
            assert client.backlog()
        assert failures == []
    finally:
        audience.close()


def test_pictures_do_not_queue_up_for_a_browser_that_is_slow() -> None:
    """Megabytes on their way would show it the past: it must skip pictures instead."""
    server = start_read_only_server("127.0.0.1", free_port())
    noise = np.random.default_rng(1).integers(0, 255, (270, 480, 3), np.uint8)
    picture = server.scene.add_image("/picture", noise, 1, 1, jpeg_quality=80)
    count = 120
    try:
        with (
            RawClient(server.get_port()) as quick,
            RawClient(server.get_port(), holds_bytes=65536) as slow,
        ):
            quick.backlog(), slow.backlog()
            for number in range(1, count + 1):
                picture.image = np.roll(noise, number, axis=0)
                server.flush()
                while not pictures(quick.window(timeout=20)):  # it was sent
                    pass
            late = 0  # what was on its way when it began to read
            with contextlib.suppress(TimeoutError):
                while True:
                    late += pictures(slow.window(timeout=1.0))
        assert 1 <= late <= count / 8
    finally:
        server.stop()


def pictures(messages: list[dict[str, Any]]) -> int:
    return sum("_data" in message.get("updates", {}) for message in messages)

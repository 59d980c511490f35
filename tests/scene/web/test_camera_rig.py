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
import viser

from tests.ports import free_port
from tests.scene.raw_client import RawClient
from tests.waiting import PATIENCE_S, wait_until
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.server import start_server

EYE, AT = np.array([-0.5, -0.6, -0.7]), np.array([0.0, 0.0, 0.3])
USUAL: dict[str, Any] = {"position": (3.0, 3.0, 3.0), "look_at": (0.0, 0.0, 0.0)}


@pytest.fixture
def rig() -> Iterator[CameraRig]:
    """A page whose rig has a view, and whose loop turns the cameras when that is due. A view is
    sent again after 0.25, 0.75, 1.75, 3.75 and 7.75 s; where the machine stalls that long, viser
    joins what waits into one."""
    server, _ = start_server("127.0.0.1", free_port())
    rig, stop = CameraRig(server), threading.Event()
    rig.go(lambda _: SceneCamera(EYE, AT, 0.7), at_once=True)

    def loop() -> None:
        while not stop.wait(0.02):
            if rig.is_due:
                rig.advance()

    thread = threading.Thread(target=loop, daemon=True)
    thread.start()
    yield rig
    stop.set()
    thread.join()
    server.stop()


def viser_of(rig: CameraRig) -> viser.ViserServer:
    assert isinstance(rig.host, viser.ViserServer)
    return rig.host


def port_of(rig: CameraRig) -> int:
    return viser_of(rig).get_port()


def sent(client: RawClient, seconds: float, count: int = 1000) -> list[tuple[float, ...]]:
    """The positions that the tab's camera was sent within this time, or the first so many."""
    end = time.monotonic() + seconds
    got: list[tuple[float, ...]] = []
    while len(got) < count and (left := end - time.monotonic()) > 0:
        try:
            window = client.window(timeout=left)
        except TimeoutError:
            break
        messages = [m for m in window if m["type"] == "SetCameraPositionMessage"]
        got += [m["position"] for m in messages if not m["initial"]]
    return got


def stays(client: RawClient, seconds: float) -> bool:
    """Whether no position comes for this time, apart from what was on its way."""
    sent(client, 0.6)
    return sent(client, seconds) == []


def test_a_view_is_sent_again_until_the_browser_shows_it(rig: CameraRig) -> None:
    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        first = sent(client, PATIENCE_S, 2)
        assert len(first) == 2 and np.allclose(first, EYE), "dropped, and nothing came back"
        client.look(**USUAL)  # changed again
        assert sent(client, PATIENCE_S, 1)
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        assert stays(client, 1.7)
        rig.go(lambda _: SceneCamera(2 * EYE, AT, 0.7), at_once=True)
        assert np.allclose(sent(client, PATIENCE_S, 3), 2 * EYE), "a later one as well"


@pytest.mark.parametrize("calm", [False, True])
def test_who_wants_less_motion_is_not_flown_through_the_room(rig: CameraRig, calm: bool) -> None:
    with RawClient(port_of(rig), cookie=f"venus3d-reduced-motion={calm:d}") as client:
        client.backlog()
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        stays(client, 0.1)
        rig.go(lambda _: SceneCamera(2 * EYE, AT, 0.7))
        first, *_ = sent(client, PATIENCE_S, 1)
        assert np.allclose(first, 2 * EYE) == calm


def test_a_browser_that_never_answers_is_left_alone_in_the_end(
    rig: CameraRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("venus3d.scene.web.camera_rig._FIRST_RESENT_S", 0.05)
    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)
        wait_until(lambda: not rig.is_due and rig.arrived)
        assert len(sent(client, 1.0)) <= 5
        assert sent(client, 1.0) == []
        client.look(**USUAL)  # it was only slow, and shows another view
        assert np.allclose(sent(client, PATIENCE_S, 1), EYE)
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        assert stays(client, 1.7)


def test_a_person_who_turns_an_unconfirmed_view_is_left_alone(rig: CameraRig) -> None:
    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)
        for step in range(3):
            client.look(position=(3.0, 2.9 - 0.1 * step, 3.0), look_at=(0.0, 0.0, 0.0))
        assert stays(client, 1.7)


def test_a_browser_that_applies_eye_and_target_one_by_one_is_no_person(rig: CameraRig) -> None:
    """Half a view was taken for a turn, and the page kept it: the board was out of sight."""
    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)
        client.look(position=USUAL["position"], look_at=AT.tolist())
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        sent(client, 0.3)
        rig.refit(lambda _: SceneCamera(2 * EYE, AT, 0.7))
        assert sent(client, PATIENCE_S, 1)


def test_a_browser_that_does_not_know_yet_what_is_up_is_no_person(rig: CameraRig) -> None:
    """Seen in Chromium: the page said at its opening that the view stays as it was turned."""

    def look_before_up(share: float) -> None:
        (x, y, z), (at_x, at_y, at_z) = (share * EYE).tolist(), AT.tolist()
        client.look(position=(x, -z, y), look_at=(at_x, -at_z, at_y))

    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)
        look_before_up(1.0)
        rig.refit(lambda _: SceneCamera(1.1 * EYE, AT, 0.7), at_once=True)
        sent(client, 0.2)
        look_before_up(1.1)
        sent(client, 0.3)
        rig.refit(lambda _: SceneCamera(2 * EYE, AT, 0.7), at_once=True)
        assert sent(client, PATIENCE_S, 1)


def test_a_browser_that_is_seconds_late_is_no_person(
    rig: CameraRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a busy machine the echo of a flight came after it was forgotten, and the page said that
    the view stays as it was turned."""
    monkeypatch.setattr("venus3d.scene.web.camera_rig._ECHO_S", 0.0)
    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        sent(client, 0.3)
        rig.refit(lambda _: SceneCamera(1.5 * EYE, AT, 0.7))
        places = sent(client, 1.2)
        client.look(position=places[len(places) // 2], look_at=AT.tolist())
        sent(client, 0.3)
        rig.refit(lambda _: SceneCamera(2 * EYE, AT, 0.7))
        assert sent(client, PATIENCE_S, 1)


def test_one_strange_view_in_a_flight_is_no_person_and_two_are(rig: CameraRig) -> None:
    """A busy browser reported a view of its own making: the flight ended there, with nothing of
    what had been asked for in the window."""
    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)
        client.look(position=EYE.tolist(), look_at=AT.tolist())
        sent(client, 0.3)
        for eye, strange in ((1.5 * EYE, 1), (EYE, 2)):
            rig.refit(lambda _, eye=eye: SceneCamera(eye, AT, 0.7))
            assert sent(client, PATIENCE_S, 3)
            for count in range(strange):
                aside = np.array([0.1 + 0.05 * count, 0.0, 0.0])
                client.look(position=(1.2 * EYE + aside).tolist(), look_at=AT.tolist())
            places = sent(client, 1.5)
            assert any(np.allclose(place, eye) for place in places) == (strange == 1)
            client.look(position=eye.tolist(), look_at=AT.tolist())


def test_a_view_that_a_person_has_turned_stays_until_it_is_fitted_again(rig: CameraRig) -> None:
    def framing(aspect: float) -> SceneCamera:
        return SceneCamera(EYE * aspect, AT, 0.7)

    goal, reset_view = framing(1280 / 720), framing(1.0)

    def arrives() -> bool:
        """Whether the flight ends at the page's view within a while."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            if any(np.allclose(place, goal.position) for place in sent(client, PATIENCE_S, 1)):
                return True
        return False

    with RawClient(port_of(rig)) as client:
        client.backlog()
        client.look(**USUAL)
        assert sent(client, PATIENCE_S, 1)

        def turn(view: SceneCamera) -> None:
            for share in (0.0, 0.05, 0.1):  # across the flight, whose places are known
                aside = share * np.array([1.0, -1.0, 0.0])
                client.look(position=(view.position + aside).tolist(), look_at=AT.tolist())

        turn(SceneCamera(EYE, AT, 0.7))
        assert stays(client, 0.1)
        rig.refit(framing)
        assert sent(client, 0.8) == [], "not against a view that the person has turned"
        rig.fit(next(iter(viser_of(rig).get_clients().values())))
        assert arrives(), "on the key"
        turn(goal)
        assert stays(client, 0.1)
        client.look(position=reset_view.position.tolist(), look_at=AT.tolist())
        assert arrives(), "by viser's Reset View"

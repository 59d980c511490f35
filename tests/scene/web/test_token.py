"""Who enters a page that other machines can reach: whoever has its token, by the address or by the
cookie that the address gives."""

from __future__ import annotations

import http.client
import threading
from collections.abc import Iterator
from urllib.parse import urlsplit

import cv2
import numpy as np
import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from tests.ports import free_port
from venus3d.scene.web import page, qr_code
from venus3d.scene.web.page import announce_page
from venus3d.scene.web.server import (
    LocalServer,
    serve_anew,
    start_read_only_server,
    start_server,
)


@pytest.fixture(scope="module", params=["page", "second page"])
def server(request: pytest.FixtureRequest) -> Iterator[LocalServer]:
    if request.param == "page":
        server, _ = start_server("0.0.0.0", free_port())
    else:
        server = start_read_only_server("0.0.0.0", free_port(), asks_token=True)
    yield server
    server.stop()


def asked(server: LocalServer, path: str, **headers: str) -> http.client.HTTPResponse:
    line = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=20)
    line.request("GET", path, headers=headers)
    answer = line.getresponse()
    answer.read()
    line.close()
    return answer


def is_let_in(server: LocalServer, path: str = "/", **headers: str) -> bool:
    """Whether the websocket opens."""
    try:
        with connect(
            f"ws://127.0.0.1:{server.get_port()}{path}",
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            additional_headers=headers,
            compression=None,
            max_size=None,
        ):
            return True
    except InvalidStatus as refused:
        assert refused.response.status_code == 403
        return False


def test_the_printed_address_gives_a_cookie_and_is_left(server: LocalServer) -> None:
    printed = urlsplit(server.outside_url)
    answer = asked(server, f"{printed.path}?{printed.query}")
    assert answer.status == 303 and answer.headers["Location"] == "/"
    cookie, *attributes = answer.headers["Set-Cookie"].split("; ")
    assert {"httponly", "samesite=lax", "path=/"} <= set(attributes)
    # Other programs of this machine have cookies too, some of them in no cookie's form.
    for jar in (cookie, f'a=1; b={{"c": 2}}; {cookie}', f"{cookie};d"):
        assert asked(server, "/", Cookie=jar).status == 200
        assert is_let_in(server, Cookie=jar)
    assert asked(server, "/").status == 403


def test_a_program_shows_the_token_in_the_address(server: LocalServer) -> None:
    assert is_let_in(server, f"/?{urlsplit(server.url).query}")


@pytest.mark.parametrize(
    "query",
    ["", "token=", "token=x", "token=%C3%A9%00", "token={0}x", "token={0}&token={0}", "{0}"],
)
def test_nobody_enters_without_it(server: LocalServer, query: str) -> None:
    assert server.token is not None
    secret = server.token.secret
    for path in ("/", "/assets/index.js"):
        assert asked(server, f"{path}?{query.format(secret)}").status == 403
    assert not is_let_in(server, f"/?{query.format(secret)}")
    for cookie in ("", secret, f"venus3d-{server.get_port()}={secret[:-1]}", f"venus3d-1={secret}"):
        assert asked(server, "/", Cookie=cookie).status == 403
        assert not is_let_in(server, Cookie=cookie)
    assert server.get_clients() == {}


def test_with_the_token_another_page_does_not_connect_either(server: LocalServer) -> None:
    query = urlsplit(server.url).query
    assert not is_let_in(server, f"/?{query}", Origin="http://example.org")
    assert not is_let_in(server, f"/?{query}", Host="rebound.example.org")


def test_each_server_has_its_own_and_a_page_that_is_drawn_anew_keeps_it() -> None:
    one, _ = start_server("0.0.0.0", free_port())
    other, _ = start_server("0.0.0.0", free_port())
    try:
        assert one.token is not None and other.token is not None
        assert one.token.secret != other.token.secret and len(one.token.secret) >= 22
        address = one.url
        one = serve_anew(one, threading.Event())
        assert one.url == address and not is_let_in(one)
    finally:
        one.stop()
        other.stop()


def test_on_this_machine_and_where_it_is_not_wanted_there_is_none() -> None:
    here, _ = start_server("127.0.0.1", free_port())
    class_page, _ = start_server("0.0.0.0", free_port(), asks_token=False)
    try:
        assert here.token is None and here.outside_url == ""
        assert class_page.token is None and "token" not in class_page.outside_url
        assert is_let_in(here) and is_let_in(class_page)
        answer = asked(here, "/")
        assert answer.headers["X-Frame-Options"] == "DENY"  # no page lays itself over ours
    finally:
        here.stop()
        class_page.stop()


def test_the_terminal_shows_an_address_that_a_phone_can_read(
    server: LocalServer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """OpenCV photographs the code; a file gets none."""
    announce_page("Page", server)
    plain = capsys.readouterr().out
    assert server.outside_url in plain and server.url in plain and "█" not in plain
    assert urlsplit(server.outside_url).hostname not in ("0.0.0.0", "", None)
    monkeypatch.setattr(page, "qr_code_if_seen", qr_code.qr_code)
    announce_page("Page", server)
    code = [line for line in capsys.readouterr().out.splitlines() if "█" in line or "▀" in line]
    halves = {"█": (1, 1), "▀": (1, 0), "▄": (0, 1), " ": (0, 0)}
    cells = np.array([[halves[c] for c in line] for line in code])
    picture = np.moveaxis(cells, 2, 1).reshape(-1, cells.shape[1])
    large = np.kron(picture * 255, np.ones((8, 8))).astype(np.uint8)  # on a dark terminal
    large = cv2.copyMakeBorder(large, 40, 40, 40, 40, cv2.BORDER_CONSTANT, value=(255,))
    # Of OpenCV's two readers the one that read 3,000 of 3,000 random tokens; the other 299 of 300.
    assert cv2.QRCodeDetectorAruco().detectAndDecode(large)[0] == server.outside_url

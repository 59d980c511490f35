"""Who may connect: a server of ours, asked as browsers and other pages would ask."""

from __future__ import annotations

import http.client
import socket
from collections.abc import Iterator

import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from tests.ports import free_port
from venus3d.scene.web.server import LocalServer, start_read_only_server, start_server


@pytest.fixture(scope="module", params=["page", "second page"])
def server(request: pytest.FixtureRequest) -> Iterator[LocalServer]:
    """One for this machine only."""
    port = free_port()
    if request.param == "page":
        server, _ = start_server("127.0.0.1", port)
    else:
        server = start_read_only_server("127.0.0.1", port)
    yield server
    server.stop()


@pytest.fixture(scope="module")
def open_server() -> Iterator[LocalServer]:
    """One for the whole network, without a token, as a class has it."""
    server, _ = start_server("0.0.0.0", free_port(), asks_token=False)
    yield server
    server.stop()


def is_let_in(port: int, headers: dict[str, str]) -> bool:
    """Whether the websocket opens with these headers; {port} in them is the port."""
    said = {name: text.format(port=port) for name, text in headers.items()}
    host = said.pop("Host", f"127.0.0.1:{port}")
    line = socket.create_connection(("127.0.0.1", port))
    try:
        # The name in the address is what is sent as Host; the line is open already.
        with connect(
            f"ws://{host}",
            sock=line,
            subprotocols=[Subprotocol(f"viser-v{viser.__version__}")],
            additional_headers=said,
            compression=None,
            max_size=None,
        ):
            return True
    except InvalidStatus as refused:
        assert refused.response.status_code == 403
        assert b"address that the program printed" in (refused.response.body or b"")
        return False


OWN = [
    {},
    {"Origin": "http://127.0.0.1:{port}"},
    {"Host": "localhost:{port}", "Origin": "http://localhost:{port}"},
    {"Host": "LOCALHOST:{port}", "Origin": "http://localhost:{port}"},
    # Another port of one's own that leads here, as `ssh -L 9000:localhost:8080` makes it.
    {"Host": "localhost:9000", "Origin": "http://localhost:9000"},
    {"Host": "localhost", "Origin": "https://localhost:443"},
]
FOREIGN = [
    {"Origin": "http://example.org"},
    {"Origin": "https://127.0.0.1.example.org:{port}"},
    {"Origin": "http://127.0.0.1:{port}.example.org"},
    {"Origin": "http://localhost:{port}"},
    {"Origin": "http://127.0.0.1:3000"},
    {"Origin": "null"},
    {"Origin": "file://"},
    {"Origin": ""},
    {"Origin": "http://127.0.0.1:99999999"},
    # A name that was rebound to this machine: page and request agree with each other.
    {"Host": "rebound.example.org:{port}", "Origin": "http://rebound.example.org:{port}"},
    {"Host": "rebound.example.org:{port}"},
    {"Host": "192.0.2.7:{port}", "Origin": "http://192.0.2.7:{port}"},
]


@pytest.mark.parametrize("headers", OWN, ids=str)
def test_our_own_page_connects(server: LocalServer, headers: dict[str, str]) -> None:
    assert is_let_in(server.get_port(), headers)


@pytest.mark.parametrize("headers", FOREIGN, ids=str)
def test_a_foreign_page_does_not_connect(server: LocalServer, headers: dict[str, str]) -> None:
    assert not is_let_in(server.get_port(), headers)
    assert server.get_clients() == {}


@pytest.mark.parametrize(
    ("host", "let_in"),
    [
        ("192.0.2.7", True),
        ("[2001:db8::7]", True),
        (socket.gethostname(), True),
        ("rebound.example.org", False),
        ("192.0.2.7.example.org", False),
    ],
)
def test_in_a_network_addresses_and_this_machines_name_count(
    open_server: LocalServer, host: str, let_in: bool
) -> None:
    """An address can't be rebound to another machine, a name can."""
    headers = {"Host": f"{host}:{{port}}", "Origin": f"http://{host}:{{port}}"}
    assert is_let_in(open_server.get_port(), headers) == let_in
    assert not is_let_in(open_server.get_port(), {**headers, "Origin": "http://example.org"})


def test_the_page_under_a_foreign_name_is_a_sentence(server: LocalServer) -> None:
    line = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=20)
    line.request("GET", "/", headers={"Host": "rebound.example.org"})
    answer = line.getresponse()
    assert answer.status == 403 and b"open it by the address" in answer.read()
    line.request("GET", "/")
    page = line.getresponse()
    assert page.status == 200 and b"<html" in page.read()

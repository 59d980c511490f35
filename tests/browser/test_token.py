"""The doors in a real browser: the token of the printed address, and a page from elsewhere."""

from __future__ import annotations

from typing import Any
from urllib.parse import urlsplit

import pytest
import viser

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.scene.web.server import start_server

pytestmark = [pytest.mark.browser]

_STRANGER = """([address, protocol]) => new Promise(done => {
  const socket = new WebSocket(address, [protocol]);
  socket.onopen = () => done("open");
  socket.onerror = () => done("refused");
})"""


def test_only_the_printed_address_opens_the_page_and_it_stays_open(chromium: Any) -> None:
    server, _ = start_server("0.0.0.0", free_port())
    server.gui.add_markdown("Only for who was invited")
    bare = f"http://127.0.0.1:{server.get_port()}/"
    invited, stranger = chromium.new_context(), chromium.new_context()
    try:
        outside = stranger.new_page()
        answer = outside.goto(bare)
        assert answer.status == 403 and "token" in outside.inner_text("body")
        address = urlsplit(server.url)
        page = invited.new_page()
        page.set_default_timeout(60_000)
        page.goto(f"{bare}?{address.query}")
        page.wait_for_selector("text=Only for who was invited")
        assert page.url == bare, "the token is no longer in the address, which others may see"
        page.goto(bare)
        page.wait_for_selector("text=Only for who was invited")
        wait_until(lambda: len(server.get_clients()) == 1)

        # A page from elsewhere in the invited browser: its cookie goes along, its origin is told.
        elsewhere, _ = start_server("127.0.0.1", free_port())
        other = invited.new_page()
        other.goto(f"http://127.0.0.1:{elsewhere.get_port()}/")
        socket = f"ws://127.0.0.1:{server.get_port()}/"
        protocol = f"viser-v{viser.__version__}"
        assert other.evaluate(_STRANGER, [socket, protocol]) == "refused"
        assert page.evaluate(_STRANGER, [socket, protocol]) == "open", "what is refused is the page"
        elsewhere.stop()
    finally:
        invited.close()
        stranger.close()
        server.stop()

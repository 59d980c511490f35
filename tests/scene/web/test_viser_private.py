"""What is private in viser is still there, and a page says so loudly if it is not."""

from __future__ import annotations

from typing import Any

import pytest

from tests.ports import free_port
from venus3d.scene.web import server as module
from venus3d.scene.web import viser_private
from venus3d.scene.web.server import start_server


def test_viser_has_all_that_is_used_of_it() -> None:
    server, _ = start_server("127.0.0.1", free_port())
    try:
        assert viser_private.missing(server) == ()
        sockets = viser_private.sockets_of(server)
        loop, thread = viser_private.loop_of(sockets)
        assert loop.is_running() and thread > 0
    finally:
        server.stop()


def test_a_name_that_has_gone_is_told_and_no_page_is_served(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """An open page would be worse than none."""
    names: Any = ("_renamed_by_viser",)
    monkeypatch.setattr(viser_private, "_MESSAGES", names)
    assert module.missing is viser_private.missing
    with pytest.raises(RuntimeError, match="_renamed_by_viser"):
        start_server("127.0.0.1", free_port())

"""A server without a page, for what all pages are made of."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.ports import free_port
from venus3d.scene.web.server import LocalServer, start_server


@pytest.fixture
def server() -> Iterator[LocalServer]:
    """A server of its own."""
    server, _ = start_server("127.0.0.1", free_port())
    yield server
    server.stop()

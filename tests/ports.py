"""Ports for tests: asked of the system, so that two runs never meet."""

from __future__ import annotations

import socket


def free_port() -> int:
    """A port of this machine that nobody uses."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])

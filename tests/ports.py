"""Ports for tests. No two test processes on this machine get the same one, nor one process twice.

A process holds a block of ports by listening on the block's first. The blocks lie below the ports
that systems give to outgoing connections, so nothing but another server can take one meanwhile.
"""

from __future__ import annotations

import errno
import random
import socket
import threading
from collections.abc import Iterator

_FIRST, _END, _BLOCK = 10_000, 32_000, 50
_held: list[socket.socket] = []
"""Open for as long as the process lives: whoever finds one taken goes on to another block."""


def _bound(port: int) -> socket.socket | None:
    """A listening socket, None where the port is taken."""
    listener = socket.socket()
    try:
        listener.bind(("127.0.0.1", port))
        listener.listen()
    except OSError as error:
        listener.close()
        if error.errno not in (errno.EADDRINUSE, errno.EACCES):
            raise
        return None
    return listener


def _ports() -> Iterator[int]:
    blocks = list(range(_FIRST, _END, _BLOCK))
    random.SystemRandom().shuffle(blocks)
    for first in blocks:
        holder = _bound(first)
        if holder is None:
            continue
        _held.append(holder)
        for port in range(first + 1, first + _BLOCK):
            if (listener := _bound(port)) is not None:
                listener.close()
                yield port


_free = _ports()
_one_at_a_time = threading.Lock()


def free_port() -> int:
    """A port of this machine that nobody uses, and that no other test is given."""
    with _one_at_a_time:
        return next(_free)

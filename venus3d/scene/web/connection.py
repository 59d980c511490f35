"""One browser's connection: what it may say, how fast, and how many there may be."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from typing import Any

from websockets.asyncio.server import ServerConnection
from websockets.frames import Frame, Opcode

LARGEST_MESSAGE_BYTES = 16384
"""Limit for a browser's message. viser allows 50 MB, for uploads and screenshots, unused here."""
_MOST_CONNECTIONS = 400
"""Of one server, so that files can still be opened: Linux gives a program 1024 of both."""
_EACH_PER_S, _ALL_PER_S = 200.0, 4000.0
"""Messages that one browser, and all together, may send; a busy one sends about 100 a second."""
_AT_ONCE = 400.0
"""Messages that one browser may send in a moment."""
_MOST_CONTROLS_PER_S = 20.0
"""Pings and pongs of one browser, which only answers ours; each ping is answered at once, into a
buffer that grows if the sender reads nothing."""
_MOST_PARTS = 64
"""Of one message: empty ones have no size that would be limited."""


class Connections:
    """All connections of one server, counted."""

    def __init__(self, hears: Callable[[bytes, int], bool]) -> None:
        """`hears` tells whether the page accepts a message of this client."""
        self.hears = hears
        self.open: set[Connection] = set()

    @property
    def rate(self) -> float:
        """Messages a second that each may send now."""
        return min(_EACH_PER_S, _ALL_PER_S / max(1, len(self.open)))


class Connection(ServerConnection):
    """A browser's connection that drops messages which the page does not accept, and does not read
    on while there are too many: they wait at the sender's end, and none is lost."""

    client_id = -1
    """viser's number of this client."""

    def __init__(self, all_of_them: Connections, *given: Any, **more: Any) -> None:
        super().__init__(*given, **more)
        self._all = all_of_them
        self._left, self._counted_at = _AT_ONCE, time.monotonic()
        self._controls, self._since = 0, self._counted_at
        self._parts = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self._all.open.add(self)
        if len(self._all.open) > _MOST_CONNECTIONS:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        self._all.open.discard(self)
        super().connection_lost(exc)

    def process_event(self, event: Any) -> None:
        if isinstance(event, Frame) and self._floods(event.opcode):
            self.transport.abort()
            return
        super().process_event(event)

    def _floods(self, kind: Opcode) -> bool:
        if kind in (Opcode.PING, Opcode.PONG):
            self._controls += 1
            seconds = time.monotonic() - self._since
            return self._controls > _MOST_CONTROLS_PER_S * max(5.0, seconds)
        self._parts = self._parts + 1 if kind is Opcode.CONT else 0
        return self._parts > _MOST_PARTS

    async def recv(self, decode: bool | None = None) -> Any:
        while True:
            raw = await super().recv(decode)
            await self._not_too_fast()
            if isinstance(raw, bytes) and self._all.hears(raw, self.client_id):
                return raw

    async def _not_too_fast(self) -> None:
        now, rate = time.monotonic(), self._all.rate
        self._left = min(_AT_ONCE, self._left + (now - self._counted_at) * rate) - 1
        self._counted_at = now
        if self._left < 0:
            await asyncio.sleep(-self._left / rate)

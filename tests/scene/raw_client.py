"""A browser's place at a viser server, by hand: speaks the websocket protocol and may say anything.

Messages out are msgpack; messages in are windows of zstd-compressed msgpack with binary arrays
behind. See viser's `infra`.
"""

from __future__ import annotations

import socket
import typing
from collections.abc import Iterator
from functools import cache
from typing import Any, get_args, get_origin, get_type_hints

import msgspec
import viser
import zstandard
from viser import _messages
from websockets.sync.client import ClientConnection, connect


class RawClient:
    """One connection; a context manager."""

    def __init__(
        self,
        port: int,
        host: str = "127.0.0.1",
        holds_bytes: int = 0,
        cookie: str = "",
        language: str = "",
    ) -> None:
        """`holds_bytes`: how much waits at this end while nobody reads; 0 for as usual.
        `language`: of the browser, as in Accept-Language."""
        version = f"viser-v{viser.__version__}"
        line = socket.socket()
        if holds_bytes:
            line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, holds_bytes)
        line.connect((host, port))
        self._socket: ClientConnection = connect(
            f"ws://{host}:{port}",
            sock=line,
            additional_headers={
                name: said
                for name, said in (("Cookie", cookie), ("Accept-Language", language))
                if said
            },
            subprotocols=[version],
            max_size=None,
            max_queue=1,
            close_timeout=0.2,
            compression=None,
        )

    def __enter__(self) -> RawClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._socket.close()

    @property
    def line(self) -> socket.socket:
        """What the websocket is spoken on, for what is no websocket message."""
        return self._socket.socket

    def send(self, message: dict[str, Any]) -> None:
        self.send_raw(msgspec.msgpack.encode(message))

    def send_raw(self, said: bytes | str) -> None:
        """Send what need not be a message."""
        self._socket.send(said)

    def window(self, timeout: float | None = None) -> list[dict[str, Any]]:
        """The next messages that come together; raises `TimeoutError`."""
        return messages_of(typing.cast(bytes, self._socket.recv(timeout=timeout)))

    def backlog(self) -> list[dict[str, Any]]:
        """All messages of the replay that every new browser is sent."""
        got: list[dict[str, Any]] = []
        while not got or got[-1]["type"] != "ReplayDoneMessage":
            got += self.window(timeout=20)
        return got

    def look(self, width: int = 1280, height: int = 720, **other: Any) -> None:
        """Tell the server, as a browser does first of all, where it looks from."""
        self.send(
            {**instance(_messages.ViewerCameraMessage, {}), **AHEAD}
            | other
            | {"image_width": width, "image_height": height}
        )


AHEAD = {"wxyz": (1, 0, 0, 0), "position": (0, 0, 0), "look_at": (0, 0, 1), "fov": 1.0}


def messages_of(raw: bytes) -> list[dict[str, Any]]:
    """The messages of one window; binary arrays stay placeholders."""
    size = int.from_bytes(raw[8:16], "little")
    inner = zstandard.ZstdDecompressor().decompress(raw[16 : 16 + size])
    return list(msgspec.msgpack.decode(inner)["messages"])


def every_message(uuids: list[str], names: list[str]) -> Iterator[dict[str, Any]]:
    """One of every kind of message that viser knows, for each of these entities."""
    for kind in _messages.Message.get_subclasses():
        fields = _usual(kind)
        if fields.keys() & {"uuid", "source_component_uuid"}:
            for uuid in uuids:
                # One upload for each, named after it.
                known = {"uuid": uuid, "source_component_uuid": uuid, "transfer_uuid": uuid}
                yield instance(kind, known)
        elif "name" in fields:
            for name in names:
                yield instance(kind, {"name": name})
        else:
            yield instance(kind, {})


def instance(kind: type[Any], known: dict[str, Any]) -> dict[str, Any]:
    """A message of this kind that the server can read, with these fields as they are."""
    usual = _usual(kind)
    return {**usual, **{name: known[name] for name in usual.keys() & known.keys()}}


@cache
def _usual(kind: type[Any]) -> dict[str, Any]:
    """A message of this kind; not to be changed."""
    hints = get_type_hints(kind)  # takes a millisecond
    usual = {"updates": {"value": True}, "owner": "", "modifier": None, "frequency": 10.0}
    out = {
        name: usual.get(name, _some(name, hints[name]))
        for name in getattr(kind, "__dataclass_fields__", {})
        if name in hints
    }
    return {**out, "type": kind.__name__}


def _some(name: str, hint: Any) -> Any:
    origin, args = get_origin(hint), get_args(hint)
    plain = {str: "x", int: 0 if name.endswith("index") else 1, float: 1.0, bool: True, bytes: b"x"}
    if hint in plain:
        return plain[hint]
    if origin is typing.Union:
        return _some(name, args[0])
    if origin is typing.Literal:
        return args[0]
    if origin is tuple:
        return tuple(_some(name, arg) for arg in args if arg is not ...)
    return {}

"""The web servers of the pages: viser's, bound with care and never tunnelled to the outside.

`LocalServer` is for those who act; `ReadOnlyServer` is for those who only look.
"""

from __future__ import annotations

import contextlib
import errno
import io
import socket
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import viser

# What a browser sends; viser has no public name for it.
from viser import _messages as messages  # pyright: ignore[reportPrivateUsage]

from venus3d.engine.errors import VenusError
from venus3d.scene.texts.common import PORT_TAKEN

_PORTS_TRIED = 100
_EVERYWHERE = ("0.0.0.0", "::", "")
_ON_ITS_WAY_BYTES = 131072
"""A browser behind a slow line skips pictures; megabytes on their way would come seconds late."""
_FARTHEST = 1e4
"""No point of view and no window is larger, metres or pixels."""


_Kind = TypeVar("_Kind", bound="LocalServer")


class AddressError(VenusError):
    """An address on which nothing can be served."""


class LocalServer(viser.ViserServer):
    """viser's server without the public tunnel that any client could otherwise ask for."""

    @property
    def url(self) -> str:
        """The page's address on this machine."""
        host = self.get_host()
        return f"http://{'localhost' if host in _EVERYWHERE else host}:{self.get_port()}"

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: a camera's picture stays on this machine."""
        return None

    def stop(self) -> None:
        """Serve no longer. viser would print a line, and what is printed is the command line's."""
        with contextlib.redirect_stdout(io.StringIO()):
            super().stop()


class ReadOnlyServer(LocalServer):
    """A server that shows and does not listen: nothing that a browser sends changes anything.

    Every message that comes in passes one of two doors, the server's or that browser's own. The
    server's is walled up, the browser's lets through only where that browser looks from. So it
    does not matter what is on the page: there is no way from a browser to a callback.
    """

    def __init__(self, host: str, port: int, **options: Any) -> None:
        super().__init__(host, port, **options)
        websockets: Any = vars(self)["_websock_server"]
        _narrow(websockets, lambda _: False)

        def welcome(connection: Any) -> None:
            _narrow(connection, _is_point_of_view)
            line = websockets._live_connections[connection.client_id].transport
            line.get_extra_info("socket").setsockopt(
                socket.SOL_SOCKET, socket.SO_SNDBUF, _ON_ITS_WAY_BYTES
            )

        websockets.on_client_connect(welcome)
        # Whoever was quicker than these lines comes back through the narrow doors.
        websockets.disconnect_all_clients()


def _narrow(door: Any, hears: Callable[[object], bool]) -> None:
    """Let one of viser's message handlers hear of these messages and of no others."""
    # Looked up first: should viser rename it, no page is served rather than an open one.
    dispatch = door._handle_incoming_message

    async def dispatch_heard(client_id: int, message: object) -> None:
        if hears(message):
            await dispatch(client_id, message)

    door._handle_incoming_message = dispatch_heard


def _is_point_of_view(message: object) -> bool:
    """Whether a browser says where it looks from and how large it is, in numbers that can be.

    Others would break what is computed from them, and so the page of all.
    """
    if not isinstance(message, messages.ViewerCameraMessage):
        return False
    m = message
    try:
        numbers = [*m.wxyz, *m.position, *m.look_at, *m.up_direction, m.fov, m.near, m.far]
        numbers = np.array([*numbers, m.image_width, m.image_height], dtype=np.float64)
    except (TypeError, ValueError):
        return False
    if numbers.shape != (18,) or not (np.abs(numbers) <= _FARTHEST).all():
        return False
    turn, position, look_at, up = np.split(numbers[:13], [4, 7, 10])
    lengths = [float(np.linalg.norm(v)) for v in (turn, look_at - position, up)]
    return min(lengths) > 1e-6 and bool((numbers[-2:] >= 1).all())


def start_server(host: str, port: int) -> tuple[LocalServer, str]:
    """A running server, and a note if another port than the one asked for had to be taken.

    Raises `AddressError` if the address cannot be bound. It is tried first, because viser waits
    for ever on one that cannot.
    """
    _check_port(port)
    for candidate in range(port, min(port + _PORTS_TRIED, 65536)):
        if _is_free(host, candidate):
            break
    else:
        raise AddressError(f"No port from {port} on is free on {host}; choose another with --port.")
    server = _quietly(LocalServer, host, candidate)
    taken = server.get_port()
    note = "" if taken == port else PORT_TAKEN.format(port=port, taken=taken)
    return server, note


def start_read_only_server(host: str, port: int) -> ReadOnlyServer:
    """A running server for those who only look, on this very port.

    Raises `AddressError` if the address cannot be bound or the port is taken: the second screen
    was told the address beforehand.
    """
    _check_port(port)
    taken = AddressError(f"Port {port} is taken on {host}; choose another with --audience.")
    if not _is_free(host, port):
        raise taken
    server = _quietly(ReadOnlyServer, host, port)
    if server.get_port() != port:  # somebody was quicker
        server.stop()
        raise taken
    return server


def _quietly(kind: type[_Kind], host: str, port: int) -> _Kind:
    # viser prints a banner with the address; ours is printed by the command line.
    with contextlib.redirect_stdout(io.StringIO()):
        return kind(host=host, port=port, label="venus3d", verbose=False)


def _check_port(port: int) -> None:
    if not 0 < port < 65536:
        raise AddressError(f"There is no port {port}; use one from 1024 to 65535.")


def _is_free(host: str, port: int) -> bool:
    """Whether this port can be bound. Raises `AddressError` if none can on this address."""
    try:
        infos = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (socket.gaierror, UnicodeError):
        raise AddressError(
            f"The address {host!r} is not known; use 127.0.0.1 for this machine only, "
            "or 0.0.0.0 for the network."
        ) from None
    family, kind, protocol, _, address = infos[0]
    with socket.socket(family, kind, protocol) as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind(address)
        except PermissionError:
            raise AddressError(f"Port {port} needs special rights; use one above 1023.") from None
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                return False
            raise AddressError(
                f"The address {host} cannot be bound on this machine ({error.strerror}); "
                "use 127.0.0.1 for this machine only, or 0.0.0.0 for the network."
            ) from None
    return True

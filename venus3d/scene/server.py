"""The web server of the page: viser's, bound with care and never tunnelled to the outside."""

from __future__ import annotations

import contextlib
import errno
import io
import socket

import viser

from venus3d.engine.errors import VenusError

_PORTS_TRIED = 100


class AddressError(VenusError):
    """An address on which nothing can be served."""


class LocalServer(viser.ViserServer):
    """viser's server without the public tunnel that any client could otherwise ask for."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: a camera's picture stays on this machine."""
        return None


def start_server(host: str, port: int) -> tuple[LocalServer, str]:
    """A running server, and a note if another port than the one asked for had to be taken.

    Raises `AddressError` if the address cannot be bound. It is tried first, because viser waits
    for ever on one that cannot.
    """
    free = _free_port(host, port)
    # viser prints a banner with the address; ours is printed by the command line.
    with contextlib.redirect_stdout(io.StringIO()):
        server = LocalServer(host=host, port=free, label="venus3d", verbose=False)
    taken = server.get_port()
    note = "" if taken == port else f"Port {port} is taken; using {taken}."
    return server, note


def _free_port(host: str, port: int) -> int:
    if not 0 < port < 65536:
        raise AddressError(f"There is no port {port}; use one from 1024 to 65535.")
    for candidate in range(port, min(port + _PORTS_TRIED, 65536)):
        try:
            infos = socket.getaddrinfo(host, candidate, type=socket.SOCK_STREAM)
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
                raise AddressError(
                    f"Port {candidate} needs special rights; use one above 1023."
                ) from None
            except OSError as error:
                if error.errno == errno.EADDRINUSE:
                    continue
                raise AddressError(
                    f"The address {host} cannot be bound on this machine ({error.strerror}); "
                    "use 127.0.0.1 for this machine only, or 0.0.0.0 for the network."
                ) from None
        return candidate
    raise AddressError(f"No port from {port} on is free on {host}; choose another with --port.")

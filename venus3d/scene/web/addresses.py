"""The addresses at which pages are served: which can be bound, and how others reach them."""

from __future__ import annotations

import errno
import ipaddress
import socket

from venus3d.engine.errors import VenusError

_EVERYWHERE = ("0.0.0.0", "::", "")


class AddressError(VenusError):
    """An address that cannot be served."""


def is_loopback(host: str) -> bool:
    """Whether a server that listens on `host` is reached from this machine only."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


def here(host: str) -> str:
    """What a browser on this machine calls a server that listens on `host`."""
    return "localhost" if host in _EVERYWHERE else _in_address(host)


def from_elsewhere(host: str) -> str:
    """What a browser on another machine calls it, as far as this machine knows."""
    return _own_address() if host in _EVERYWHERE else _in_address(host)


def _in_address(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _own_address() -> str:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: only finds the route
        except OSError:
            return socket.gethostname()
        return str(probe.getsockname()[0])


def check_port(port: int) -> None:
    """Raises `AddressError` for a number that no port has."""
    if not 0 < port < 65536:
        raise AddressError(f"There is no port {port}; use one from 1024 to 65535.")


def is_free(host: str, port: int) -> bool:
    """Whether this port can be bound. Raises `AddressError` if no port can on this address."""
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

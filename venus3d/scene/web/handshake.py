"""Checks who may connect: our own page in a browser, and programs on this machine.

Any web page can make a browser open a websocket to this machine, and DNS rebinding makes a foreign
page look like ours; both would see the camera and press the buttons. A browser is honest about
Host, the name it asked for, and Origin, the asking page. Other programs send no Origin and may
connect: they could forge any.
"""

from __future__ import annotations

import ipaddress
import socket
from urllib.parse import SplitResult, urlsplit

from websockets import Headers

from venus3d.scene.web.addresses import is_loopback

_PROXIED = ("forwarded", "via", "x-forwarded-for", "x-forwarded-host", "x-real-ip")
_PORTS = {"http": 80, "https": 443}


class RefusedError(Exception):
    """A refused request; the text tells the person in the browser why."""


def check(headers: Headers, host: str) -> None:
    """Check a request's headers for a server that listens on `host`. Raises `RefusedError` if it
    comes neither from our own page nor from a program."""
    hosts, origins = headers.get_all("host"), headers.get_all("origin")
    asked = _split(f"//{hosts[0]}") if len(hosts) == 1 else None
    if asked is None or not _is_ours(asked.hostname or "", host):
        raise RefusedError(
            "This is not a name by which this page is known; open it by the address that the "
            "program printed, or by this machine's IP address."
        )
    if not origins:
        return
    page = _split(origins[0]) if len(origins) == 1 else None
    usual = _PORTS.get("" if page is None else page.scheme)
    if (
        page is None
        or usual is None
        or (page.hostname, page.port or usual) != (asked.hostname, asked.port or usual)
    ):
        raise RefusedError(
            "Another page may not connect; open this one by the address that the program printed."
        )


def came_from_here(headers: Headers, peer: str) -> bool:
    """Whether a connection from this address, with these headers, was opened on this machine. A
    proxy here would bring strangers in from a loopback address, but it says for whom it asks."""
    try:
        address = ipaddress.ip_address(peer)
    except ValueError:
        return False
    mapped = getattr(address, "ipv4_mapped", None)  # ::ffff:127.0.0.1
    here = (mapped or address).is_loopback
    return here and not any(name in headers for name in _PROXIED)


def _split(address: str) -> SplitResult | None:
    try:
        parts = urlsplit(address)
        _ = parts.port  # raises if it is invalid
        return parts
    except ValueError:
        return None


def _is_ours(name: str, host: str) -> bool:
    """Whether a request's host name is ours, on a server that listens on `host`. IP addresses
    cannot be rebound; of names, only this machine's own count."""
    name = name.removesuffix(".")
    if name == "localhost":
        return True
    try:
        address = ipaddress.ip_address(name)
    except ValueError:
        own = socket.gethostname().lower()
        return bool(name) and not is_loopback(host) and name in {host.lower(), own, f"{own}.local"}
    return address.is_loopback or not is_loopback(host)

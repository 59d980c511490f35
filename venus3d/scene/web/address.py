"""Parses the address of the second monitor."""

from __future__ import annotations

from venus3d.engine.errors import VenusError


def audience_address(text: str, port: int) -> tuple[str, int]:
    """Host and port of "[HOST:]PORT"; without a host, this machine only. Raises `VenusError` for
    anything else and for `port`, the operator's."""
    host, colon, number = text.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")  # IPv6 addresses are bracketed
    if not number.isdecimal() or (colon and not host):
        raise VenusError(
            f"--audience wants a port, or an address and a port such as 0.0.0.0:8090, not {text!r}."
        )
    if int(number) == port:
        raise VenusError(
            f"--audience and --port are both {port}; the second monitor needs a port of its own."
        )
    return host or "127.0.0.1", int(number)

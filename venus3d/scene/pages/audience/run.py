"""Announces the address of the second monitor."""

from __future__ import annotations

import socket

from venus3d.scene.pages.audience import terminal_texts
from venus3d.scene.pages.audience.audience import Audience

_EVERYWHERE = ("0.0.0.0", "::")
_HERE = ("127.0.0.1", "::1", "localhost")


def announcement(audience: Audience) -> str:
    """One line on its address and who can see it."""
    host = _address_for_others() if audience.host in _EVERYWHERE else audience.host
    reach = terminal_texts.THIS_MACHINE if audience.host in _HERE else terminal_texts.NETWORK
    shown = "localhost" if audience.host in _HERE else host
    return terminal_texts.ANNOUNCED.format(url=f"http://{shown}:{audience.port}", open_to=reach)


def _address_for_others() -> str:
    """This machine's address in the network, as far as it knows."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: only finds the route
        except OSError:
            return socket.gethostname()
        return str(probe.getsockname()[0])

"""Sends what has been drawn before anything else is drawn."""

from __future__ import annotations

import time

import viser

from venus3d.scene.web.viser_private import newest_message, newest_sent, sockets_of

_LONGEST_S = 0.05
_ASKED_EVERY_S = 0.001


def deliver(server: viser.ViserServer) -> None:
    """Send what has been drawn for all tabs, and wait until it is on its way to one of them.

    viser sends nothing within `atomic`. Where cores are few, the thread that sends wakes up when
    the next drawing has begun already, and what had been drawn would wait for that one's end.
    Browsers that take nothing keep nobody waiting for longer than 50 ms.
    """
    server.flush()
    sockets, until = sockets_of(server), time.monotonic() + _LONGEST_S
    newest = newest_message(sockets)
    while newest_sent(sockets, newest) < newest and time.monotonic() < until:
        time.sleep(_ASKED_EVERY_S)

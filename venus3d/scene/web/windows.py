"""Adapts panel widths to the size of a browser's window."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from venus3d.scene.web.scene_view import Host
from venus3d.scene.web.viser_private import panel_in


def on_window(host: Host, act: Callable[[viser.ClientHandle], None]) -> None:
    """Call `act` on viser's threads for each tab of a server, or for one tab, when it connects and
    whenever its camera or window size changes."""

    def connected(client: viser.ClientHandle) -> None:
        act(client)
        client.camera.on_update(lambda _: act(client))

    if isinstance(host, viser.ClientHandle):
        connected(host)
    else:
        host.on_client_connect(connected)


def fit_width(host: Host, panel: Any, width: Callable[[int], int]) -> None:
    """Give a panel the width (pixels) that suits the window's height, in each tab of a server
    separately."""
    shown: dict[int, int] = {}

    def fit(client: viser.ClientHandle) -> None:
        wanted = width(client.camera.image_height)
        if shown.get(client.client_id) != wanted:
            shown[client.client_id] = wanted
            (panel if client is host else panel_in(client, panel)).set_width(wanted)

    on_window(host, fit)

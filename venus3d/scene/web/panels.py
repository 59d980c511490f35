"""Panels: their style sheet and brightness, and their width in windows of any size."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from typing import Any

import viser

from venus3d.scene.web import texts
from venus3d.scene.web.scene_view import Host
from venus3d.scene.web.theme import Theme
from venus3d.scene.web.viser_private import panel_in


class PanelStyle:
    """The style sheet in each panel, and the brightness of viser's own widgets."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """No styles until `show`."""
        self._gui = gui
        self._sheets: list[Any] = []
        self._theme: Theme | None = None

    def add(self) -> None:
        """Add the style sheet to the current panel; each needs its own, since a folded panel
        removes it."""
        self._sheets.append(self._gui.add_html(""))

    def show(self, theme: Theme) -> bool:
        """Use these colours, in new panels too. Whether anything has changed."""
        if theme == self._theme and all(sheet.content for sheet in self._sheets):
            return False
        self._theme = theme
        self._gui.configure_theme(
            dark_mode=theme.dark,
            show_logo=False,
            show_share_button=False,
            brand_color=theme.brand,
        )
        for sheet in self._sheets:
            sheet.content = (
                f"{theme.sheet}<i class='v-typing' hidden data-typing='{escape(texts.TYPING)}'></i>"
            )
        return True


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

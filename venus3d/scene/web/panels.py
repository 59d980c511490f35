"""Panels: their style sheet and brightness, and their width in windows of any size."""

from __future__ import annotations

import json
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from venus3d.scene.web import texts
from venus3d.scene.web.scene_view import Host
from venus3d.scene.web.theme import Theme
from venus3d.scene.web.viser_private import panel_in
from venus3d.scene.web.window import is_height, window_height


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
        lost = f"<style>:root{{--lost:{json.dumps(texts.LOST, ensure_ascii=False)}}}</style>"
        for sheet in self._sheets:
            sheet.content = (
                f"{theme.sheet}{lost}"
                f"<i class='v-typing' hidden data-typing='{escape(texts.TYPING)}'></i>"
            )
        return True


def fit_width(host: Host, panel: Any, width: Callable[[int], int]) -> None:
    """Give a panel the width that suits the height of the window, both in CSS pixels, in each tab
    of a server separately: as the window was opened, and again when it has been resized."""

    def fit(client: viser.ClientHandle, height: int) -> None:
        mine = panel if client is host else panel_in(client, panel)
        mine.set_width(width(height))

    if isinstance(host, viser.ClientHandle):
        fit(host, window_height(host))
    else:
        host.on_client_connect(lambda client: fit(client, window_height(client)))
    # No message of viser's tells of it: window.js writes the height into a field without a look.
    host.gui.add_html("<i class='v-window-height'></i>")
    field = host.gui.add_text("", "")

    def resized(event: Any) -> None:
        height = str(event.target.value).split(" ")[0]
        if event.client is not None and is_height(height):
            fit(event.client, int(height))

    field.on_update(resized)

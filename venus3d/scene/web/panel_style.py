"""The style sheet and brightness of a page's panels."""

from __future__ import annotations

from typing import Any

import viser

from venus3d.scene.web.theme import Theme


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
            sheet.content = theme.sheet
        return True

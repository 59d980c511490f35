"""The style sheet and the brightness of a page's panels."""

from __future__ import annotations

from typing import Any

import viser

from venus3d.scene.web.theme import Theme


class PanelStyle:
    """The style sheet in each of a page's panels, and the brightness of viser's own things."""

    def __init__(self, gui: viser.GuiApi) -> None:
        """Nothing has a style until `show`."""
        self._gui = gui
        self._sheets: list[Any] = []
        self._theme: Theme | None = None

    def add(self) -> None:
        """Put the style sheet into the current panel: one that is folded takes its sheet along, so
        each has its own."""
        self._sheets.append(self._gui.add_html(""))

    def show(self, theme: Theme) -> bool:
        """Take these colours, in panels added since as well. Whether anything is another now."""
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

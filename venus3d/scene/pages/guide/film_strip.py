"""The captured views as a strip of small pictures at the scene's lower edge; a click opens a view.

The pictures are buttons of one row. style.css takes the row out of its panel and lays it along the
scene; the pictures themselves are the row's own rules, so that a button stays when another comes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from threading import Lock

import viser

from venus3d.render.annotated_picture import LivePicture, small_picture
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.projections_panel import encoded

_PICTURE_WIDTH = 144
_ROW = "div:has(> .v-film) + div"


class FilmStrip:
    """The strip of a page; it outlives the servers on which the page is laid out."""

    def __init__(self, on_open: Callable[[int, viser.ClientHandle], None]) -> None:
        """`on_open` is called on viser's threads with a view's number and the tab."""
        self._on_open = on_open
        self._lock = Lock()
        self._pictures: dict[int, str] = {}

    def keep_picture(self, number: int, image: LivePicture) -> None:
        """Keep a small copy of the picture (BGR or grey) of the view of this number."""
        source = encoded(small_picture(image, _PICTURE_WIDTH))
        with self._lock:
            self._pictures[number] = source

    def lay_out(self, gui: viser.GuiApi) -> None:
        """Create its widgets in the current panel of a new server."""
        self._frame = gui.add_html("")
        # Without viser's hint, which would stand above the row: over the buttons of another panel.
        title = say.FILM_ROW[0]
        self._row = ButtonRow(gui, title, {0: title}, self._pressed)
        self.show((), None)

    def show(self, captured: Sequence[int] | None, chosen: int | None) -> None:
        """Show the views of these numbers, one of them marked; no strip without any views to
        come (None)."""
        self._frame.visible = captured is not None
        numbers = captured or ()
        with self._lock:
            pictures = [self._pictures.get(number, "") for number in numbers]
        rules = "".join(
            f"{_ROW} button:nth-child({place}){{background-image:url({picture})}}"
            for place, picture in enumerate(pictures, start=1)
            if picture
        )
        if chosen in numbers:
            place = numbers.index(chosen) + 1
            rules += f"{_ROW} button:nth-child({place}){{border-color:var(--text)!important}}"
        empty, hint = "" if numbers else say.FILM_EMPTY, escape(say.FILM_ROW[1], quote=True)
        strip = f"<div class='v-film' title='{hint}'>{empty}</div>"
        self._frame.content = f"{strip}<style>{rules}</style>"
        self._row.show({number: say.FILM_VIEW.format(number=number) for number in numbers})

    def _pressed(self, number: int, client: viser.ClientHandle | None) -> None:
        if client is not None:
            self._on_open(number, client)

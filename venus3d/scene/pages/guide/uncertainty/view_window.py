"""A window about one captured view, in the tab in which it was clicked."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from typing import Any

import viser

from venus3d.scene.pages.guide.uncertainty import texts


class ViewWindow:
    """At most one per tab; Esc closes it. Callbacks come on viser's threads."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._open: dict[int, tuple[Any, Any]] = {}

    def open(
        self,
        client: viser.ClientHandle,
        number: int,
        html: str,
        leave_out: Callable[[], None] | None,
    ) -> None:
        """Show `html` of the view of this number, with a button that excludes it if allowed."""
        self.close(client)
        with self._lock, client.atomic():
            modal = client.gui.add_modal(texts.VIEW_TITLE.format(number=number))
            with modal:
                client.gui.add_html(html)
                if leave_out is not None:
                    drop = client.gui.add_button(
                        texts.LEAVE_OUT, icon=viser.Icon.TRASH, hint=texts.LEAVE_OUT_HINT
                    )
                    drop.on_click(lambda _: leave_out())
                    drop.on_click(lambda _: self.close(client))
                close = client.gui.add_button(texts.CLOSE_VIEW, hint=texts.CLOSE_VIEW_HINT)
                close.on_click(lambda _: self.close(client))
            escape = client.gui.add_command(
                texts.CLOSE_VIEW_COMMAND, description=texts.CLOSE_VIEW_HINT, hotkey="escape"
            )
            escape.on_trigger(lambda _: self.close(client))
            self._open[client.client_id] = (modal, escape)

    def close(self, client: viser.ClientHandle) -> None:
        """Close this tab's window, if there is one."""
        with self._lock:
            opened = self._open.pop(client.client_id, None)
        if opened is not None:
            modal, escape = opened
            modal.close()
            escape.remove()

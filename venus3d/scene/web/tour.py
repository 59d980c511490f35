"""A short guided tour: small steps over the page, each highlighting what it describes. It starts by
itself when a browser first opens the page, which the browser remembers in its local storage; later
only on request."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from threading import Lock
from typing import Any

import viser

from venus3d.scene.web import texts as say
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.help import Command
from venus3d.scene.web.theme import Theme

_PATIENCE_S = 20.0
"""Seconds a browser may take to answer whether it has seen the tour."""


@dataclass(frozen=True)
class TourStep:
    """One step of a tour."""

    title: str
    text: str
    marks: str = ""
    """What the style sheet frames meanwhile (its [data-marks]); empty: nothing."""


@dataclass
class _Open:
    """The open tour of one tab."""

    modal: Any
    content: Any
    next: Any
    others: ButtonRow[str]
    number: int = 0


class Tour:
    """The tour of one server's page, separate in each tab."""

    def __init__(
        self, server: viser.ViserServer, key: str, steps: Sequence[TourStep], *, at_first: bool
    ) -> None:
        """Offer the tour; with `at_first`, start it in each browser that has not stored `key`
        yet."""
        self._key, self._steps = key, tuple(steps)
        self._theme = Theme(True)
        self._lock = Lock()
        self._open: dict[int, _Open] = {}
        again = server.gui.add_command(say.TOUR_COMMAND, description=say.TOUR_COMMAND_HINT)
        again.on_trigger(lambda event: event.client and self.start(event.client))
        skip = server.gui.add_command(
            say.TOUR_SKIP, description=say.TOUR_ROW_HINT.rstrip("."), hotkey="escape"
        )
        skip.on_trigger(lambda event: event.client and self._end(event.client))
        if at_first:
            server.on_client_connect(self._start_at_first)

    @property
    def commands(self) -> tuple[Command, ...]:
        """Its commands, for the help; they are already added."""
        return (Command(say.TOUR_COMMAND, None, say.TOUR_COMMAND_HINT, lambda: None),)

    def show(self, theme: Theme) -> None:
        """Use these colours from now on."""
        if theme != self._theme:
            self._theme = theme
            with self._lock:
                opened = list(self._open.values())
            for one in opened:
                one.content.content = self._html(one.number)

    def start(self, client: viser.ClientHandle) -> None:
        """Show the first step in this tab."""

        def pressed(action: str, _: object) -> None:
            if action == "back":
                self._turn(client, -1)
            else:
                self._end(client)

        with self._lock, client.atomic():
            if client.client_id in self._open:
                return
            gui = client.gui
            modal = gui.add_modal(say.TOUR_ROW)
            with modal:
                content = gui.add_html(self._html(0))
                # The first button has the focus: Enter continues.
                forth = gui.add_button(say.TOUR_NEXT, hint=say.TOUR_NEXT_HINT)
                others = ButtonRow(gui, say.TOUR_ROW, _others(0), pressed, hint=say.TOUR_ROW_HINT)
            self._open[client.client_id] = _Open(modal, content, forth, others)
        forth.on_click(lambda _: self._turn(client, 1))

    def _start_at_first(self, client: viser.ClientHandle) -> None:
        try:
            seen = client.local_storage.get_item(self._key, timeout=_PATIENCE_S)
        except (RuntimeError, TimeoutError):
            return  # closed, or without storage: then the tour would start each time
        if seen is None:
            self.start(client)

    def _turn(self, client: viser.ClientHandle, by: int) -> None:
        opened = self._open.get(client.client_id)
        if opened is None:
            return
        if opened.number + by >= len(self._steps):
            self._end(client)
            return
        opened.number = max(0, opened.number + by)
        last = opened.number == len(self._steps) - 1
        with client.atomic():
            opened.content.content = self._html(opened.number)
            opened.next.label = say.TOUR_END if last else say.TOUR_NEXT
            opened.others.show(_others(opened.number))

    def _end(self, client: viser.ClientHandle) -> None:
        with self._lock:
            opened = self._open.pop(client.client_id, None)
        if opened is not None:
            opened.modal.close()
            client.local_storage.set_item(self._key, "seen")

    def _html(self, index: int) -> str:
        step, count = self._steps[index], len(self._steps)
        return (
            f"{self._theme.sheet}<div class='v-tour' data-step='{index + 1}' "
            f"data-marks='{step.marks}'>"
            f"<small>{say.TOUR_COUNT.format(number=index + 1, count=count)}</small>"
            f"<h2>{escape(step.title)}</h2><p>{escape(step.text)}</p></div>"
        )


def _others(number: int) -> dict[str, str]:
    """Labels of the buttons beside `next` on the step with this index; nothing is before the
    first."""
    back = {"back": say.TOUR_BACK} if number else {}
    return {**back, "skip": say.TOUR_SKIP}

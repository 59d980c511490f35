"""A page's commands: one list for hotkeys, the command palette and the help. The help opens only in
the tab that asked for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from threading import Lock
from typing import Any

import viser

from venus3d.scene.web import texts as say
from venus3d.scene.web.scene_view import Host
from venus3d.scene.web.theme import Theme

SHIFT = "shift+"
"""Comes before a key that goes with Shift."""


@dataclass(frozen=True)
class Command:
    """An action that a person can call by key or by name."""

    label: str
    hotkey: str | None
    """A key of viser's, such as "N" or "space", or with Shift, "shift+N"; None: by name only.
    W A S D Q E and the arrows move the browser's camera, and H and escape belong to the help."""
    description: str
    """What it does, in one short sentence without a full stop."""
    do: Callable[[], None]
    """Called on viser's threads: only queues, or changes a frozen state."""
    do_in_tab: Callable[[viser.ClientHandle], None] | None = None
    """Called instead of `do`, with the tab in which it was asked for."""

    def run(self, client: viser.ClientHandle | None) -> None:
        """Do it, asked for in this tab."""
        if self.do_in_tab is None:
            self.do()
        else:
            _in_tab(client, self.do_in_tab)


def add_commands(host: Host, commands: Sequence[Command]) -> None:
    """Add the commands to the palette of a server or a tab, with their hotkeys. Raises `ValueError`
    if two share a key."""
    _check_keys(commands)
    for command in commands:
        key: Any = command.hotkey
        shifted = command.hotkey is not None and command.hotkey.startswith(SHIFT)
        handle = host.gui.add_command(
            command.label,
            description=command.description,
            hotkey=key.removeprefix(SHIFT) if shifted else key,
            modifier="shift" if shifted else None,
        )
        handle.on_trigger(lambda event, command=command: command.run(event.client))


def _check_keys(commands: Sequence[Command]) -> None:
    keys = [c.hotkey for c in commands if c.hotkey is not None]
    twice = {key for key in keys if keys.count(key) > 1}
    if twice:
        named = ", ".join(sorted(map(key_name, twice)))
        raise ValueError(f"two commands for one key: {named}")


class HelpOverlay:
    """A page's help: H toggles it, Esc closes it."""

    def __init__(self, host: Host, commands: Sequence[Command], *, dark: bool = True) -> None:
        """Add the help's own two commands; `commands` are listed, not added."""
        self._commands = tuple(commands)
        self._theme = Theme(dark)
        self._lock = Lock()
        self._open: dict[int, tuple[Any, Any]] = {}  # the modal and its style sheet
        add = host.gui.add_command
        toggle = add(say.HELP_COMMAND, description=say.HELP_COMMAND_HINT, hotkey="H")
        toggle.on_trigger(lambda event: _in_tab(event.client, self.toggle))
        close = add(say.ESCAPE_COMMAND, description=say.ESCAPE_COMMAND_HINT, hotkey="escape")
        close.on_trigger(lambda event: _in_tab(event.client, self._close))

    def explain(self, commands: Sequence[Command]) -> None:
        """List these too, which others have added to the page. Raises `ValueError` if two commands
        share a key."""
        _check_keys((*self._commands, *commands))
        self._commands += tuple(commands)

    def show(self, theme: Theme) -> None:
        """Use these colours, at once if the help is open."""
        with self._lock:
            if theme == self._theme:
                return
            self._theme = theme
            sheets = [sheet for _, sheet in self._open.values()]
        for sheet in sheets:
            sheet.content = theme.sheet

    def toggle(self, client: viser.ClientHandle) -> None:
        """Open or close it in this tab."""
        if client.client_id in self._open:
            self._close(client)
        else:
            self._show_in(client)

    def _show_in(self, client: viser.ClientHandle) -> None:
        with self._lock, client.atomic():
            modal = client.gui.add_modal(say.HELP_TITLE)
            with modal:
                sheet = client.gui.add_html(self._theme.sheet)
                client.gui.add_html(keys_html(self._commands))
                button = client.gui.add_button(say.HELP_CLOSE, hint=say.HELP_CLOSE_HINT)
                button.on_click(lambda _: self._close(client))
            self._open[client.client_id] = (modal, sheet)

    def _close(self, client: viser.ClientHandle) -> None:
        with self._lock:
            modal, _ = self._open.pop(client.client_id, (None, None))
        if modal is not None:
            modal.close()


def keys_html(commands: Sequence[Command]) -> str:
    """The help's table: key, name and description of each command; below it those without a key."""
    help_itself = Command(say.HELP_COMMAND, "H", say.HELP_COMMAND_HINT, lambda: None)
    rows = "".join(
        f"<tr><td><kbd class='v-key'>{escape(key_name(c.hotkey))}</kbd></td>"
        f"<td><b>{escape(c.label)}</b></td><td>{escape(c.description)}</td></tr>"
        for c in (help_itself, *commands)
        if c.hotkey is not None
    )
    named = " · ".join(
        f"<span title='{escape(c.description)}'>{escape(c.label)}</span>"
        for c in commands
        if c.hotkey is None
    )
    by_name = f"<p><b>{say.BY_NAME.format(key=say.NO_KEY)}</b> {named}</p>" if named else ""
    return (
        f"<div class='v-keys'><p>{escape(say.HELP_INTRO)}</p><table>{rows}</table>{by_name}"
        f"<p>{escape(say.HELP_CAMERA)}</p></div>"
    )


def key_name(hotkey: str | None) -> str:
    """A key as labelled on the keyboard, with Shift or alone."""
    if hotkey is None:
        return say.NO_KEY
    alone = hotkey.removeprefix(SHIFT)
    name = say.KEY_NAMES.get(alone, alone)
    return name if alone == hotkey else say.SHIFTED.format(key=name)


def _in_tab(client: viser.ClientHandle | None, do: Callable[[viser.ClientHandle], None]) -> None:
    if client is not None:  # a key is always pressed in a tab
        do(client)

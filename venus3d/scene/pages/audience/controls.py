"""The second monitor's options on the operator's page: a folder and hotkeys."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import viser

from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.web.help import Command, add_commands


class AudienceControls:
    """A folder in the current panel of the operator's page. Callbacks only change a value."""

    def __init__(self, server: viser.ViserServer, audience: Audience) -> None:
        """Create the switches and hotkeys."""
        self._audience = audience
        self._boxes: dict[str, Any] = {}
        with server.gui.add_folder(texts.PANEL, expand_by_default=False):
            for name, label, key, hint in texts.CONTROLS:
                said = label if key is None else f"{label} ({key})"
                box = server.gui.add_checkbox(said, getattr(audience.state, name), hint=hint)
                box.on_update(self._ticked(name))
                self._boxes[name] = box
        self.commands = tuple(
            Command(f"{texts.PANEL}: {label}", key, hint, self._toggled(name))
            for name, label, key, hint in texts.CONTROLS
        )
        """Commands, already in the palette; for the page's help."""
        add_commands(server, self.commands)

    def _ticked(self, name: str) -> Callable[[Any], None]:
        def ticked(event: Any) -> None:
            if event.client is not None:  # not set by the program
                self._audience.change(_with(name, bool(event.target.value)))

        return ticked

    def _toggled(self, name: str) -> Callable[[], None]:
        def toggled() -> None:
            self._audience.change(lambda look: _with(name, not getattr(look, name))(look))
            self._boxes[name].value = getattr(self._audience.state, name)

        return toggled


def _with(name: str, on: bool) -> Callable[[AudienceState], AudienceState]:
    return lambda look: replace(look, **{name: on})

"""The second monitor's options on the operator's page: a folder and hotkeys."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, get_args

import viser

from venus3d.scene.pages.audience import texts
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.state import Sound
from venus3d.scene.web.buttons import ChoiceList
from venus3d.scene.web.help import Command, add_commands, key_name
from venus3d.scene.web.keys import KEYS


class AudienceControls:
    """A folder in the current panel of the operator's page. Callbacks only change a value."""

    def __init__(self, server: viser.ViserServer, audience: Audience) -> None:
        """Create the switches and hotkeys."""
        self._audience = audience
        self._boxes: dict[str, Any] = {}
        with server.gui.add_folder(texts.PANEL, expand_by_default=False):
            for name, (label, hint) in texts.CONTROLS.items():
                key = KEYS.get(name)
                said = label if key is None else f"{label} ({key_name(key)})"
                box = server.gui.add_checkbox(said, getattr(audience.state, name), hint=hint)
                box.on_update(partial(self._ticked, name))
                self._boxes[name] = box
            self._sound = ChoiceList[Sound](
                server.gui,
                texts.SOUND_LABEL,
                texts.SOUND_OPTIONS,
                self._hear,
                chosen=audience.state.sound,
                hint=texts.SOUND_CHOICE_HINT,
            )
        self.commands = tuple(
            Command(f"{texts.PANEL}: {label}", KEYS.get(name), hint, partial(self._toggle, name))
            for name, (label, hint) in texts.CONTROLS.items()
        )
        sounds = f"{texts.PANEL}: {texts.SOUND_COMMAND}"
        self.commands += (Command(sounds, None, texts.SOUND_COMMAND_HINT, self._next_sound),)
        """Commands, already in the palette; for the page's help."""
        add_commands(server, self.commands)

    def _ticked(self, name: str, event: Any) -> None:
        if event.client is not None:  # not set by the program
            on = bool(event.target.value)
            self._audience.change(lambda look: replace(look, **{name: on}))

    def _toggle(self, name: str) -> None:
        look = self._audience.change(lambda look: replace(look, **{name: not getattr(look, name)}))
        self._boxes[name].value = getattr(look, name)

    def _hear(self, sound: Sound) -> None:
        self._audience.change(lambda look: replace(look, sound=sound))

    def _next_sound(self) -> None:
        sounds = get_args(Sound)
        self._hear(sounds[(sounds.index(self._audience.state.sound) + 1) % len(sounds)])
        self._sound.show(texts.SOUND_OPTIONS, self._audience.state.sound, again=True)

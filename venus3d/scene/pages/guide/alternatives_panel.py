"""Buttons for poses nearly as good as the target, best first; one may suit wrists or room
better."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from venus3d.engine.amounts import figure
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.target import Target
from venus3d.languages import translated
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import ChooseAlternative, Intent
from venus3d.scene.web.help import Command

_AT_MOST = 3


class AlternativesPanel:
    """The buttons of one server. `ask` is called on viser's threads."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Create the buttons in the current panel."""
        self._ask = ask
        self._target = 0
        self._shown: Target | None = None
        self._title = gui.add_html("", visible=False)
        self._buttons = [
            gui.add_button("–", visible=False, color="gray", hint=say.OTHER_HINT)
            for _ in range(_AT_MOST)
        ]
        for index, button in enumerate(self._buttons):
            button.on_click(lambda _, index=index: self._choose(index))

    @property
    def commands(self) -> tuple[Command, ...]:
        """The same choices as commands, each with its number as a key."""
        return tuple(
            Command(
                label,
                str(index + 1),
                say.OTHER_COMMAND_HINT,
                lambda index=index: self._choose(index),
            )
            for index, label in enumerate(say.OTHER_COMMANDS)
        )

    def show(self, snapshot: Snapshot | None) -> None:
        """Update the buttons to the alternatives."""
        shown = snapshot is not None and snapshot.phase in ("guiding", "captured")
        target = snapshot.target if snapshot is not None and shown else None
        self._target = 0 if target is None else target.number
        if target is self._shown:
            return
        self._shown = target
        others = () if target is None else target.alternatives[:_AT_MOST]
        self._title.visible = bool(others)
        if target is not None and others:
            self._title.content = _title(target)
        for index, button in enumerate(self._buttons):
            button.visible = index < len(others)
            if index < len(others):
                button.label = alternative_text(others[index])

    def _choose(self, index: int) -> None:
        self._ask(ChooseAlternative(index, self._target))


def alternative_text(other: Target) -> str:
    """How the board is held there, and the expected result."""
    if not np.isfinite(other.gain_px):
        return translated(other.held)
    held = translated(other.held)
    return say.OTHER_TEXT.format(held=held, error=figure(other.predicted_uncertainty_px))


def _title(target: Target) -> str:
    instead = ""
    if np.isfinite(target.gain_px):
        instead = say.OTHERS_INSTEAD.format(error=figure(target.predicted_uncertainty_px))
    return f"<div class='v-progress'><h3>{say.OTHERS_TITLE.format(instead=instead)}</h3></div>"

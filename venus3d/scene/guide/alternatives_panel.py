"""Buttons for poses that are nearly as good as the target; none while there are none.

One of them may suit the person's wrists, or the room. The best of them stands first.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from venus3d.engine.snapshot import Snapshot, Target
from venus3d.scene.guide.intents import ChooseAlternative, Intent
from venus3d.scene.guide.progress_panel import px_text

_AT_MOST = 3
_HINT = "Ask for this pose instead. J goes through all of them."


class AlternativesPanel:
    """The buttons of one server. `ask` is called on viser's threads."""

    def __init__(self, server: viser.ViserServer, ask: Callable[[Intent], None]) -> None:
        """Make the buttons in the current panel, and the hotkey."""
        gui = server.gui
        self._title = gui.add_html("", visible=False)
        self._buttons = [
            gui.add_button("–", visible=False, color="gray", hint=_HINT) for _ in range(_AT_MOST)
        ]
        for index, button in enumerate(self._buttons):
            button.on_click(lambda _, index=index: ask(ChooseAlternative(index)))
        command = gui.add_command(
            "Another pose as good",
            hotkey="J",
            description="Ask for another pose that is nearly as good as the target",
        )
        command.on_trigger(lambda _: ask(ChooseAlternative(0)))

    def show(self, snapshot: Snapshot | None) -> None:
        """Let the buttons say what there is to choose from."""
        shown = snapshot is not None and snapshot.phase in ("guiding", "captured")
        target = snapshot.target if snapshot is not None and shown else None
        others = () if target is None else target.alternatives[:_AT_MOST]
        self._title.visible = bool(others)
        if target is not None and others:
            self._title.content = _title(target)
        for index, button in enumerate(self._buttons):
            button.visible = index < len(others)
            if index < len(others):
                button.label = alternative_text(others[index])


def alternative_text(other: Target) -> str:
    """How the board is held there, and what comes of it."""
    known = np.isfinite(other.gain_px)
    return f"{other.held}: {px_text(other.predicted_error_px)} px" if known else other.held


def _title(target: Target) -> str:
    known = np.isfinite(target.gain_px)
    instead = f", instead of {px_text(target.predicted_error_px)} px" if known else ""
    return f"<div class='v-progress'><h3>Or nearly as good{instead} (J)</h3></div>"

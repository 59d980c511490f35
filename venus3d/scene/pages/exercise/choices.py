"""Level, help, name and the buttons of a practice page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from venus3d.engine.guidance.exercise import LEVELS
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.view_model import (
    PRACTICE_HELPS,
    ChooseHelp,
    ChooseLevel,
    Climb,
    PracticeMoment,
    Press,
    Rename,
    Wish,
)

_POSE = {say.AGAIN: Press("again"), say.GIVE_UP: Press("give_up")}


class ChoicePanel:
    """The controls of one tab, in the current panel."""

    def __init__(
        self, gui: viser.GuiApi, wish: Callable[[Wish], None], moment: PracticeMoment
    ) -> None:
        """`wish` is called on viser's threads, only for what a person did."""
        self._wish = wish
        self._through = False
        self._shown = (moment.level, moment.help, moment.climb)
        self._next = gui.add_button(say.NEXT, icon=viser.Icon.PLAYER_PLAY, hint=say.NEXT_HINT)
        self._next.on_click(lambda _: wish(Press("next")))
        levels = [say.LEVEL_NAMES[level] for level in LEVELS]
        self._level = gui.add_dropdown(
            say.LEVEL, levels, initial_value=say.LEVEL_NAMES[moment.level], hint=say.LEVEL_HINT
        )
        helps = [say.HELP_NAMES[help_] for help_ in PRACTICE_HELPS]
        self._help = gui.add_dropdown(
            say.HELP, helps, initial_value=say.HELP_NAMES[moment.help], hint=say.HELP_HINT
        )
        self._climb = gui.add_checkbox(say.CLIMB, moment.climb, hint=say.CLIMB_HINT)
        self._look = gui.add_button_group(say.LOOK, say.LOOKS, hint=say.LOOK_HINT)
        self._look.on_click(self._looked)
        pose = gui.add_button_group(say.POSE, (say.AGAIN, say.GIVE_UP), hint=say.POSE_HINT)
        pose.on_click(self._pressed)
        self._name = gui.add_text(say.NAME, "", hint=say.NAME_HINT)
        self._on_change(self._level, lambda: ChooseLevel(LEVELS[levels.index(self._level.value)]))
        self._on_change(
            self._help, lambda: ChooseHelp(PRACTICE_HELPS[helps.index(self._help.value)])
        )
        self._on_change(self._climb, lambda: Climb(bool(self._climb.value)))
        self._on_change(self._name, lambda: Rename(str(self._name.value)))

    def show(self, moment: PracticeMoment) -> None:
        """Let the controls say how things stand."""
        chosen = (moment.level, moment.help, moment.climb)
        if chosen != self._shown:
            # Not otherwise: a choice is in its list before `wish` hears of it.
            self._shown = chosen
            self._level.value = say.LEVEL_NAMES[moment.level]
            self._help.value = say.HELP_NAMES[moment.help]
            self._climb.value = moment.climb
        self._next.disabled = moment.stage != "reached"
        self._through = moment.look == "through"
        outside, through = say.LOOKS
        options = (outside, f"✓ {through}") if self._through else (f"✓ {outside}", through)
        if self._look.options != options:
            self._look.options = options

    def _on_change(self, control: Any, asked: Callable[[], Wish]) -> None:
        # Async, so that what is typed stays in order.
        async def changed(event: Any) -> None:
            if event.client is not None:  # values that the program sets come back without one
                self._wish(asked())

        control.on_update(changed)

    def _pressed(self, event: Any) -> None:
        wish = _POSE.get(str(event.target.value))
        if wish is not None:
            self._wish(wish)

    def _looked(self, event: Any) -> None:
        if str(event.target.value).endswith(say.LOOKS[1]) != self._through:
            self._wish(Press("look"))

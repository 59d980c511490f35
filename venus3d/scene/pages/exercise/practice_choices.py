"""Level, help, name and the buttons of a practice page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from venus3d.engine.guidance.exercise import LEVELS
from venus3d.scene.pages.exercise import practice_texts as say
from venus3d.scene.pages.exercise.view_model import (
    PRACTICE_HELPS,
    Action,
    ChooseHelp,
    ChooseLevel,
    Help,
    PracticeViewModel,
    Press,
    Rename,
    Request,
    SetAutoLevel,
    ViewSide,
)
from venus3d.scene.web.buttons import ButtonRow, ChoiceList

_LEVELS: dict[int, str] = {
    level: say.LEVEL_CHOICE.format(level=level, name=say.LEVEL_NAMES[level]) for level in LEVELS
}
_HELPS: dict[Help, str] = {help_: say.HELP_NAMES[help_] for help_ in PRACTICE_HELPS}
_SIDES: dict[ViewSide, str] = {side: say.VIEW_SIDES[side] for side in ("outside", "through")}
_POSE_ACTIONS: dict[Action, str] = {a: say.POSE_ACTIONS[a] for a in ("start_over", "give_up")}


class PracticeChoices:
    """The controls of one tab, in the current panel."""

    def __init__(
        self, gui: viser.GuiApi, ask: Callable[[Request], None], view: PracticeViewModel
    ) -> None:
        """`ask` is called on viser's threads, only for a person's actions."""
        self._ask = ask
        self._side: ViewSide = view.side
        self._auto_level_shown = view.auto_level
        self._next = gui.add_button(say.NEXT, icon=viser.Icon.PLAYER_PLAY, hint=say.NEXT_HINT)
        self._next.on_click(lambda _: ask(Press("next")))
        self._level = ChoiceList(
            gui,
            say.LEVEL,
            _LEVELS,
            lambda level: ask(ChooseLevel(level)),
            chosen=view.level,
            hint=say.LEVEL_HINT,
        )
        self._help = ChoiceList(
            gui,
            say.HELP,
            _HELPS,
            lambda help_: ask(ChooseHelp(help_)),
            chosen=view.help,
            hint=say.HELP_HINT,
        )
        self._auto_level = gui.add_checkbox(
            say.AUTO_LEVEL, view.auto_level, hint=say.AUTO_LEVEL_HINT
        )
        self._sides = ButtonRow(
            gui, say.VIEW, self._side_labels(), self._side_pressed, hint=say.VIEW_HINT
        )
        ButtonRow(
            gui,
            say.POSE,
            _POSE_ACTIONS,
            lambda action, _: ask(Press(action)),
            hint=say.POSE_HINT,
        )
        self._name = gui.add_text(say.NAME, "", hint=say.NAME_HINT)
        self._on_change(self._auto_level, lambda: SetAutoLevel(bool(self._auto_level.value)))
        self._on_change(self._name, lambda: Rename(str(self._name.value)))

    def show(self, view: PracticeViewModel) -> None:
        """Update the controls."""
        self._level.show(_LEVELS, view.level)
        self._help.show(_HELPS, view.help)
        if view.auto_level != self._auto_level_shown:
            # Only on a change: it is ticked before `ask` is called.
            self._auto_level.value = self._auto_level_shown = view.auto_level
        self._next.disabled = view.stage != "reached"
        self._side = view.side
        self._sides.show(self._side_labels())

    def _side_labels(self) -> dict[ViewSide, str]:
        return {**_SIDES, self._side: say.SHOWN_SIDE.format(side=_SIDES[self._side])}

    def _side_pressed(self, side: ViewSide, _: object) -> None:
        if side != self._side:
            self._ask(Press("view"))

    def _on_change(self, control: Any, request: Callable[[], Request]) -> None:
        # Async, so that typed values stay in order.
        async def changed(event: Any) -> None:
            if event.client is not None:  # values set by the program come back without a client
                self._ask(request())

        control.on_update(changed)

"""Buttons, lists, keys and palette commands of a practice page."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import viser

from venus3d.engine.guidance.exercise import LEVELS
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.page import Ask, press_commands
from venus3d.scene.pages.exercise.view_model import (
    PRACTICE_HELPS,
    Action,
    ChooseHelp,
    ChooseLevel,
    Help,
    Nudge,
    PracticeViewModel,
    Press,
    Rename,
    Request,
    SetAutoLevel,
    ViewSide,
)
from venus3d.scene.web import texts as web_texts
from venus3d.scene.web.board_keys import board_commands
from venus3d.scene.web.buttons import ButtonRow, ChoiceList
from venus3d.scene.web.help import Command
from venus3d.scene.web.keys import KEYS

_KEYS: dict[Action, str] = {
    "next": KEYS["go_on"],
    "give_up": KEYS["other_pose"],
    "start_over": KEYS["reset"],
    "view": KEYS["viewpoint"],
    "surroundings": KEYS["surroundings"],
    "theme": KEYS["theme"],
}


def practice_commands(ask: Ask) -> tuple[Command, ...]:
    """The commands of a practice page; `ask` is called on viser's threads."""
    texts = say.PRACTICE_COMMANDS
    label, description = texts["help"]
    name, level = texts["level"]
    return (
        *press_commands(_KEYS, texts, ask),
        Command(label, KEYS["other_help"], description, partial(ask, ChooseHelp(None))),
        *(
            Command(
                name.format(level=number),
                str(number),
                level.format(name=say.LEVEL_NAMES[number]),
                partial(ask, ChooseLevel(number)),
            )
            for number in LEVELS
        ),
        *board_commands(lambda number, sign: ask(Nudge(number, sign))),
    )


class PracticeControls:
    """The controls of one tab, in the current panel."""

    def __init__(self, gui: viser.GuiApi, ask: Ask, view: PracticeViewModel) -> None:
        """`ask` is called on viser's threads, only for a person's actions."""
        self._ask = ask
        self._side: ViewSide = view.side
        self._auto_level_shown = view.auto_level
        self._next = gui.add_button(say.NEXT, icon=viser.Icon.PLAYER_PLAY, hint=say.NEXT_HINT)
        self._next.on_click(lambda _: ask(Press("next")))
        self._level = ChoiceList(
            gui,
            say.LEVEL,
            _levels(),
            lambda level: ask(ChooseLevel(level)),
            chosen=view.level,
            hint=say.LEVEL_HINT,
        )
        self._help = ChoiceList(
            gui,
            say.HELP,
            _helps(),
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
            say.POSE_ROW,
            _pose_actions(),
            lambda action, _: ask(Press(action)),
            hint=say.POSE_HINT,
        )
        self._name = gui.add_text(say.NAME, "", hint=say.NAME_HINT)
        self._on_change(self._auto_level, SetAutoLevel)
        self._on_change(self._name, Rename)

    def show(self, view: PracticeViewModel) -> None:
        """Update the controls."""
        self._level.show(_levels(), view.level)
        self._help.show(_helps(), view.help)
        if view.auto_level != self._auto_level_shown:
            # Only on a change: it is ticked before `ask` is called.
            self._auto_level.value = self._auto_level_shown = view.auto_level
        self._next.disabled = view.stage != "reached"
        self._side = view.side
        self._sides.show(self._side_labels())

    def _side_labels(self) -> dict[ViewSide, str]:
        sides: dict[ViewSide, str] = {side: say.VIEW_SIDES[side] for side in ("outside", "through")}
        return {**sides, self._side: web_texts.SWITCHED_ON.format(label=sides[self._side])}

    def _side_pressed(self, side: ViewSide, _: object) -> None:
        if side != self._side:
            self._ask(Press("view"))

    def _on_change(self, control: Any, request: Callable[[Any], Request]) -> None:
        # Async, so that typed values stay in order.
        async def changed(event: Any) -> None:
            if event.client is not None:  # values set by the program come back without a client
                self._ask(request(control.value))

        control.on_update(changed)


def _levels() -> dict[int, str]:
    return {n: say.LEVEL_CHOICE.format(level=n, name=say.LEVEL_NAMES[n]) for n in LEVELS}


def _helps() -> dict[Help, str]:
    return {help_: say.PRACTICE_HELP_NAMES[help_] for help_ in PRACTICE_HELPS}


def _pose_actions() -> dict[Action, str]:
    return {action: say.POSE_ACTIONS[action] for action in ("start_over", "give_up")}

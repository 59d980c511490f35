"""Buttons, hotkeys and palette commands of a teaching page."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import viser

from venus3d.lessons.lesson import VIEWPOINTS
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import Action, Answer, Arrange, LookFrom, PageAction, Save
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.help import Command, HelpOverlay, add_commands
from venus3d.scene.web.keys import KEYS

Act = Callable[[Action, viser.ClientHandle | None], None]
"""Called on viser's threads with an action and the tab that asked, or None."""

HOTKEYS: dict[Action, Any] = {
    PageAction.PLAY: KEYS["go_on"],
    PageAction.NEXT_STEP: KEYS["next_step"],
    PageAction.PREVIOUS_STEP: KEYS["previous_step"],
    PageAction.SPEED: KEYS["speed"],
    PageAction.LOOP: KEYS["loop"],
    LookFrom(None): KEYS["viewpoint"],
    **{LookFrom(viewpoint): None for viewpoint in VIEWPOINTS},
    Arrange("strip"): KEYS["steps_apart"],
    Arrange("axes"): KEYS["axes"],
    Arrange("order"): KEYS["order"],
    PageAction.NEXT_ORDER: KEYS["next_order"],
    PageAction.NEXT_PAGE: KEYS["next_page"],
    PageAction.PREVIOUS_PAGE: KEYS["previous_page"],
    PageAction.NEXT_LESSON: KEYS["next_lesson"],
    PageAction.FREE: KEYS["free"],
    PageAction.RESET: KEYS["reset"],
    PageAction.BRIGHTNESS: KEYS["theme"],
    **{Answer(number): str(number) for number in range(1, 6)},
}
STEP_ROW = (PageAction.PREVIOUS_STEP, PageAction.PLAY, PageAction.NEXT_STEP)
TEMPO_ROW = (PageAction.SPEED, PageAction.LOOP)
LOOK_ROW = tuple(LookFrom(viewpoint) for viewpoint in VIEWPOINTS)
SHOW_ROW = (Arrange("strip"), Arrange("axes"), Arrange("order"))
PAGE_ROW = (PageAction.PREVIOUS_PAGE, PageAction.NEXT_PAGE)
MORE_ROW = (PageAction.RESET, PageAction.NEXT_ORDER, PageAction.BRIGHTNESS)


class StateButtons:
    """A row of buttons whose labels follow the page's state."""

    def __init__(
        self, gui: viser.GuiApi, title: str, actions: Iterable[Action], act: Act, hint: str
    ) -> None:
        """Create the row in the current panel."""
        self._actions = tuple(actions)
        self._row = ButtonRow(gui, title, self._labels(TeachState()), act, hint=hint)

    def show(self, state: TeachState) -> None:
        """Update the labels."""
        self._row.show(self._labels(state))

    def _labels(self, state: TeachState) -> dict[Action, str]:
        return {action: label_of(action, state) for action in self._actions}


def make_commands(server: viser.ViserServer, act: Act, saved: Iterable[Save]) -> HelpOverlay:
    """Add every action to the command palette, most with a hotkey; returns the help that lists
    them. `saved` are the available file types."""

    def command(action: Action) -> Command:
        label, description = texts.COMMANDS[action]
        return Command(label, HOTKEYS.get(action), description, partial(act, action, None))

    commands = [command(action) for action in HOTKEYS]
    add_commands(server, commands)
    for action in saved:
        # A file is for the tab that asked, not for the projector.
        commands.append(command(action))
        label, description = texts.COMMANDS[action]
        handle = server.gui.add_command(label, description=description)
        handle.on_trigger(lambda event, action=action: act(action, event.client))
    return HelpOverlay(server, commands)


def label_of(action: Action, state: TeachState) -> str:
    """A button's label, with a tick if it is on."""
    if action is PageAction.PLAY and state.playing:
        return texts.PAUSE
    if action is PageAction.BRIGHTNESS and not state.dark:
        return texts.DARK
    text = texts.LABELS[action].format(speed=texts.SPEED_NAMES[state.speed])
    match action:
        case LookFrom(viewpoint):
            is_on = viewpoint == state.viewpoint
        case Arrange(arrangement):
            is_on = arrangement == state.arrangement
        case _:
            is_on = action is PageAction.LOOP and state.loop
    return texts.IS_ON.format(label=text) if is_on else text

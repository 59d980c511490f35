"""Buttons, hotkeys, palette commands and the menu of a teaching page."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from threading import Lock
from typing import Any

import viser

from venus3d.lessons.lesson import VIEWPOINTS
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import (
    Action,
    Answer,
    Arrange,
    FileKind,
    LookFrom,
    PageAction,
    Save,
)
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.help import Command, HelpOverlay, add_commands
from venus3d.scene.web.keys import KEYS
from venus3d.scene.web.theme import Theme

Act = Callable[[Action], None]
"""Called on viser's threads with an action."""

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
    PageAction.MENU: KEYS["menu"],
    PageAction.SURROUNDINGS: KEYS["surroundings"],
    PageAction.ALL_STEPS: KEYS["all_steps"],
    **{Answer(number): str(number) for number in range(1, 6)},
}
STEP_ROW = (PageAction.PREVIOUS_STEP, PageAction.PLAY, PageAction.NEXT_STEP, PageAction.MENU)
TEMPO_ROW = (PageAction.SPEED, PageAction.LOOP)
LOOK_ROW = tuple(LookFrom(viewpoint) for viewpoint in VIEWPOINTS)
PAGE_ROW = (PageAction.PREVIOUS_PAGE, PageAction.NEXT_PAGE)
SHOW_ROW = (Arrange("strip"), Arrange("axes"), Arrange("order"), PageAction.NEXT_ORDER)
MORE_ROW = (PageAction.RESET, PageAction.FREE, PageAction.BRIGHTNESS)
MENU_ROWS: tuple[tuple[Action, ...], ...] = (SHOW_ROW, TEMPO_ROW, MORE_ROW)


class StateButtons:
    """A row of buttons whose labels follow the page's state."""

    def __init__(
        self, gui: viser.GuiApi, title: str, actions: Iterable[Action], act: Act, hint: str
    ) -> None:
        """Create the row in the current panel."""
        self._actions = tuple(actions)
        labels = labels_of(self._actions, TeachState())
        self._row = ButtonRow(gui, title, labels, lambda action, _: act(action), hint=hint)

    def show(self, state: TeachState, *, visible: bool = True, leads: bool = False) -> None:
        """Update the labels, or hide the row."""
        labels = labels_of(self._actions, state, leads=leads)
        self._row.show(labels if visible else {})


class Menu:
    """The menu of one tab, with what is not needed all the time. It lies over the page until
    something is chosen."""

    def __init__(
        self,
        client: viser.ClientHandle,
        act: Act,
        kinds: tuple[FileKind, ...],
        *others: Command,
    ) -> None:
        """Nothing is open; `kinds` are the available file types, `others` the page's other
        commands."""
        self._client, self._act = client, act
        self._saves = tuple(Save(kind) for kind in kinds)
        self._lock = Lock()
        self._open: tuple[Any, Any] | None = None  # the modal and its style sheet
        self._state, self._theme = TeachState(), Theme(True)
        self._help = self._make_commands(others)

    def show(self, state: TeachState, theme: Theme) -> None:
        """Use this state's labels and these colours from now on."""
        self._state, self._theme = state, theme
        self._help.show(theme)
        with self._lock:
            if self._open is not None and self._open[1].content != theme.sheet:
                self._open[1].content = theme.sheet

    def toggle(self) -> None:
        """Open or close it."""
        with self._lock, self._client.atomic():
            if self._open is not None:
                self._close()
                return
            gui = self._client.gui
            modal = gui.add_modal(texts.MENU_TITLE)
            with modal:
                sheet = gui.add_html(self._theme.sheet)
                said = (
                    (texts.SHOW, texts.SHOW_HINT),
                    (texts.TEMPO, texts.TEMPO_HINT),
                    (texts.MORE_TITLE, texts.MORE_HINT),
                )
                for actions, (title, hint) in zip(MENU_ROWS, said, strict=True):
                    labels = labels_of(actions, self._state)
                    ButtonRow(gui, title, labels, self._chosen, hint=hint)
                if self._saves:
                    labels = labels_of(self._saves, self._state)
                    ButtonRow(gui, texts.SAVE, labels, self._chosen, hint=texts.SAVE_HINT)
                others = {"help": texts.HELP_BUTTON, "close": texts.MENU_CLOSE}
                ButtonRow(gui, texts.MENU_TITLE, others, self._other, hint=texts.MENU_CLOSE_HINT)
            self._open = (modal, sheet)

    def _chosen(self, action: Action, _: object) -> None:
        self.close()
        self._act(action)

    def _other(self, what: str, _: object) -> None:
        self.close()
        if what == "help":
            self._help.toggle(self._client)

    def close(self) -> None:
        """Close it, if it is open."""
        with self._lock:
            self._close()

    def _close(self) -> None:
        if self._open is not None:
            self._open[0].close()
            self._open = None

    def _make_commands(self, others: Iterable[Command]) -> HelpOverlay:
        """Add every action to the command palette, most with a hotkey; the help lists them."""
        actions = (*HOTKEYS, PageAction.LEAD, *self._saves)
        commands = [
            Command(label, HOTKEYS.get(action), description, partial(self._act, action))
            for action in actions
            for label, description in (texts.COMMANDS[action],)
        ]
        commands += others
        add_commands(self._client, commands)
        closes = self._client.gui.add_command(
            texts.MENU_CLOSE, description=texts.MENU_CLOSE_HINT, hotkey="escape"
        )
        closes.on_trigger(lambda _: self.close())
        return HelpOverlay(self._client, commands)


def labels_of(
    actions: Iterable[Action], state: TeachState, *, leads: bool = False
) -> dict[Action, str]:
    """The labels of these actions' buttons; `leads`: whether this tab leads the class."""
    return {action: _label_of(action, state, leads) for action in actions}


def _label_of(action: Action, state: TeachState, leads: bool) -> str:
    """A button's label, with a tick if it is on."""
    if action is PageAction.PLAY and state.playing:
        return texts.PAUSE
    if action is PageAction.BRIGHTNESS and not state.dark:
        return texts.DARK
    if action is PageAction.LEAD and leads:
        return texts.LET_GO
    if action is PageAction.NEXT_PAGE and state.ends_lesson:
        return texts.ON_TO_LESSON
    if isinstance(action, Save):
        return texts.SAVE_LABELS[action.kind]
    text = texts.LABELS[action].format(speed=texts.SPEED_NAMES[state.speed])
    match action:
        case LookFrom(viewpoint):
            is_on = viewpoint == state.viewpoint
        case Arrange(arrangement):
            is_on = arrangement == state.arrangement
        case _:
            is_on = action is PageAction.LOOP and state.loop
    return texts.IS_ON.format(label=text) if is_on else text

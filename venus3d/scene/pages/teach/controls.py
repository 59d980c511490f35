"""Buttons and hotkeys of a teaching page: which action was asked for, and what it changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import viser

from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.web.help import Command, HelpOverlay, add_commands

Act = Callable[[str, Any], None]
"""Called with an action's name and the tab that asked (or None), on viser's threads."""

# W A S D Q E and the arrows fly the browser's camera.
HOTKEYS: dict[str, Any] = {
    "play": "space",
    "next": "N",
    "previous": "P",
    "speed": "Z",
    "loop": "L",
    "outside": "O",
    "camera": "C",
    "holder": "M",
    "above": "V",
    "strip": "T",
    "axes": "X",
    "order": "R",
    "other order": "Y",
    "on": "K",
    "back": "J",
    "lesson": "G",
    "free": "F",
    "reset": "0",
    "theme": "B",
    "answer 1": "1",
    "answer 2": "2",
    "answer 3": "3",
    "answer 4": "4",
    "answer 5": "5",
}
STEP_ROW, TEMPO_ROW = ("previous", "play", "next"), ("speed", "loop")
LOOK_ROW = ("outside", "camera", "holder", "above")
SHOW_ROW = ("strip", "axes", "order")
PAGE_ROW, MORE_ROW = ("back", "on"), ("reset", "other order", "theme")


class ButtonRow:
    """Buttons side by side whose labels follow the state."""

    def __init__(
        self, gui: viser.GuiApi, label: str, actions: Sequence[str], act: Act, hint: str
    ) -> None:
        """Make the row in the current panel."""
        self._actions = tuple(actions)
        self._labels = tuple(label_of(action, TeachState()) for action in actions)
        self._group: Any = gui.add_button_group(label, self._labels, hint=hint)

        def clicked(event: Any) -> None:
            # The label may have changed meanwhile; all labels of an action end alike.
            pressed = str(event.target.value).split()[-1]
            for action, shown in zip(self._actions, self._labels, strict=True):
                if shown.split()[-1] == pressed:
                    act(action, event.client)

        self._group.on_click(clicked)

    def show(self, state: TeachState) -> None:
        """Let the labels say what is on."""
        labels = tuple(label_of(action, state) for action in self._actions)
        if labels != self._labels:
            self._labels = labels
            self._group.options = labels

    @property
    def handle(self) -> Any:
        """viser's group."""
        return self._group


def make_commands(server: viser.ViserServer, act: Act, kinds: Sequence[str]) -> HelpOverlay:
    """Every action in the command palette, most with a hotkey; returns the help that lists them.

    `kinds` are the kinds of file that can be saved.
    """
    saving = [f"save {kind}" for kind in kinds]
    commands = {
        action: Command(label, HOTKEYS.get(action), description, partial(act, action, None))
        for action, (label, description) in texts.COMMANDS.items()
        if action in HOTKEYS or action in saving
    }
    add_commands(server, [commands[action] for action in commands if action in HOTKEYS])
    for action in saving:
        # A file is for the tab that asked, not for the projector.
        command = commands[action]
        handle = server.gui.add_command(command.label, description=command.description)

        def triggered(event: Any, action: str = action) -> None:
            act(action, event.client)

        handle.on_trigger(triggered)
    return HelpOverlay(server, tuple(commands.values()))


def label_of(action: str, state: TeachState) -> str:
    """A button's text: a tick says that it is on."""
    if action == "play":
        return texts.LABELS["pause" if state.playing else "play"]
    if action == "theme":
        return texts.LABELS["theme" if state.dark else "theme dark"]
    text = texts.LABELS[action].format(speed=texts.SPEED_NAMES.get(state.speed, ""))
    on = {
        "loop": state.loop,
        "strip": state.arrangement == "strip",
        "axes": state.arrangement == "axes",
        "order": state.arrangement == "order",
        state.viewpoint: True,
    }
    return f"✓ {text}" if on.get(action, False) else text


def after_action(state: TeachState, action: str) -> TeachState:
    """What is shown once that was asked for; the same state if it is no matter of the state."""
    simple: dict[str, Callable[[], TeachState]] = {
        "play": lambda: state.play(not state.playing),
        "next": state.step_on,
        "previous": state.step_back,
        "speed": state.faster,
        "loop": lambda: replace(state, loop=not state.loop),
        "strip": lambda: state.arranged("strip"),
        "axes": lambda: state.arranged("axes"),
        "order": lambda: state.arranged("order"),
        "other order": state.next_order,
        "on": lambda: state.turned(1),
        "back": lambda: state.turned(-1),
        "lesson": state.next_lesson,
        "free": lambda: state.opened(None),
        "reset": state.reset,
        "theme": lambda: replace(state, dark=not state.dark),
        "outside": lambda: replace(state, viewpoint="outside"),
        "camera": lambda: replace(state, viewpoint="camera"),
        "holder": lambda: replace(state, viewpoint="holder"),
        "above": lambda: replace(state, viewpoint="above"),
    }
    if action in simple:
        return simple[action]()
    if action.startswith("answer "):
        return state.answered(int(action.split()[1]))
    return state

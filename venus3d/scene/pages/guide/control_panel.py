"""Buttons and commands: which action was asked for, and what it changes in the view, if anything.

Only what still makes sense is shown: with no target there are no steps to look at, and once the
person has ended the calibration nothing is captured any more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Literal

import viser

from venus3d.engine.guidance.phase import Phase
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.help import Command

Action = Literal[
    "capture",
    "skip",
    "undo",
    "previous",
    "next",
    "play",
    "strip",
    "follow",
    "theme",
    "pause",
    "autopilot",
    "finish",
]
# Letters that fly the browser's camera (W A S D Q E) and the arrows are not ours to take. Finish
# has none: it cannot be taken back.
_KEYS: dict[Action, str | None] = {
    "capture": "C",
    "skip": "K",
    "undo": "U",
    "previous": "P",
    "next": "N",
    "play": "L",
    "strip": "T",
    "follow": "F",
    "theme": "B",
    "pause": "space",
    "finish": None,
    "autopilot": "O",
}
_ROWS: dict[str, tuple[Action, ...]] = {
    "view": ("skip", "undo", "finish"),
    "step": ("previous", "play", "next"),
    "show": ("follow", "strip", "theme"),
    "run": ("pause", "autopilot"),
}
_WITH_A_TARGET: frozenset[Action] = frozenset(
    ("skip", "previous", "play", "next", "follow", "strip")
)
_TO_END: frozenset[Action] = frozenset(("capture", "undo", "finish"))


class ControlPanel:
    """The controls of one server. `act` is called on viser's threads."""

    def __init__(
        self, gui: viser.GuiApi, act: Callable[[Action], None], *, simulated: bool
    ) -> None:
        """Make the buttons in the current panel."""
        self._act, self._simulated = act, simulated
        self._capture = gui.add_button(say.CAPTURE, icon=viser.Icon.CAMERA, hint=say.CAPTURE_HINT)
        self._capture.on_click(lambda _: act("capture"))
        self._rows = [self._row(gui, name, row) for name, row in _ROWS.items()]

    @property
    def commands(self) -> tuple[Command, ...]:
        """The same actions by key and by name."""
        return tuple(self._command(action) for action in self._offered(_KEYS))

    def show(self, state: ViewState, phase: Phase = "startup") -> None:
        """Let the buttons say what is on, and go when there is nothing to do with them."""
        makes_sense = useful_in(phase)
        self._capture.visible = makes_sense("capture")
        for actions, row in zip(_ROWS.values(), self._rows, strict=True):
            row.show({a: _label(a, state) for a in self._offered(actions) if makes_sense(a)})

    def _offered(self, row: Iterable[Action]) -> list[Action]:
        return [action for action in row if self._simulated or action != "autopilot"]

    def _row(self, gui: viser.GuiApi, name: str, actions: tuple[Action, ...]) -> ButtonRow[Action]:
        labels: dict[Action, str] = {
            action: _label(action, ViewState()) for action in self._offered(actions)
        }
        title, hint = say.ROWS[name]
        hint += say.AUTOPILOT_HINT if "autopilot" in labels else ""
        return ButtonRow(gui, title, labels, lambda action, _: self._act(action), hint=hint)

    def _command(self, action: Action) -> Command:
        label, description = say.COMMANDS[action]
        return Command(label, _KEYS[action], description, lambda: self._act(action))


def useful_in(phase: Phase) -> Callable[[Action], bool]:
    """Whether an action can do anything in this phase."""
    hidden: frozenset[Action] = frozenset()
    if phase in ("converged", "finished"):
        hidden = _WITH_A_TARGET if phase == "converged" else _WITH_A_TARGET | _TO_END
    return lambda action: action not in hidden


def _label(action: Action, state: ViewState) -> str:
    names = say.BUTTONS[action]
    other = {"play": state.playing, "theme": not state.dark, "pause": state.paused}
    if action in other:
        return names[1] if other[action] else names[0]
    on = {"follow": state.follow, "strip": state.strip, "autopilot": state.autopilot}
    return ("✓ " if on.get(action) else "") + names[0]


def after_action(state: ViewState, action: Action) -> ViewState:
    """What is shown once that was asked for."""
    if action == "previous":
        return state.turned_to(state.step - 1)
    if action == "next":
        return state.turned_to(state.step + 1)
    if action == "play":
        return state.play(not state.playing)
    if action == "follow":
        return state.following(not state.follow)
    if action == "strip":
        return replace(state, strip=not state.strip)
    if action == "theme":
        return replace(state, dark=not state.dark)
    if action == "pause":
        return replace(state, paused=not state.paused)
    return replace(state, autopilot=not state.autopilot)

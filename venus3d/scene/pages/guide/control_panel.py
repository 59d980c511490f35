"""Buttons and commands of a guided calibration, their intents, and when they are shown. Only useful
ones are shown: no steps without a target, no capture after the end."""

from __future__ import annotations

from collections.abc import Callable

import viser

from venus3d.engine.guidance.prompts import Phase
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import (
    Intent,
    NudgeBoard,
    PageAction,
    Straighten,
    Toggle,
    TurnStep,
)
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.web import texts as web_texts
from venus3d.scene.web.board_keys import board_commands
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.help import Command
from venus3d.scene.web.keys import KEYS

# By the names of their texts, with their keys. What begins anew has no key.
CONTROLS: dict[str, tuple[Intent, str | None]] = {
    "capture": (PageAction.CAPTURE, KEYS["capture"]),
    "skip": (PageAction.SKIP_TARGET, KEYS["other_pose"]),
    "undo": (PageAction.UNDO_VIEW, KEYS["undo"]),
    "previous": (TurnStep(-1), KEYS["previous_step"]),
    "next": (TurnStep(1), KEYS["next_step"]),
    "play": (Toggle("playing"), KEYS["play_steps"]),
    "strip": (Toggle("strip"), KEYS["steps_apart"]),
    "all_steps": (Toggle("all_steps"), KEYS["all_steps"]),
    "surroundings": (Toggle("surroundings"), KEYS["surroundings"]),
    "follow": (Toggle("follow"), KEYS["follow"]),
    "theme": (Toggle("dark"), KEYS["theme"]),
    "words": (Toggle("camera_words"), KEYS["words"]),
    "built": (Toggle("built"), None),
    "pause": (Toggle("paused"), KEYS["go_on"]),
    "straight": (Toggle("straight"), KEYS["straight"]),
    "finish": (PageAction.FINISH, KEYS["finish"]),
    "go_on": (PageAction.GO_ON, KEYS["resume"]),
    "new": (PageAction.NEW_SESSION, None),
    "autopilot": (Toggle("autopilot"), KEYS["autopilot"]),
    "explain": (Toggle("explain"), KEYS["explain"]),
}
_ROWS: dict[str, tuple[str, ...]] = {
    "view": ("skip", "undo", "finish"),
    "step": ("previous", "play", "next"),
    "show": ("follow", "strip", "theme"),
    "run": ("pause", "straight", "autopilot"),
    "explain": ("words", "built", "explain"),
}
_WITH_A_TARGET = frozenset(
    ("skip", "previous", "play", "next", "follow", "strip", "all_steps", "words", "built")
)
_OF_A_SESSION = frozenset(
    ("capture", "skip", "undo", "finish", "go_on", "new", "pause", "autopilot")
)
"""What a session does that is not one of a record."""
_TO_END = frozenset(("capture", "finish"))


class ControlPanel:
    """The controls of one server. `ask` is called on viser's threads."""

    def __init__(
        self,
        gui: viser.GuiApi,
        ask: Callable[[Intent], None],
        *,
        simulated: bool,
        recorded: bool = False,
    ) -> None:
        """Create the buttons in the current panel; `recorded`: only those that change what is
        seen."""
        self._ask, self._simulated = ask, simulated
        self._offered = CONTROLS.keys() - (set() if simulated else {"autopilot"})
        self._offered -= _OF_A_SESSION if recorded else set()
        self._capture = gui.add_button(say.CAPTURE, icon=viser.Icon.CAMERA, hint=say.CAPTURE_HINT)
        self._capture.on_click(lambda _: ask(PageAction.CAPTURE))
        self._compared = gui.add_slider(
            say.COMPARED, min=0, max=100, step=1, initial_value=50, hint=say.COMPARED_HINT
        )
        self._compared.visible = False
        self._compared_shown = 50
        self._shown: tuple[ViewState, Phase, bool] | None = None
        self._compared.on_update(self._compared_to)
        self._rows = {
            name: self._row(gui, name)
            for name, row in _ROWS.items()
            if self._offered.intersection(row)
        }

    @property
    def commands(self) -> tuple[Command, ...]:
        """The same as commands, with keys."""
        moves: tuple[Command, ...] = ()
        if self._simulated:
            moves = board_commands(lambda number, sign: self._ask(NudgeBoard(number, sign)))
        ours = (
            Command(*_command_texts(name, key), lambda intent=intent: self._ask(intent))
            for name, (intent, key) in CONTROLS.items()
            if name in self._offered
        )
        return (*ours, *moves)

    def show(self, state: ViewState, phase: Phase = "startup", *, known: bool = False) -> None:
        """Update the buttons; hide those without a use. `known`: whether the lens is."""
        if self._shown == (state, phase, known):
            return
        self._shown = state, phase, known
        self._compared.visible = known and state.over
        share = round(100 * state.straight_share)
        if state.over and share != self._compared_shown:  # a person's is shown before it is here
            self._compared_shown = self._compared.value = share
        useful = useful_in(phase, known=known) & self._offered
        self._capture.visible = "capture" in useful
        for name, row in self._rows.items():
            row.show(self._labels(name, state, useful))

    def _compared_to(self, event: viser.GuiEvent[viser.GuiSliderHandle[int]]) -> None:
        if event.client is not None:
            self._compared_shown = event.target.value
            self._ask(Straighten(event.target.value / 100))

    def _row(self, gui: viser.GuiApi, name: str) -> ButtonRow[Intent]:
        title, hint = say.ROWS[name]
        if "autopilot" in self._offered.intersection(_ROWS[name]):
            hint += say.AUTOPILOT_HINT
        labels = self._labels(name, ViewState(), useful_in("startup"))
        return ButtonRow(gui, title, labels, lambda intent, _: self._ask(intent), hint=hint)

    def _labels(self, row: str, state: ViewState, useful: frozenset[str]) -> dict[Intent, str]:
        shown = useful & self._offered
        return {CONTROLS[name][0]: _label(name, state) for name in _ROWS[row] if name in shown}


def useful_in(phase: Phase, *, known: bool = True) -> frozenset[str]:
    """Names of the controls that are useful in this phase; `known`: whether the lens is."""
    useful = frozenset(CONTROLS) if known else frozenset(CONTROLS) - {"straight"}
    if phase in ("converged", "finished"):
        useful -= _WITH_A_TARGET | _TO_END | {"autopilot"}
    return useful - {"undo"} if phase == "finished" else useful


def _command_texts(name: str, key: str | None) -> tuple[str, str | None, str]:
    label, description = say.COMMANDS[name]
    return label, key, description


def _label(name: str, state: ViewState) -> str:
    names = say.BUTTONS[name]
    other = {
        "play": state.playing,
        "theme": not state.dark,
        "pause": state.paused,
        "words": state.camera_words,
    }
    if name in other:
        return names[1] if other[name] else names[0]
    switches = ("follow", "strip", "autopilot", "straight", "built", "explain")
    on = {name: getattr(state, name) for name in switches}
    return web_texts.SWITCHED_ON.format(label=names[0]) if on.get(name) else names[0]

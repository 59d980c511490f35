"""Buttons and hotkeys: which action was asked for, and what it changes in the view, if anything."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal

import viser

from venus3d.scene.guide.view_state import ViewState

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

# Letters that fly the browser's camera (W A S D Q E) and the arrows are not ours to take.
_COMMANDS: tuple[tuple[Action, str, Any, str], ...] = (
    ("capture", "Capture this view", "C", "Take the picture as it is now"),
    ("skip", "Skip this target", "K", "Ask for another pose"),
    ("undo", "Undo the last view", "U", "Take back what was captured last"),
    ("previous", "Previous step", "P", "Show the step before"),
    ("next", "Next step", "N", "Show the step after"),
    ("play", "Play the steps", "L", "Show the four steps as an animation"),
    ("strip", "Steps side by side", "T", "Spread the four steps out, or put them back"),
    ("follow", "Follow the board's step", "F", "Show the step that the board is on"),
    ("theme", "Light or dark", "B", "Change the page's brightness"),
    ("pause", "Pause", "space", "Stop taking pictures, or go on"),
    ("finish", "Finish", None, "End the calibration and keep the result"),
)
_AUTOPILOT: tuple[Action, str, Any, str] = (
    "autopilot",
    "Autopilot",
    "O",
    "Let the simulated hand move the board",
)


class ControlPanel:
    """The controls of one server. `act` is called on viser's threads."""

    def __init__(
        self, server: viser.ViserServer, act: Callable[[Action], None], *, simulated: bool
    ) -> None:
        """Make the buttons in the current panel, and the hotkeys."""
        self._act = act
        self._simulated = simulated
        self._gui = server.gui
        self._groups: list[tuple[tuple[Action, ...], Any]] = []
        capture = self._gui.add_button(
            "Capture this view (C)",
            icon=viser.Icon.CAMERA,
            hint="Take the picture as it is now. It is also taken by itself when the board is "
            "where it should be and still.",
        )
        capture.on_click(lambda _: act("capture"))
        self._group("View", ("skip", "undo", "finish"), "Another target; take back; end")
        self._group("Step", ("previous", "play", "next"), "Look at each of the four steps")
        self._group("Show", ("follow", "strip", "theme"), "What the scene shows")
        last: tuple[Action, ...] = ("pause", "autopilot") if simulated else ("pause",)
        self._group("Run", last, "Stop and go on; who moves the simulated board")
        for action, label, hotkey, description in (
            *_COMMANDS,
            *((_AUTOPILOT,) if simulated else ()),
        ):
            self._command(action, label, hotkey, description)
        self.show(ViewState())

    def show(self, state: ViewState) -> None:
        """Let the buttons say what is on."""
        for actions, group in self._groups:
            options = tuple(_label(action, state) for action in actions)
            if group.options != options:
                group.options = options

    def _group(self, label: str, actions: tuple[Action, ...], hint: str) -> None:
        group = self._gui.add_button_group(
            label, [_label(action, ViewState()) for action in actions], hint=hint
        )
        self._groups.append((actions, group))

        def clicked(event: Any) -> None:
            for action in actions:
                # The label changes with the state, its first word does not.
                if _bare(str(event.target.value)) in _names(action):
                    self._act(action)

        group.on_click(clicked)

    def _command(self, action: Action, label: str, hotkey: Any, description: str) -> None:
        command = self._gui.add_command(label, description=description, hotkey=hotkey)
        command.on_trigger(lambda _: self._act(action))


def _names(action: Action) -> tuple[str, ...]:
    return {
        "capture": ("Capture C",),
        "skip": ("Skip target K",),
        "undo": ("Undo view U",),
        "finish": ("Finish",),
        "previous": ("Previous P",),
        "play": ("Play L", "Stop L"),
        "next": ("Next N",),
        "follow": ("Follow F",),
        "strip": ("Side by side T",),
        "theme": ("Light B", "Dark B"),
        "pause": ("Pause ␣", "Go on ␣"),
        "autopilot": ("Autopilot O",),
    }[action]


def _bare(label: str) -> str:
    return label.removeprefix("✓ ")


def _label(action: Action, state: ViewState) -> str:
    names = _names(action)
    on = {
        "follow": state.follow,
        "strip": state.strip,
        "autopilot": state.autopilot,
    }.get(action, False)
    other = {"play": state.playing, "theme": not state.dark, "pause": state.paused}
    if action in other:
        return names[1] if other[action] else names[0]
    return ("✓ " if on else "") + names[0]


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

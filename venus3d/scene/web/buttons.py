"""Button rows and selection lists whose entries stand for actions, not for their labels.

    ButtonRow(gui, "Step", {"back": "Back P", "on": "Next N"}, lambda action, tab: ..., hint="...")

viser identifies a click by its label. So that labels may be translated, equal, or changed while a
click is on its way, a label that another action has or had gets an invisible suffix, and clicks are
looked up.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, Generic, TypeVar

import viser

Action = TypeVar("Action", bound=Hashable)
_INVISIBLE = "\u200b"  # a zero-width space


class _Labelled(Generic[Action]):
    """A widget, its labels as sent to viser, and the action that each has stood for."""

    _widget: Any

    def __init__(self) -> None:
        self._actions: dict[str, Action] = {}

    @property
    def visible(self) -> bool:
        """Whether the widget is shown."""
        return bool(self._widget.visible)

    @visible.setter
    def visible(self, on: bool) -> None:
        self._widget.visible = on

    def _label(self, action: Action, text: str) -> str:
        while self._actions.setdefault(text, action) != action:
            text += _INVISIBLE
        return text

    def _labels(self, shown: Mapping[Action, str]) -> tuple[str, ...]:
        return tuple(self._label(action, text) for action, text in shown.items())

    def _action(self, label: object) -> Action | None:
        """The label's action; None if it never was a label, since a browser may send anything."""
        return self._actions.get(label) if isinstance(label, str) else None


class ButtonRow(_Labelled[Action]):
    """Buttons side by side in the current panel, one per action."""

    def __init__(
        self,
        gui: viser.GuiApi,
        title: str,
        labels: Mapping[Action, str],
        on_press: Callable[[Action, viser.ClientHandle | None], None],
        *,
        hint: str | None = None,
    ) -> None:
        """Make the row.

        Args:
            labels: the label of each action's button, in order.
            on_press: called on viser's threads with the action and the tab.
            hint: what the row is for.
        """
        super().__init__()
        self._widget = gui.add_button_group(title, self._labels(labels), hint=hint)

        def clicked(event: Any) -> None:
            action = self._action(event.target.value)
            if action is not None:
                on_press(action, event.client)

        self._widget.on_click(clicked)

    def show(self, labels: Mapping[Action, str]) -> None:
        """Show these of the row's actions with these labels; with none, the row is hidden."""
        options = self._labels(labels)
        self._widget.visible = bool(options)
        if options and options != self._widget.options:
            self._widget.options = options


class ChoiceList(_Labelled[Action]):
    """A list in the current panel with one chosen entry."""

    def __init__(
        self,
        gui: viser.GuiApi,
        title: str,
        labels: Mapping[Action, str],
        on_choice: Callable[[Action], None],
        *,
        chosen: Action | None = None,
        hint: str | None = None,
        visible: bool = True,
    ) -> None:
        """Make the list.

        Args:
            labels: each entry's label, in order.
            on_choice: called on viser's threads when a person has chosen, not at `show`.
            chosen: the initial entry; by default the first.
        """
        super().__init__()
        self._shown: tuple[tuple[str, ...], str] = (self._labels(labels), "")
        first = next(iter(labels)) if chosen is None else chosen
        self._widget = gui.add_dropdown(
            title,
            self._shown[0],
            initial_value=self._label(first, labels[first]),
            hint=hint,
            visible=visible,
        )

        def updated(event: Any) -> None:
            entry = self._action(event.target.value)
            if event.client is not None and entry is not None:
                on_choice(entry)

        self._widget.on_update(updated)

    @property
    def chosen(self) -> Action | None:
        """The chosen entry."""
        return self._action(self._widget.value)

    def show(self, labels: Mapping[Action, str], chosen: Action, *, again: bool = False) -> None:
        """Show these entries with this one chosen, unless they were shown last: a person's choice
        is in the list before `on_choice` is called, and must not be put back. `again` does put it
        back."""
        options, value = self._labels(labels), self._label(chosen, labels[chosen])
        if (options, value) != self._shown or again:
            if options != self._widget.options:
                self._widget.options = options
            if value != self._widget.value:
                self._widget.value = value
            self._shown = (options, value)

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


class _Labels(Generic[Action]):
    """The labels as sent to viser, and the action that each has stood for."""

    def __init__(self) -> None:
        self._actions: dict[str, Action] = {}

    def label(self, action: Action, text: str) -> str:
        while self._actions.setdefault(text, action) != action:
            text += _INVISIBLE
        return text

    def labels(self, shown: Mapping[Action, str]) -> tuple[str, ...]:
        return tuple(self.label(action, text) for action, text in shown.items())

    def action(self, label: object) -> Action | None:
        """The label's action; None if it never was a label, since a browser may send anything."""
        return self._actions.get(label) if isinstance(label, str) else None


class ButtonRow(Generic[Action]):
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
        self._labels: _Labels[Action] = _Labels()
        self._group: Any = gui.add_button_group(title, self._labels.labels(labels), hint=hint)

        def clicked(event: Any) -> None:
            action = self._labels.action(event.target.value)
            if action is not None:
                on_press(action, event.client)

        self._group.on_click(clicked)

    @property
    def visible(self) -> bool:
        """Whether the row is shown."""
        return bool(self._group.visible)

    @visible.setter
    def visible(self, on: bool) -> None:
        self._group.visible = on

    def show(self, labels: Mapping[Action, str]) -> None:
        """Show these of the row's actions with these labels; with none, the row is hidden."""
        options = self._labels.labels(labels)
        self._group.visible = bool(options)
        if options and options != self._group.options:
            self._group.options = options


class ChoiceList(Generic[Action]):
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
        self._labels: _Labels[Action] = _Labels()
        self._shown: tuple[tuple[str, ...], str] = (self._labels.labels(labels), "")
        first = next(iter(labels)) if chosen is None else chosen
        self._list: Any = gui.add_dropdown(
            title,
            self._shown[0],
            initial_value=self._labels.label(first, labels[first]),
            hint=hint,
            visible=visible,
        )

        def updated(event: Any) -> None:
            entry = self._labels.action(event.target.value)
            if event.client is not None and entry is not None:
                on_choice(entry)

        self._list.on_update(updated)

    @property
    def chosen(self) -> Action | None:
        """The chosen entry."""
        return self._labels.action(self._list.value)

    @property
    def visible(self) -> bool:
        """Whether the list is shown."""
        return bool(self._list.visible)

    @visible.setter
    def visible(self, on: bool) -> None:
        self._list.visible = on

    def show(self, labels: Mapping[Action, str], chosen: Action, *, again: bool = False) -> None:
        """Show these entries with this one chosen, unless they were shown last: a person's choice
        is in the list before `on_choice` is called, and must not be put back. `again` does put it
        back."""
        options, value = self._labels.labels(labels), self._labels.label(chosen, labels[chosen])
        if (options, value) != self._shown or again:
            if options != self._list.options:
                self._list.options = options
            if value != self._list.value:
                self._list.value = value
            self._shown = (options, value)

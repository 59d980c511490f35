"""Rows of buttons and lists to choose from that stand for actions, not for their labels.

    ButtonRow(gui, "Step", {"back": "Back P", "on": "Next N"}, lambda action, tab: ..., hint="...")

viser tells a click by the label of what was clicked. So that labels can be translated, changed
while a click is on its way, and be equal to each other, each label gets an invisible ending that is
its own, and what comes back is looked up.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, Generic, TypeVar

import viser

Action = TypeVar("Action", bound=Hashable)
_INVISIBLE = "\u200b"  # a zero-width space


class _Labels(Generic[Action]):
    """The labels as viser gets them, and which action each has stood for."""

    def __init__(self, actions: Mapping[Action, str]) -> None:
        self._endings = {action: _INVISIBLE * index for index, action in enumerate(actions)}
        self._actions: dict[str, Action] = {}

    def label(self, action: Action, text: str) -> str:
        label = text.rstrip(_INVISIBLE) + self._endings[action]
        self._actions[label] = action
        return label

    def labels(self, shown: Mapping[Action, str]) -> tuple[str, ...]:
        return tuple(self.label(action, text) for action, text in shown.items())

    def action(self, label: object) -> Action | None:
        """None for what was never a label: a browser may send anything."""
        return self._actions.get(label) if isinstance(label, str) else None


class ButtonRow(Generic[Action]):
    """Buttons side by side in the current panel, one for each action."""

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
            labels: what stands on each action's button, in the order of the buttons.
            on_press: called on viser's threads with the action and the tab it was pressed in.
            hint: what the row is for.
        """
        self._labels = _Labels(labels)
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
    """A list in the current panel of which one entry is chosen."""

    def __init__(
        self,
        gui: viser.GuiApi,
        title: str,
        labels: Mapping[Action, str],
        on_choice: Callable[[Action], None],
        *,
        chosen: Action | None = None,
        hint: str | None = None,
    ) -> None:
        """Make the list.

        Args:
            labels: what stands for each entry, in order.
            on_choice: called on viser's threads when a person has chosen, not when `chosen` is set.
            chosen: the entry chosen at first; by default the first.
        """
        self._labels, self._texts = _Labels(labels), dict(labels)
        options = self._labels.labels(labels)
        first = next(iter(labels)) if chosen is None else chosen
        self._list: Any = gui.add_dropdown(
            title, options, initial_value=self._labels.label(first, self._texts[first]), hint=hint
        )

        def updated(event: Any) -> None:
            entry = self._labels.action(event.target.value)
            if event.client is not None and entry is not None:
                on_choice(entry)

        self._list.on_update(updated)

    @property
    def chosen(self) -> Action | None:
        """The entry that is chosen."""
        return self._labels.action(self._list.value)

    @chosen.setter
    def chosen(self, entry: Action) -> None:
        label = self._labels.label(entry, self._texts[entry])
        if self._list.value != label:
            self._list.value = label

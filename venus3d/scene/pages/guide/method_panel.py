"""How the next pose is found, ours or the paper's, as a list and as commands. Other methods and
costs are for research and set on the command line; one set there is listed too. The list shows the
session's method, not the click: a refused choice reverts by itself."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import NamedTuple

import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.settings import DEFAULT_COST, Cost, Method
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import ChangeMethod, Intent
from venus3d.scene.web.buttons import ChoiceList
from venus3d.scene.web.help import Command


class _Entry(NamedTuple):
    method: Method
    cost: Cost

    @property
    def label(self) -> str:
        words = say.METHOD_WORDS[self.method]
        if self.cost == DEFAULT_COST[self.method]:
            return words
        return say.METHOD_WITH_COST.format(method=words, cost=say.COST_WORDS[self.cost])


OFFERED: tuple[Method, ...] = ("global", "venus")
_OFFERED = tuple(_Entry(method, DEFAULT_COST[method]) for method in OFFERED)
# Seconds for which a choice is not reverted, until the session has answered.
_ON_ITS_WAY_S = 1.0


class MethodPanel:
    """The list of one server. `ask` is called on viser's threads."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Create the list in the current panel, folded."""
        self._ask = ask
        self._shown = _OFFERED[0]
        self._entries = _OFFERED
        self._picked: float | None = None
        with gui.add_folder(say.METHOD_FOLDER, expand_by_default=False):
            labels = {entry: entry.label for entry in _OFFERED}
            self._list = ChoiceList(gui, say.METHOD, labels, self._pick, hint=say.METHOD_HINT)

    @property
    def commands(self) -> tuple[Command, ...]:
        """The same choices as commands."""
        return tuple(
            Command(
                say.METHOD_COMMAND.format(words=entry.label),
                None,
                say.METHOD_FOLDER,
                lambda entry=entry: self._pick(entry),
            )
            for entry in _OFFERED
        )

    def show(self, snapshot: Snapshot) -> None:
        """Update the list to the session's method, if that has changed or a while after a choice: a
        choice is in the list before `_pick` is called and must not be reverted meanwhile."""
        now, found = monotonic(), _Entry(snapshot.method, snapshot.cost)
        is_due = self._picked is not None and now - self._picked >= _ON_ITS_WAY_S
        if found == self._shown and not is_due:
            return
        self._shown, self._picked = found, None
        if found not in self._entries:  # the command line's choice stays in the list
            self._entries = (*_OFFERED, found)
        self._list.show({entry: entry.label for entry in self._entries}, found, again=True)

    def _pick(self, entry: _Entry) -> None:
        self._picked = monotonic()
        own = entry.cost == DEFAULT_COST[entry.method]
        self._ask(ChangeMethod(entry.method, None if own else entry.cost))

"""How the next pose is found: our method or the paper's, in a list and in the command palette.

Other methods and costs are for research and chosen on the command line; one that was chosen there
stands in the list as well. The list shows what the session does, not what was clicked: a choice
that is refused goes back by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import NamedTuple

import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.method import DEFAULT_COST, Cost, Method
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
# A choice is on its way to the session and back for so long; until then it is not put back.
_ON_ITS_WAY_S = 1.0


class MethodPanel:
    """The list of one server. `ask` is called on viser's threads."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Make the list in the current panel, folded away."""
        self._ask = ask
        self._shown = _OFFERED[0]
        self._picked: float | None = None
        with gui.add_folder(say.METHOD_FOLDER, expand_by_default=False):
            labels = {entry: entry.label for entry in _OFFERED}
            self._list = ChoiceList(gui, say.METHOD, labels, self._pick, hint=say.METHOD_HINT)

    @property
    def commands(self) -> tuple[Command, ...]:
        """The same choices, by their names."""
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
        """Let the list say how the session finds its poses.

        Only when that has changed, or a while after somebody picked: what was picked this moment is
        in the list before `_pick` hears of it, and must not be put back meanwhile.
        """
        now, found = monotonic(), _Entry(snapshot.method, snapshot.cost)
        is_due = self._picked is not None and now - self._picked >= _ON_ITS_WAY_S
        if found == self._shown and not is_due:
            return
        self._shown, self._picked = found, None
        entries = _OFFERED if found in _OFFERED else (*_OFFERED, found)
        self._list.show({entry: entry.label for entry in entries}, found, again=True)

    def _pick(self, entry: _Entry) -> None:
        self._picked = monotonic()
        own = entry.cost == DEFAULT_COST[entry.method]
        self._ask(ChangeMethod(entry.method, None if own else entry.cost))

"""How the next pose is found: two lists to choose from, and the same in the command palette.

They show what the session does, not what was clicked: a choice that is refused goes back by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic
from typing import Any

import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.method import COSTS, METHODS, Cost, Method
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import ChangeMethod, Intent
from venus3d.scene.web.help import Command

# A choice is on its way to the session and back for so long; until then it is not put back.
_ON_ITS_WAY_S = 1.0


class MethodPanel:
    """The two lists of one server. `ask` is called on viser's threads."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Make the lists in the current panel, folded away."""
        self._ask = ask
        self._shown: tuple[str, str] | None = None
        self._picked: float | None = None
        with gui.add_folder(say.METHOD_FOLDER, expand_by_default=False):
            self._method = gui.add_dropdown(
                say.METHOD, list(say.METHOD_WORDS.values()), hint=say.METHOD_HINT
            )
            self._cost = gui.add_dropdown(
                say.COST, list(say.COST_WORDS.values()), hint=say.COST_HINT
            )
        self._method.on_update(lambda event: self._pick(event, None))
        self._cost.on_update(lambda event: self._pick(event, _cost_of(str(self._cost.value))))

    @property
    def commands(self) -> tuple[Command, ...]:
        """The same choices, by their names."""
        methods = (
            self._command(say.METHOD_COMMAND.format(words=say.METHOD_WORDS[method]), method, None)
            for method in METHODS
        )
        costs = (
            self._command(say.COST_COMMAND.format(words=say.COST_WORDS[cost]), None, cost)
            for cost in COSTS
        )
        return (*methods, *costs)

    def show(self, snapshot: Snapshot) -> None:
        """Let the lists say how the session finds its poses.

        Only when that has changed, or a while after somebody picked: what was picked this moment is
        in the list before `_pick` hears of it, and must not be put back meanwhile.
        """
        now, found = monotonic(), (snapshot.method, snapshot.cost)
        is_due = self._picked is not None and now - self._picked >= _ON_ITS_WAY_S
        if found == self._shown and not is_due:
            return
        self._shown, self._picked = found, None
        self._method.value = say.METHOD_WORDS[snapshot.method]
        self._cost.value = say.COST_WORDS[snapshot.cost]

    def _pick(self, event: Any, cost: Cost | None) -> None:
        if event.client is None:
            return  # set by `show`
        self._picked = monotonic()
        self._ask(ChangeMethod(_method_of(str(self._method.value)), cost))

    def _command(self, label: str, method: Method | None, cost: Cost | None) -> Command:
        def ask() -> None:
            self._ask(ChangeMethod(method or _method_of(str(self._method.value)), cost))

        return Command(label, None, say.METHOD_FOLDER, ask)


def _method_of(words: str) -> Method:
    return next(method for method, text in say.METHOD_WORDS.items() if text == words)


def _cost_of(words: str) -> Cost:
    return next(cost for cost, text in say.COST_WORDS.items() if text == words)

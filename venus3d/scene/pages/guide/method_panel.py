"""How the next pose is found: two lists to choose from, and the same in the command palette.

They show what the session does, not what was clicked: a choice that is refused goes back by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.method import COSTS, METHODS, Cost, Method
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.intents import ChangeMethod, Intent
from venus3d.scene.web.buttons import ChoiceList
from venus3d.scene.web.help import Command

# A choice is on its way to the session and back for so long; until then it is not put back.
_ON_ITS_WAY_S = 1.0


class MethodPanel:
    """The two lists of one server. `ask` is called on viser's threads."""

    def __init__(self, gui: viser.GuiApi, ask: Callable[[Intent], None]) -> None:
        """Make the lists in the current panel, folded away."""
        self._ask = ask
        self._shown: tuple[Method, Cost] | None = None
        self._picked: float | None = None
        with gui.add_folder(say.METHOD_FOLDER, expand_by_default=False):
            self._method = ChoiceList(
                gui, say.METHOD, say.METHOD_WORDS, lambda _: self._pick(None), hint=say.METHOD_HINT
            )
            self._cost = ChoiceList(gui, say.COST, say.COST_WORDS, self._pick, hint=say.COST_HINT)

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
        now = monotonic()
        found: tuple[Method, Cost] = (snapshot.method, snapshot.cost)
        is_due = self._picked is not None and now - self._picked >= _ON_ITS_WAY_S
        if found == self._shown and not is_due:
            return
        self._shown, self._picked = found, None
        self._method.show(say.METHOD_WORDS, snapshot.method, again=True)
        self._cost.show(say.COST_WORDS, snapshot.cost, again=True)

    def _pick(self, cost: Cost | None) -> None:
        self._picked = monotonic()
        self._ask(ChangeMethod(self._chosen_method(), cost))

    def _command(self, label: str, method: Method | None, cost: Cost | None) -> Command:
        def ask() -> None:
            self._ask(ChangeMethod(method or self._chosen_method(), cost))

        return Command(label, None, say.METHOD_FOLDER, ask)

    def _chosen_method(self) -> Method:
        return self._method.chosen or METHODS[0]

"""How the next pose is found: two lists to choose from, and the same in the command palette.

They show what the session does, not what was clicked: a choice that is refused goes back by itself.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import viser

from venus3d.engine.snapshot import COSTS, METHODS, Cost, Method, Snapshot
from venus3d.scene.guide.intents import ChangeMethod, Intent

METHOD_WORDS: dict[Method, str] = {
    "global": "Best of all poses (global)",
    "venus": "The paper's (venus)",
    "pose-selection": "By Rojtberg's rule (pose-selection)",
    "random": "By chance (random)",
}
COST_WORDS: dict[Cost, str] = {
    "projection-variance": "Error over the picture (projection-variance)",
    "max-ere": "Largest error in the picture (max-ere)",
    "trace": "Sum of the uncertainties (trace)",
    "log-det": "Volume of the uncertainty (log-det)",
    "sum-iod": "The paper's index, summed (sum-iod)",
    "max-iod": "The paper's index, largest (max-iod)",
    "rms": "Misfit of a trial calibration, slow (rms)",
}
_METHOD_HINT = (
    "global looks at thousands of poses and needs the fewest views. venus starts at the paper's "
    "rule and walks a little. pose-selection follows a fixed rule. random is for comparison."
)
_COST_HINT = (
    "What the search makes small. The error over the picture is what matters when the camera is "
    "used; the others are for comparison. random and pose-selection do not search."
)
# A choice is on its way to the session and back for so long; until then it is not put back.
_ON_ITS_WAY_S = 1.0


class MethodPanel:
    """The two lists of one server. `ask` is called on viser's threads."""

    def __init__(self, server: viser.ViserServer, ask: Callable[[Intent], None]) -> None:
        """Make the lists in the current panel, folded away, and the commands."""
        self._ask = ask
        self._picked = -_ON_ITS_WAY_S
        gui = self._gui = server.gui
        with gui.add_folder("How the next pose is found", expand_by_default=False):
            self._method = gui.add_dropdown(
                "Method", list(METHOD_WORDS.values()), hint=_METHOD_HINT
            )
            self._cost = gui.add_dropdown("Makes small", list(COST_WORDS.values()), hint=_COST_HINT)
        self._method.on_update(lambda event: self._pick(event, None))
        self._cost.on_update(lambda event: self._pick(event, _cost_of(str(self._cost.value))))
        for method in METHODS:
            self._command(f"Method: {METHOD_WORDS[method]}", method, None)
        for cost in COSTS:
            self._command(f"Make small: {COST_WORDS[cost]}", None, cost)

    def show(self, snapshot: Snapshot) -> None:
        """Let the lists say how the session finds its poses."""
        if time.monotonic() - self._picked < _ON_ITS_WAY_S:
            return
        for box, words in (
            (self._method, METHOD_WORDS[snapshot.method]),
            (self._cost, COST_WORDS[snapshot.cost]),
        ):
            if box.value != words:
                box.value = words

    def _pick(self, event: Any, cost: Cost | None) -> None:
        if event.client is None:
            return  # set by `show`
        self._picked = time.monotonic()
        self._ask(ChangeMethod(_method_of(str(self._method.value)), cost))

    def _command(self, label: str, method: Method | None, cost: Cost | None) -> None:
        command = self._gui.add_command(label, description="How the next pose is found")
        command.on_trigger(
            lambda _: self._ask(ChangeMethod(method or _method_of(str(self._method.value)), cost))
        )


def _method_of(words: str) -> Method:
    return next(method for method, text in METHOD_WORDS.items() if text == words)


def _cost_of(words: str) -> Cost:
    return next(cost for cost, text in COST_WORDS.items() if text == words)

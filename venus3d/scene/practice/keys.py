"""The keys of a practice page; W A S D Q E and the arrows fly the browser's camera."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import viser

from venus3d.engine.practice import LEVELS
from venus3d.scene.practice.moment import ChooseHelp, ChooseLevel, Nudge, Press, Wish
from venus3d.scene.texts.practice import COMMANDS, LEVEL_NAMES, NUDGES

_NUDGES: tuple[tuple[Any, bool, int, int], ...] = (
    ("L", False, 3, 1),
    ("J", False, 3, -1),
    ("K", False, 4, 1),
    ("I", False, 4, -1),
    ("O", False, 5, 1),
    ("U", False, 5, -1),
    ("K", True, 0, 1),
    ("I", True, 0, -1),
    ("J", True, 1, 1),
    ("L", True, 1, -1),
    ("O", True, 2, 1),
    ("U", True, 2, -1),
)
"""Key, whether with Shift, which of the six numbers of the pose, up or down."""
_PRESSES: tuple[tuple[Literal["next", "give_up", "again", "look", "light"], Any], ...] = (
    ("next", "space"),
    ("give_up", "G"),
    ("again", "R"),
    ("look", "V"),
    ("light", "B"),
)


def add_keys(gui: viser.GuiApi, wish: Callable[[Wish], None]) -> None:
    """Register every key and its line in the command palette. `wish` must not block."""
    for what, key in _PRESSES:
        _add(gui, *COMMANDS[what], key, Press(what), wish)
    _add(gui, *COMMANDS["help"], "H", ChooseHelp(None), wish)
    label, description = COMMANDS["level"]
    for level in LEVELS:
        name = LEVEL_NAMES[level]
        chosen = ChooseLevel(level)
        _add(
            gui, label.format(level=level), description.format(name=name), str(level), chosen, wish
        )
    label, description = COMMANDS["nudge"]
    for key, shifted, number, sign in _NUDGES:
        what = NUDGES[2 * number + (sign < 0)]
        nudge = Nudge(number, sign)
        _add(gui, label.format(what=what), description, key, nudge, wish, shifted=shifted)


def _add(
    gui: viser.GuiApi,
    label: str,
    description: str,
    key: Any,
    asked: Wish,
    wish: Callable[[Wish], None],
    *,
    shifted: bool = False,
) -> None:
    command = gui.add_command(
        label, description=description, hotkey=key, modifier="shift" if shifted else None
    )

    # Async, so that the repeats of a key that is held down stay in order.
    async def pressed(_: Any) -> None:
        wish(asked)

    command.on_trigger(pressed)

"""The commands of a practice page with their keys: one list for hotkeys, palette and help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

from venus3d.engine.guidance.exercise import LEVELS
from venus3d.scene.pages.exercise.texts import COMMANDS, LEVEL_NAMES, NUDGES
from venus3d.scene.pages.exercise.view_model import ChooseHelp, ChooseLevel, Nudge, Press, Wish
from venus3d.scene.web.help import Command

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


def practice_commands(wish: Callable[[Wish], None]) -> tuple[Command, ...]:
    """All commands. `wish` is called on viser's threads and must not block."""

    def asking(asked: Wish) -> Callable[[], None]:
        return lambda: wish(asked)

    commands: list[Command] = []
    for what, key in _PRESSES:
        label, description = COMMANDS[what]
        commands.append(Command(label, key, description, asking(Press(what))))
    label, description = COMMANDS["help"]
    commands.append(Command(label, "M", description, asking(ChooseHelp(None))))
    label, description = COMMANDS["level"]
    for level in LEVELS:
        name, chosen = LEVEL_NAMES[level], ChooseLevel(level)
        about = description.format(name=name[4:])
        commands.append(Command(label.format(level=level), str(level), about, asking(chosen)))
    label, description = COMMANDS["nudge"]
    for key, shift, number, sign in _NUDGES:
        what = label.format(what=NUDGES[2 * number + (sign < 0)])
        asked = asking(Nudge(number, sign))
        commands.append(Command(what, key, description, asked, shift=shift))
    return tuple(commands)

"""The commands of both pages with their keys, for hotkeys, palette and help."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from venus3d.engine.guidance.exercise import LEVELS
from venus3d.scene.pages.exercise import practice_texts, trial_texts
from venus3d.scene.pages.exercise.view_model import (
    Action,
    ChooseHelp,
    ChooseLevel,
    Nudge,
    Press,
    Request,
)
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
"""Key, whether with Shift, index of the pose's number, direction."""
_PRACTICE_KEYS: dict[Action, Any] = {
    "next": "space",
    "give_up": "G",
    "start_over": "R",
    "view": "V",
    "theme": "B",
}
_TRIAL_KEYS: dict[Action, Any] = {"next": "space", "give_up": "K", "theme": "B", "autopilot": "O"}
Ask = Callable[[Request], None]
"""Called on viser's threads; only queues the request."""


def practice_commands(ask: Ask) -> tuple[Command, ...]:
    """The commands of a practice page."""
    texts = practice_texts.COMMANDS
    commands = _pressing(_PRACTICE_KEYS, texts, ask)
    label, description = texts["help"]
    commands.append(_command(label, "M", description, ChooseHelp(None), ask))
    label, description = texts["level"]
    for level in LEVELS:
        about = description.format(name=practice_texts.LEVEL_NAMES[level])
        name = label.format(level=level)
        commands.append(_command(name, str(level), about, ChooseLevel(level), ask))
    label, description = texts["nudge"]
    for key, shift, number, sign in _NUDGES:
        name = label.format(what=practice_texts.NUDGES[2 * number + (sign < 0)])
        commands.append(_command(name, key, description, Nudge(number, sign), ask, shift=shift))
    return tuple(commands)


def trial_commands(ask: Ask, *, simulated: bool) -> tuple[Command, ...]:
    """The commands of a trial's page; the autopilot's only for a simulated board."""
    keys: dict[Action, Any] = {
        act: key for act, key in _TRIAL_KEYS.items() if simulated or act != "autopilot"
    }
    return tuple(_pressing(keys, trial_texts.COMMANDS, ask))


def _pressing(
    keys: dict[Action, Any], texts: dict[str, tuple[str, str]], ask: Ask
) -> list[Command]:
    return [_command(texts[a][0], key, texts[a][1], Press(a), ask) for a, key in keys.items()]


def _command(
    label: str, key: Any, description: str, request: Request, ask: Ask, *, shift: bool = False
) -> Command:
    return Command(label, key, description, lambda: ask(request), shift=shift)

"""The keys that move a board, the same on every page that has one to move.

A key with Shift brings the edge on its side nearer to the camera, which is how the instructions
name a turn: Shift+L the right edge, Shift+I the top edge.
"""

from __future__ import annotations

from collections.abc import Callable

from venus3d.engine.geometry.pose import Pose
from venus3d.scene.web import pose_texts as say
from venus3d.scene.web.help import SHIFT, Command

BOARD_KEYS: dict[str, tuple[int, int]] = {
    "J": (3, -1),
    "L": (3, 1),
    "I": (4, -1),
    "K": (4, 1),
    "U": (5, -1),
    "O": (5, 1),
    "shift+J": (1, -1),
    "shift+L": (1, 1),
    "shift+I": (0, 1),
    "shift+K": (0, -1),
    "shift+U": (2, -1),
    "shift+O": (2, 1),
}
"""Each key's number of the pose vector (0 ... 5) and direction (1 or -1)."""
_NUDGE_DEG, _NUDGE_M = 1.0, 0.002
_REPEAT_S = 0.25  # a key repeated this soon is held down
_FASTEST = 5.0


def board_commands(nudge: Callable[[int, int], None]) -> tuple[Command, ...]:
    """A command for each key; `nudge` is called on viser's threads with number and direction."""
    return tuple(
        Command(
            say.BOARD_COMMAND.format(what=say.NUDGES[number, sign]),
            key,
            say.BOARD_COMMAND_HINT,
            lambda number=number, sign=sign: nudge(number, sign),
        )
        for key, (number, sign) in BOARD_KEYS.items()
    )


def board_keys_html() -> str:
    """A table of these keys: two a row, what they do alone, and with Shift."""
    keys = tuple(key for key in BOARD_KEYS if len(key) == 1)
    rows = zip(keys[::2], keys[1::2], strict=True)
    head = "".join(f"<small>{name}</small>" for name in ("", *say.BOARD_KEYS_HEAD))
    return head + "".join(
        f"<span>{key_html(one)} {key_html(other)}</span><span>{_pair(one, other)}</span>"
        f"<span>{_pair(SHIFT + one, SHIFT + other)}</span>"
        for one, other in rows
    )


def key_html(name: str) -> str:
    """A key as it looks on the keyboard."""
    return f"<span class='v-key'>{name}</span>"


def _pair(one: str, other: str) -> str:
    words, others = say.NUDGES[BOARD_KEYS[one]], say.NUDGES[BOARD_KEYS[other]]
    first, _, rest = words.partition(" ")
    # "left, right edge nearer"
    return f"{first if rest and others.endswith(rest) else words}, {others}"


class KeyMoves:
    """Moves a board by keys: a little for a press, faster while a key is held down."""

    def __init__(self) -> None:
        """No key pressed yet."""
        self._last: tuple[int, int] | None = None
        self._at_s, self._run = 0.0, 0

    def moved(self, pose: Pose, number: int, sign: int, now_s: float) -> Pose:
        """The pose after this key was pressed (or repeated) at this time."""
        held = self._last == (number, sign) and now_s - self._at_s < _REPEAT_S
        self._run = self._run + 1 if held else 0
        self._last, self._at_s = (number, sign), now_s
        vector = pose.vector()
        step = _NUDGE_DEG if number < 3 else _NUDGE_M
        vector[number] += sign * min(_FASTEST, 1 + self._run / 5) * step
        return Pose.from_vector(vector)

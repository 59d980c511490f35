"""What the session says at one moment: a headline and one sentence. The words are in `words`."""

from __future__ import annotations

from venus3d.engine import words
from venus3d.engine.board import Board
from venus3d.engine.snapshot import Match, Phase
from venus3d.engine.words import Words

_STATES = {
    "captured": ("Captured", words.CALCULATING),
    "converged": ("Calibrated", words.CONVERGED),
    "finished": ("Finished", words.FINISHED),
}


def said(phase: Phase, match: Match | None, seen: bool, by_user: bool = True) -> tuple[str, Words]:
    """Headline and instruction.

    `seen` is whether the board is, `by_user` who has ended it; `match` is None without a target.
    """
    if phase == "finished" and not by_user:
        return "Finished", words.ENOUGH
    if phase in _STATES:
        return _STATES[phase]
    if not seen:
        return "Board not seen", words.NOT_SEEN
    if match is None:
        return "No target", words.NO_TARGET
    if match.reached or all(match.within):
        return "Hold still", words.HOLD_STILL
    return f"Step {match.active_step} of 4", match.steps[match.active_step - 1].words


def said_at_startup(corners: int, board: Board) -> tuple[str, Words]:
    """The same while nothing is known yet and `corners` of the board are seen."""
    return "Show the board", words.words_for_startup(corners, board.corner_count)

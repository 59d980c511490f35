"""The large text of a guided calibration: its state, and what to do now."""

from __future__ import annotations

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.web.diagnoses import another_board, doubt
from venus3d.scene.web.step_card import (
    Note,
    guide_card,
    hold_card,
    second_line,
    step_card,
    step_chips,
)
from venus3d.scene.web.step_texts import FROM_UPRIGHT
from venus3d.scene.web.theme import Theme

_HEADLINES = {"captured": say.CAPTURED, "converged": say.CONVERGED, "finished": say.FINISHED}
_NEXT = {"converged": say.CONVERGED_NEXT, "finished": say.FINISHED_NEXT}


def guidance_html(snapshot: Snapshot | None, state: ViewState, theme: Theme, note: Note) -> str:
    """The whole text for this snapshot."""
    if state.no_pictures:
        return guide_card(theme.info, "!", say.NO_PICTURES, state.no_pictures, note=note)
    if snapshot is None:
        return guide_card(theme.quiet, "…", say.STARTING, say.STARTING_SENTENCE, note=note)
    if snapshot.phase in ("captured", "converged", "finished"):
        return _state_card(snapshot, state, theme, note)
    remaining = snapshot.remaining
    chips = step_chips(remaining, state.step, theme)
    if state.paused:
        sentence = say.PAUSED_SENTENCE
        return guide_card(theme.quiet, "II", say.PAUSED, sentence, below=chips, note=note)
    if remaining is None or remaining.match is None:
        return _unseen_card(snapshot, state, theme, chips, note)
    if remaining.match.reached or (remaining.is_over and state.follow):
        return hold_card(theme, remaining, state.step, note)
    foot = ""
    if not state.playing and state.step != remaining.active:
        foot = say.LOOKING_ELSEWHERE.format(shown=state.step, active=remaining.active)
    return step_card(remaining, state.step, theme, note, second_line(foot), state.wording)


def _state_card(snapshot: Snapshot, state: ViewState, theme: Theme, note: Note) -> str:
    against = doubt(snapshot)
    if snapshot.phase == "converged" and against is not None:
        # The sigmas have settled, but the views are not informative enough.
        second = second_line(say.DOUBTED_NEXT)
        return guide_card(theme.info, "!", say.DOUBTFUL, against.cure, below=second, note=note)
    busy = snapshot.phase == "captured"
    colour, mark = (theme.quiet, "…") if busy else (theme.reached, "✓")
    sentence = snapshot.instruction.text(state.wording)
    second = second_line(_NEXT.get(snapshot.phase, ""))
    return guide_card(colour, mark, _HEADLINES[snapshot.phase], sentence, below=second, note=note)


def _unseen_card(snapshot: Snapshot, state: ViewState, theme: Theme, chips: str, note: Note) -> str:
    other = another_board(snapshot)
    if other is not None:
        return guide_card(theme.info, "✕", say.ANOTHER_BOARD, other.cure, note=note)
    startup = snapshot.phase == "startup" and snapshot.target is None
    headline = say.SHOW_BOARD if startup else snapshot.headline
    sentence = snapshot.instruction.text(state.wording)
    below = f"{chips}{second_line(FROM_UPRIGHT)}" if chips else ""
    colour = theme.quiet if startup else theme.info
    return guide_card(colour, "?", headline, sentence, below=below, note=note)

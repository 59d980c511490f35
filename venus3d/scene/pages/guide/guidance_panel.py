"""The large text of a guided calibration: its state, and what to do now."""

from __future__ import annotations

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.end_panel import OVER, ended_card, question_card, unsettled_text
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.web import step_texts
from venus3d.scene.web.diagnoses import another_board, doubt
from venus3d.scene.web.step_card import (
    Note,
    guide_card,
    hold_card,
    second_line,
    step_card,
    step_chips,
)
from venus3d.scene.web.theme import Theme


def guidance_html(snapshot: Snapshot | None, state: ViewState, theme: Theme, note: Note) -> str:
    """The whole text for this snapshot."""
    # What is asked, and the result, need no new pictures; those of another size need an answer.
    over = snapshot is not None and snapshot.phase in OVER
    ends = state.asked_to_end or over
    if state.paused and ends and not note.text:
        note = Note(say.PICTURES_PAUSED)
    if state.no_pictures and not state.other_size and ends:
        note = Note(f"{say.NO_PICTURES}. {state.no_pictures}", warns=True)
    elif state.no_pictures:
        title, cure = (
            (say.OTHER_SIZE, say.OTHER_SIZE_CURE)
            if state.other_size
            else (say.NO_PICTURES, say.NO_PICTURES_CURE)
        )
        below = second_line(cure)
        return guide_card(theme.info, "!", title, state.no_pictures, below=below, note=note)
    if snapshot is None:
        return guide_card(theme.quiet, "…", say.STARTING, say.STARTING_SENTENCE, note=note)
    if state.asked_to_end:
        return question_card(snapshot, theme, note)
    if snapshot.phase in ("captured", "converged", "finished"):
        return _state_card(snapshot, state, theme, note)
    remaining = snapshot.remaining
    chips = step_chips(remaining, state.step, theme)
    if state.paused:
        sentence = say.PAUSED_SENTENCE
        return guide_card(theme.quiet, "II", say.PAUSED, sentence, below=chips, note=note)
    if remaining is None or remaining.match is None:
        return _unseen_card(snapshot, state, theme, chips, note)
    if remaining.is_over and snapshot.taken_back:
        sentence = say.TAKEN_BACK_SENTENCE
        return guide_card(theme.quiet, "↩", say.TAKEN_BACK, sentence, below=chips, note=note)
    if snapshot.refusal is not None:
        below, sentence = second_line(say.CAPTURE_ANYWAY), snapshot.refusal
        headline = snapshot.headline
        return guide_card(theme.info, "!", headline, sentence, below=below, note=note)
    if remaining.is_over:
        return hold_card(theme, remaining, state.step, note)
    foot = ""
    if not state.playing and state.step != remaining.active:
        foot = say.LOOKING_ELSEWHERE.format(shown=state.step, active=remaining.active)
    return step_card(remaining, state.step, theme, note, second_line(foot), state.wording)


def _state_card(snapshot: Snapshot, state: ViewState, theme: Theme, note: Note) -> str:
    sentence, against = snapshot.instruction.text(state.wording), doubt(snapshot)
    if snapshot.phase == "captured":
        return guide_card(theme.quiet, "…", snapshot.headline, sentence, note=note)
    if against is not None and not unsettled_text(snapshot):
        # The sigmas have settled, but the views are not informative enough.
        second = second_line(say.DOUBTED_NEXT)
        return guide_card(theme.info, "!", say.DOUBTFUL, against.cure, below=second, note=note)
    if snapshot.phase == "finished":
        return ended_card(snapshot, theme, note)
    second = second_line(say.CONVERGED_NEXT)
    return guide_card(theme.reached, "✓", say.CONVERGED, sentence, below=second, note=note)


def _unseen_card(snapshot: Snapshot, state: ViewState, theme: Theme, chips: str, note: Note) -> str:
    other = another_board(snapshot)
    if other is not None:
        return guide_card(theme.info, "✕", say.ANOTHER_BOARD, other.cure, note=note)
    startup = snapshot.phase == "startup" and snapshot.target is None
    headline = say.SHOW_BOARD if startup else snapshot.headline
    sentence = snapshot.instruction.text(state.wording)
    below = f"{chips}{second_line(step_texts.FROM_UPRIGHT)}" if chips else ""
    colour = theme.quiet if startup else theme.info
    return guide_card(colour, "?", headline, sentence, below=below, note=note)

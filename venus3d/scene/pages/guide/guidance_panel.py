"""The large text: what state we are in, what to do now, how much of it is left.

It must be readable at two metres, so it holds one headline, one sentence and four short facts.
"""

from __future__ import annotations

from html import escape

from venus3d.engine.geometry.decomposition import Steps
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.prompts import HOLD_STILL, STEP_RIGHT, step_words
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.diagnosis_panel import another_board, doubt
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.render.amounts import degrees
from venus3d.scene.render.palette import STEP_STYLES, step_style
from venus3d.scene.web.theme import Theme

_HEADLINES = {"captured": say.CAPTURED, "converged": say.CONVERGED, "finished": say.FINISHED}
_NEXT = {"converged": say.CONVERGED_NEXT, "finished": say.FINISHED_NEXT}


def guidance_html(snapshot: Snapshot | None, state: ViewState, theme: Theme, note: str) -> str:
    """The whole text for this moment."""
    if snapshot is None:
        return _card(theme.info, "…", say.STARTING, say.STARTING_SENTENCE, "", "", note)
    if snapshot.phase in ("captured", "converged", "finished"):
        return _state_card(snapshot, theme, note)
    if state.paused:
        chips = _chips(snapshot, state, theme)
        return _card(theme.quiet, "II", say.PAUSED, say.PAUSED_SENTENCE, "", chips, note)
    if snapshot.match is None or snapshot.pose is None:
        return _unseen_card(snapshot, state, theme, note)
    if snapshot.match.reached or (all(snapshot.match.within) and state.follow):
        sentence = HOLD_STILL.holder
        chips = _chips(snapshot, state, theme)
        return _card(theme.reached, "✓", say.HOLD_HEADLINE, sentence, "", chips, note)
    return _step_card(snapshot, snapshot.match, state, theme, note)


def _state_card(snapshot: Snapshot, theme: Theme, note: str) -> str:
    against = doubt(snapshot)
    if snapshot.phase == "converged" and against is not None:
        # The sigmas have settled, but on views that do not say enough.
        second = _second(say.DOUBTED_NEXT)
        return _card(theme.info, "!", say.DOUBTFUL, against.cure, "", second, note)
    busy = snapshot.phase == "captured"
    colour, mark = (theme.info, "…") if busy else (theme.reached, "✓")
    sentence = snapshot.instruction.holder
    second = _NEXT.get(snapshot.phase, "")
    return _card(colour, mark, _HEADLINES[snapshot.phase], sentence, "", _second(second), note)


def _second(text: str) -> str:
    return f"<div class='v-second'>{escape(text)}</div>" if text else ""


def _unseen_card(snapshot: Snapshot, state: ViewState, theme: Theme, note: str) -> str:
    other = another_board(snapshot)
    if other is not None:
        return _card(theme.info, "✕", say.ANOTHER_BOARD, other.cure, "", "", note)
    startup = snapshot.phase == "startup" and snapshot.target is None
    headline = say.SHOW_BOARD if startup else snapshot.headline
    sentence = snapshot.instruction.holder
    chips = "" if startup else _chips(snapshot, state, theme)
    return _card(theme.info, "?", headline, sentence, "", chips, note)


def _step_card(snapshot: Snapshot, match: Match, state: ViewState, theme: Theme, note: str) -> str:
    step = match.steps[state.step - 1]
    eyebrow = say.STEP_OF_FOUR.format(number=state.step)
    is_right = match.within[state.step - 1]
    words = STEP_RIGHT if is_right else step_words(step)
    amount = "" if is_right else remaining_text(match, state.step)
    colour = theme.steps[state.step - 1]
    chips = _chips(snapshot, state, theme)
    foot = ""
    if not state.playing and state.step != match.active_step:
        foot = say.LOOKING_ELSEWHERE.format(shown=state.step, active=match.active_step)
        foot = _second(foot)
    elif words.camera != words.holder:
        foot = escape(say.IN_THE_PICTURE.format(words=words.camera))
        foot = f"<div class='v-picture'>{foot}</div>"
    title, number = step_style(state.step).title, str(state.step)
    return _card(
        colour, number, title, words.holder, amount, chips, note, foot=foot, eyebrow=eyebrow
    )


def remaining_text(match: Match, step: int) -> str:
    """What is left of one step, with its unit: "+31°" or "120 mm"."""
    if step == 1:
        return f"{float((match.remaining_mm**2).sum()) ** 0.5:.0f} mm"
    return degrees(match.remaining_deg[step - 2])


def _card(
    colour: str,
    badge: str,
    headline: str,
    sentence: str,
    amount: str,
    below: str,
    note: str,
    *,
    foot: str = "",
    eyebrow: str = "",
) -> str:
    left = f"<div class='v-amount'>{escape(amount)}<small>{say.TO_GO}</small></div>"
    left = left if amount else ""
    above = f"<small>{escape(eyebrow)}</small> " if eyebrow else ""
    said = f"<div class='v-note'>{escape(note)}</div>" if note else ""
    return (
        f"<div class='v-guide' role='status' style='--step:{colour}'>"
        f"<div class='v-head'><span class='v-badge'>{escape(badge)}</span>"
        f"<span class='v-title'>{above}{escape(headline)}</span></div>{left}"
        f"<div class='v-sentence'>{escape(sentence)}</div>{below}{said or foot}</div>"
    )


def _chips(snapshot: Snapshot, state: ViewState, theme: Theme) -> str:
    """The four steps in one row, each with number, word, what is left and whether it is right."""
    match = snapshot.match
    if match is None and snapshot.target is None:
        return ""
    cells: list[str] = []
    for style in STEP_STYLES:
        number, verb = style.number, style.title.split()[0]
        shown = " v-on" if number == state.step else ""
        if match is not None:
            done = match.within[number - 1]
            fact = say.RIGHT if done else remaining_text(match, number)
            shown += " v-done" if done else ""
        else:
            fact = _whole_text(snapshot.target.steps if snapshot.target else None, number)
        cells.append(
            f"<div class='v-chip{shown}' style='--step:{theme.steps[number - 1]}' title='"
            f"{escape(say.CHIP_HINT.format(number=number, title=style.title, fact=fact))}'>"
            f"<b>{number}</b><span>{verb}</span><i>{escape(fact)}</i></div>"
        )
    return f"<div class='v-chips'>{''.join(cells)}</div>"


def _whole_text(steps: Steps | None, number: int) -> str:
    if steps is None:
        return ""
    step = steps[number - 1]
    if number == 1:
        return f"{float((step.translation**2).sum()) ** 0.5 * 1000:.0f} mm"
    return degrees(step.angle_deg)

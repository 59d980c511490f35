"""The large text: what state we are in, what to do now, how much of it is left.

It must be readable at two metres, so it holds one headline, one sentence and four short facts.
"""

from __future__ import annotations

from html import escape

from venus3d.engine.decomposition import Steps
from venus3d.engine.snapshot import Match, Snapshot
from venus3d.engine.words import HOLD_STILL, STEP_RIGHT
from venus3d.scene.guide.diagnosis_panel import another_board, doubt
from venus3d.scene.guide.view_state import ViewState
from venus3d.scene.palette import STEP_STYLES, step_style
from venus3d.scene.style import Theme

_HEADLINES = {
    "startup": "Show me the whole board",
    "captured": "Captured – calculating",
    "converged": "Done – the camera is calibrated",
    "finished": "Finished",
}
_NEXT = {
    "converged": "Capture more views if you like, or press Finish.",
    "finished": "The result is kept; you may close this page.",
}

_DOUBTED = "The reason stands at the top left. C captures a view, Finish ends it as it is."


def guidance_html(snapshot: Snapshot | None, state: ViewState, theme: Theme, note: str) -> str:
    """The whole text for this moment."""
    if snapshot is None:
        return _card(theme.info, "…", "Starting", "Waiting for the first picture.", "", "", note)
    if snapshot.phase in ("captured", "converged", "finished"):
        return _state_card(snapshot, theme, note)
    if state.paused:
        text = "Press Pause again, or the space bar, to go on."
        return _card(theme.quiet, "II", "Paused", text, "", _chips(snapshot, state, theme), note)
    if snapshot.match is None or snapshot.pose is None:
        return _unseen_card(snapshot, state, theme, note)
    if snapshot.match.reached or (all(snapshot.match.within) and state.follow):
        sentence = HOLD_STILL.holder
        chips = _chips(snapshot, state, theme)
        return _card(theme.good, "✓", "Hold still", sentence, "", chips, note)
    return _step_card(snapshot, snapshot.match, state, theme, note)


def _state_card(snapshot: Snapshot, theme: Theme, note: str) -> str:
    against = doubt(snapshot)
    if snapshot.phase == "converged" and against is not None:
        # The sigmas have settled, but on views that do not say enough.
        headline = "Settled, but do not trust it yet"
        return _card(theme.info, "!", headline, against.cure, "", _second(_DOUBTED), note)
    busy = snapshot.phase == "captured"
    colour, mark = (theme.info, "…") if busy else (theme.good, "✓")
    sentence = snapshot.instruction.holder
    second = _NEXT.get(snapshot.phase, "")
    return _card(colour, mark, _HEADLINES[snapshot.phase], sentence, "", _second(second), note)


def _second(text: str) -> str:
    return f"<div class='v-second'>{escape(text)}</div>" if text else ""


def _unseen_card(snapshot: Snapshot, state: ViewState, theme: Theme, note: str) -> str:
    other = another_board(snapshot)
    if other is not None:
        return _card(theme.info, "✕", "This is another board", other.cure, "", "", note)
    startup = snapshot.phase == "startup" and snapshot.target is None
    headline = _HEADLINES["startup"] if startup else snapshot.headline
    sentence = snapshot.instruction.holder
    chips = "" if startup else _chips(snapshot, state, theme)
    return _card(theme.info, "?", headline, sentence, "", chips, note)


def _step_card(snapshot: Snapshot, match: Match, state: ViewState, theme: Theme, note: str) -> str:
    step = match.steps[state.step - 1]
    headline = f"Step {state.step} of 4: {step_style(state.step).title}"
    is_right = match.within[state.step - 1]
    words = STEP_RIGHT if is_right else step.words
    amount = "" if is_right else remaining_text(match, state.step)
    colour = theme.steps[state.step - 1]
    chips = _chips(snapshot, state, theme)
    picture = "" if words.camera == words.holder else f"In the camera's picture: {words.camera}"
    if not state.playing and state.step != match.active_step:
        picture = f"You are looking at step {state.step}; the board is on step {match.active_step}."
        picture += " Press F to go there."
    return _card(colour, str(state.step), headline, words.holder, amount, chips, note, picture)


def remaining_text(match: Match, step: int) -> str:
    """What is left of one step, with its unit: "+31°" or "120 mm"."""
    if step == 1:
        return f"{float((match.remaining_mm**2).sum()) ** 0.5:.0f} mm"
    return f"{float(match.remaining_deg[step - 2]):+.0f}°".replace("-", "−")


def _card(
    colour: str,
    badge: str,
    headline: str,
    sentence: str,
    amount: str,
    below: str,
    note: str,
    picture: str = "",
) -> str:
    left = f"<div class='v-amount'>{escape(amount)}<small>to go</small></div>" if amount else ""
    extra = note or picture
    kind = "v-note" if note else "v-picture"
    foot = f"<div class='{kind}'>{escape(extra)}</div>" if extra else ""
    return (
        f"<div class='v-guide' style='--step:{colour}'>"
        f"<div class='v-head'><span class='v-badge'>{escape(badge)}</span>"
        f"<span class='v-title'>{escape(headline)}</span>{left}</div>"
        f"<div class='v-sentence'>{escape(sentence)}</div>{foot}{below}</div>"
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
            fact = "✓ right" if done else remaining_text(match, number)
            shown += " v-done" if done else ""
        else:
            fact = _whole_text(snapshot.target.steps if snapshot.target else None, number)
        cells.append(
            f"<div class='v-chip{shown}' style='--step:{theme.steps[number - 1]}'>"
            f"<b>{number}</b><span>{verb}</span><i>{escape(fact)}</i></div>"
        )
    return f"<div class='v-chips'>{''.join(cells)}</div>"


def _whole_text(steps: Steps | None, number: int) -> str:
    if steps is None:
        return ""
    step = steps[number - 1]
    if number == 1:
        return f"{float((step.translation**2).sum()) ** 0.5 * 1000:.0f} mm"
    return f"{step.angle_deg:+.0f}°".replace("-", "−")

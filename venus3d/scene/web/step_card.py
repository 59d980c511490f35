"""The large text for the board's holder, as HTML: what to do now, and how much is left. Readable at
two metres: one headline, one sentence and four short facts."""

from __future__ import annotations

from html import escape

from venus3d.engine.geometry.decomposition import Steps
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.prompts import HOLD_STILL, STEP_DONE, step_prompt
from venus3d.render.amounts import degrees
from venus3d.render.palette import STEP_STYLES, step_style
from venus3d.scene.web import step_texts as say
from venus3d.scene.web.theme import Theme

PICTURE_LEGEND_HTML = (
    "<div class='v-steps'><div class='v-legend'>"
    + " &nbsp; ".join(f"<b>{name}</b>: {meaning}" for name, meaning in say.PICTURE_LEGEND)
    + "</div></div>"
)
"""Legend of the live picture during the steps."""


def guide_card(
    colour: str,
    badge: str,
    headline: str,
    sentence: str,
    *,
    amount: str = "",
    below: str = "",
    note: str = "",
    foot: str = "",
    eyebrow: str = "",
) -> str:
    """One card; `below` and `foot` are HTML, the rest is text. A `note` replaces the foot."""
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


def second_line(text: str) -> str:
    """A smaller sentence below the first; nothing for an empty text."""
    return f"<div class='v-second'>{escape(text)}</div>" if text else ""


def hold_card(theme: Theme, below: str, note: str) -> str:
    """The card for a board at its target that must be held still."""
    sentence = HOLD_STILL.holder
    return guide_card(theme.reached, "✓", say.HOLD_HEADLINE, sentence, below=below, note=note)


def step_card(match: Match, number: int, theme: Theme, note: str, foot: str = "") -> str:
    """One of the four steps. Without a `foot`, it gives the camera's view of the step if the
    holder's words differ."""
    done = match.within[number - 1]
    words = STEP_DONE if done else step_prompt(match.steps[number - 1])
    if not foot and words.camera != words.holder:
        seen = escape(say.IN_THE_PICTURE.format(words=words.camera))
        foot = f"<div class='v-picture'>{seen}</div>"
    return guide_card(
        theme.steps[number - 1],
        str(number),
        step_style(number).title,
        words.holder,
        amount="" if done else remaining_text(match, number),
        below=step_chips(match, None, number, theme),
        note=note,
        foot=foot,
        eyebrow=say.STEP_OF_FOUR.format(number=number),
    )


def remaining_text(match: Match, step: int) -> str:
    """What is left of one step, with unit: "+31°" or "120 mm"."""
    if step == 1:
        return f"{float((match.remaining_mm**2).sum()) ** 0.5:.0f} mm"
    return degrees(match.remaining_deg[step - 2])


def step_chips(match: Match | None, steps: Steps | None, shown: int, theme: Theme) -> str:
    """The four steps in a row, each with number, word, remaining amount and whether it is done;
    without a match, the whole amounts of the target's `steps`; without both, nothing."""
    if match is None and steps is None:
        return ""
    cells: list[str] = []
    for style in STEP_STYLES:
        number, mark = style.number, " v-on" if style.number == shown else ""
        if match is not None:
            done = match.within[number - 1]
            fact = say.DONE if done else remaining_text(match, number)
            mark += " v-done" if done else ""
        else:
            fact = _whole_text(steps, number)
        hint = escape(say.CHIP_HINT.format(number=number, title=style.title, fact=fact))
        cells.append(
            f"<div class='v-chip{mark}' style='--step:{theme.steps[number - 1]}' title='{hint}'>"
            f"<b>{number}</b><span>{style.short_title}</span><i>{escape(fact)}</i></div>"
        )
    return f"<div class='v-chips'>{''.join(cells)}</div>"


def _whole_text(steps: Steps | None, number: int) -> str:
    if steps is None:
        return ""
    step = steps[number - 1]
    if number == 1:
        return f"{float((step.translation**2).sum()) ** 0.5 * 1000:.0f} mm"
    return degrees(step.angle_deg)

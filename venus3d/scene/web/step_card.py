"""The large text for the board's holder, as HTML: what to do now, and how much is left. Readable at
two metres: one headline, one sentence and four short facts."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import NamedTuple

from venus3d.engine.amounts import step_amount
from venus3d.engine.guidance.prompts import HOLD_HEADLINE, HOLD_STILL, Wording
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.languages import translated
from venus3d.render.palette import STEP_STYLES, step_style
from venus3d.scene.web import step_texts as say
from venus3d.scene.web.theme import Theme


class Note(NamedTuple):
    """A sentence below an instruction; empty for none."""

    text: str = ""
    warns: bool = False
    """Whether something is wrong, which makes it yellow."""


NO_NOTE = Note()


def picture_line_html(text: str) -> str:
    """A line about the live picture."""
    return f"<div class='v-steps'><div class='v-legend'>{escape(text)}</div></div>"


def picture_legend_html() -> str:
    """Legend of the live picture during the steps."""
    return _legend_html(say.PICTURE_LEGEND, "v-outlines")


def halves_legend_html() -> str:
    """Legend of the live picture while a part of it is shown without distortion."""
    return _legend_html(say.HALVES_LEGEND)


def _legend_html(meanings: Iterable[tuple[str, str]], kind: str = "") -> str:
    parts = " &nbsp; ".join(f"<b>{name}</b>: {meaning}" for name, meaning in meanings)
    return f"<div class='v-steps {kind}'><div class='v-legend'>{parts}</div></div>"


def guide_card(
    colour: str,
    badge: str,
    headline: str,
    sentence: str,
    *,
    amount: str = "",
    below: str = "",
    note: Note = NO_NOTE,
    foot: str = "",
    eyebrow: str = "",
) -> str:
    """One card; `below` and `foot` are HTML, the rest is text, also the engine's sentences. A
    `note` replaces the foot."""
    left = f"<div class='v-amount'>{escape(amount)}<small>{say.TO_GO}</small></div>"
    left = left if amount else ""
    above = f"<small>{escape(eyebrow)}</small> " if eyebrow else ""
    warns = " v-warns" if note.warns else ""
    said = f"<div class='v-note{warns}'>{escape(translated(note.text))}</div>" if note.text else ""
    return (
        f"<div class='v-guide' role='status' style='--step:{colour}'>"
        f"<div class='v-head'><span class='v-badge'>{escape(badge)}</span>"
        f"<span class='v-title'>{above}{escape(translated(headline))}</span></div>{left}"
        f"<div class='v-sentence'>{escape(translated(sentence))}</div>{below}{said or foot}</div>"
    )


def second_line(text: str) -> str:
    """A smaller sentence below the first; nothing for an empty text."""
    return f"<div class='v-second'>{escape(text)}</div>" if text else ""


def hold_card(theme: Theme, remaining: RemainingSteps, shown: int, note: Note = NO_NOTE) -> str:
    """The card for a board at its target that must be held still."""
    below = step_chips(remaining, shown, theme)
    return guide_card(theme.reached, "✓", HOLD_HEADLINE, HOLD_STILL.holder, below=below, note=note)


def step_card(
    remaining: RemainingSteps,
    number: int,
    theme: Theme,
    note: Note = NO_NOTE,
    foot: str = "",
    wording: Wording = "holder",
) -> str:
    """One of the four steps. Without a `foot`, it gives the step in the other wording, if that
    differs."""
    step = remaining.step(number)
    other = step.prompt.text("camera" if wording == "holder" else "holder")
    if not foot and other != step.prompt.text(wording):
        seen = escape(say.OTHER_WORDING[wording].format(words=translated(other)))
        foot = f"<div class='v-picture'>{seen}</div>"
    return guide_card(
        theme.steps[number - 1],
        str(number),
        step_style(number).title,
        step.prompt.text(wording),
        amount="" if step.done else step_amount(step.step),
        below=step_chips(remaining, number, theme),
        note=note,
        foot=foot,
        eyebrow=say.STEP_OF_FOUR.format(number=number),
    )


def step_chips(remaining: RemainingSteps | None, shown: int, theme: Theme) -> str:
    """The four steps in a row, each with number, word, remaining amount and whether it is done;
    nothing without them."""
    if remaining is None:
        return ""
    cells: list[str] = []
    for style, step in zip(STEP_STYLES, remaining.each, strict=True):
        mark = " v-on" if step.number == shown else ""
        mark += " v-done" if step.done else ""
        fact = say.DONE if step.done else step_amount(step.step)
        hint = escape(say.CHIP_HINT.format(number=step.number, title=style.title, fact=fact))
        cells.append(
            f"<div class='v-chip{mark}' style='--step:{theme.steps[step.number - 1]}' "
            f"title='{hint}'><b>{step.number}</b><span>{style.short_title}</span>"
            f"<i>{escape(fact)}</i></div>"
        )
    return f"<div class='v-chips'>{''.join(cells)}</div>"

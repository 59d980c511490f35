"""The large card of a teaching page: the current step in words and numbers."""

from __future__ import annotations

from html import escape

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.render.palette import STEP_STYLES, step_style
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.comparison_words import comparison_words
from venus3d.scene.pages.teach.scene_shapes import amount_text
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web.theme import Theme


def card_html(taught: TaughtPose, state: TeachState, theme: Theme) -> str:
    """Headline, amount, sentence and the four steps in one row."""
    body = _comparison(taught, state, theme) if state.compares else _steps(taught, state, theme)
    return f"<div class='v-progress v-wide'>{body}</div>"


def _steps(taught: TaughtPose, state: TeachState, theme: Theme) -> str:
    step = taught.steps[state.step - 1]
    holder = state.viewpoint == "holder"
    words = step_prompt(step).holder if holder else step_prompt(step).camera
    who = texts.SIDES["holder" if holder else "camera"]
    colour = theme.steps[step.number - 1]
    if state.at_rest:
        now = _now(theme.good, texts.THERE_HEADLINE, "", texts.THERE_SENTENCE, "")
    elif state.progress == 0.0:
        now = _now(theme.good, texts.START_HEADLINE, "", texts.START_SENTENCE, "")
    else:
        headline = texts.STEP.format(number=step.number, title=step_style(step.number).title)
        whole = amount_text(step, 1.0)
        amount = "" if step.is_idle else escape(amount_text(step, state.sweep))
        if amount and state.sweep < 1:
            amount += f"<small>{escape(texts.OF.format(whole=whole))}</small>"
        now = _now(colour, headline, amount, words, who)
    return f"{now}<div class='v-four'>{_chips(taught, state, theme)}</div>"


def _chips(taught: TaughtPose, state: TeachState, theme: Theme) -> str:
    cells: list[str] = []
    for style, step in zip(STEP_STYLES, taught.steps, strict=True):
        on = " class='v-on'" if step.number == state.step and not state.at_rest else ""
        cells.append(
            f"<div{on} style='--step:{theme.steps[step.number - 1]}'><b>{step.number}</b>"
            f"<span>{style.short_title}</span><i>{escape(_whole(step))}</i></div>"
        )
    return "".join(cells)


def _whole(step: Step) -> str:
    return "–" if step.is_idle else amount_text(step, 1.0)


def _comparison(taught: TaughtPose, state: TeachState, theme: Theme) -> str:
    words = comparison_words(taught, state)
    if words.turn is None:
        colour = theme.info if state.progress > 1 else theme.good
    else:
        colour = theme.steps[words.axis + 1]
    return _now(colour, words.headline, words.amount, words.sentence, "")


def _now(colour: str, headline: str, amount: str, sentence: str, who: str) -> str:
    """`amount` is HTML, the rest text."""
    right = f"<i>{amount}</i>" if amount else ""
    small = f"<div class='v-who'>{escape(who)}</div>" if who else ""
    return (
        f"<div class='v-now' style='--step:{colour}'><div class='v-top'><b>{escape(headline)}</b>"
        f"{right}</div><p>{escape(sentence)}</p>{small}</div>"
    )

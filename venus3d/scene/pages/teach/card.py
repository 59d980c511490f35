"""The large card of a teaching page: what happens now, in words and in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.prompts import step_words
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.stage import counted
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TeachMoment
from venus3d.scene.render.amounts import degrees
from venus3d.scene.render.palette import STEP_STYLES, step_style
from venus3d.scene.web.theme import Theme


def card_html(moment: TeachMoment, state: TeachState, theme: Theme) -> str:
    """Headline, amount, sentence and the four steps in one row."""
    body = _comparison(moment, state, theme) if state.compares else _steps(moment, state, theme)
    return f"<div class='v-progress v-wide'>{body}</div>"


def _steps(moment: TeachMoment, state: TeachState, theme: Theme) -> str:
    step = moment.steps[state.step - 1]
    holder = state.viewpoint == "holder"
    words = step_words(step).holder if holder else step_words(step).camera
    who = texts.SIDES["holder" if holder else "camera"]
    colour = theme.steps[step.number - 1]
    if state.at_rest:
        now = _now(theme.good, texts.THERE_HEADLINE, "", texts.THERE_SENTENCE, "")
    elif state.way == 0.0:
        now = _now(theme.good, texts.START_HEADLINE, "", texts.START_SENTENCE, "")
    else:
        headline = texts.STEP.format(number=step.number, title=step_style(step.number).title)
        whole = counted(step, 1.0)
        amount = "" if step.is_idle else escape(counted(step, state.sweep))
        if amount and state.sweep < 1:
            amount += f"<small>{escape(texts.OF.format(whole=whole))}</small>"
        now = _now(colour, headline, amount, words, who)
    return f"{now}<div class='v-four'>{_chips(moment, state, theme)}</div>"


def _chips(moment: TeachMoment, state: TeachState, theme: Theme) -> str:
    cells: list[str] = []
    for style, step in zip(STEP_STYLES, moment.steps, strict=True):
        on = " class='v-on'" if step.number == state.step and not state.at_rest else ""
        cells.append(
            f"<div{on} style='--step:{theme.steps[step.number - 1]}'><b>{step.number}</b>"
            f"<span>{style.title.split()[0]}</span><i>{escape(_whole(step))}</i></div>"
        )
    return "".join(cells)


def _whole(step: Step) -> str:
    return "–" if step.is_idle else counted(step, 1.0)


@dataclass(frozen=True)
class Remark:
    """What two boards side by side do now."""

    headline: str
    amount: str
    sentence: str
    turn: int | None = None
    """1 ... 3: which turn goes on; None before the first and after the last."""
    axis: int = 0
    """0 ... 2: about which axis the left board turns."""


def _comparison(moment: TeachMoment, state: TeachState, theme: Theme) -> str:
    remark = comparison_remark(moment, state)
    if remark.turn is None:
        colour = theme.info if state.way > 1 else theme.good
    else:
        colour = theme.steps[remark.axis + 1]
    return _now(colour, remark.headline, remark.amount, remark.sentence, "")


def comparison_remark(moment: TeachMoment, state: TeachState) -> Remark:
    """What to say of two boards that stand side by side."""
    step, sweep = state.place
    others = moment.others(state.arrangement)
    if step == 1:
        return Remark(texts.COMPARE_START, "", texts.COMPARE_PROMPT)
    left, right = moment.fixed[step - 2], others[step - 2]
    names = left.axis.upper(), right.axis.upper()
    if step == 4 and sweep == 1.0:
        apart = moment.apart_deg(state.arrangement)
        same = apart < 0.05
        amount = texts.SAME if same else texts.APART.format(degrees=apart)
        sentence = texts.SAME_LABEL if same else texts.APART_LABEL
        return Remark(texts.COMPARE_END, amount, sentence.capitalize() + ".")
    text = texts.COMPARE_TURN if names[0] == names[1] else texts.COMPARE_TURN_TWO
    headline = text.format(number=step - 1, left=names[0], right=names[1])
    sentence = texts.COMPARE_SENTENCES[state.arrangement].format(
        axis=names[0],
        left_axis=names[0],
        right_axis=names[1],
        left=degrees(left.angle_deg),
        right=degrees(right.angle_deg),
    )
    amount = degrees(sweep * left.angle_deg) if names[0] == names[1] else ""
    return Remark(headline, amount, sentence, step - 1, "xyz".index(left.axis))


def _now(colour: str, headline: str, amount: str, sentence: str, who: str) -> str:
    """`amount` is HTML, the rest text."""
    right = f"<i>{amount}</i>" if amount else ""
    small = f"<div class='v-who'>{escape(who)}</div>" if who else ""
    return (
        f"<div class='v-now' style='--step:{colour}'><div class='v-top'><b>{escape(headline)}</b>"
        f"{right}</div><p>{escape(sentence)}</p>{small}</div>"
    )

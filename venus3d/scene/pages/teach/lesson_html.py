"""The panels' texts as HTML. Left: lesson, question, whether a pose is acceptable, its information.
Right: the current step in words and numbers."""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.engine.amounts import size_deg
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.prompts import Prompt, step_prompt
from venus3d.languages import cached_by_language, translated
from venus3d.render.map_pictures import (
    distortion_magnification,
    distortion_picture,
    largest_shift_px,
)
from venus3d.render.palette import step_style
from venus3d.render.projections import Picture, corners_outside_text
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.comparison import comparison_words
from venus3d.scene.pages.teach.learner import TabView
from venus3d.scene.pages.teach.scene_shapes import amount_text
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web.lesson_text import lesson_text_html
from venus3d.scene.web.projections_panel import warning_html
from venus3d.scene.web.theme import Theme

_LISTED = 3
_LENS_WIDTH = 640


def _wrapped(body: str) -> str:
    return f"<div class='v-progress'>{body}</div>" if body else ""


def lesson_html(title: str, where: str, text: str) -> str:
    """A page's title, its number, and its text (Markdown), large enough for a class."""
    small = f"<div class='v-where'>{escape(where)}</div>" if where else ""
    return _wrapped(
        f"<div class='v-lesson'><h2>{escape(title)}</h2>{small}{lesson_text_html(text)}</div>"
    )


def acceptance_html(taught: TaughtPose, *, live: bool = True) -> str:
    """Whether guidance would ask for this pose, and why not; gimbal lock. `live`: sliders are
    there to be moved."""
    parts: list[str] = []
    if taught.locked:
        locked = f"{texts.LOCKED} {texts.LOCKED_TRY}" if live else texts.LOCKED
        parts.append(f"<div class='v-refused'><b>{texts.LOCKED_TITLE}</b>{escape(locked)}</div>")
    if taught.refusals:
        lines = "".join(f"<p>{escape(translated(r.text))}</p>" for r in taught.refusals[:_LISTED])
        left = len(taught.refusals) - _LISTED
        more = f"<small>{texts.MORE.format(count=left)}</small>" if left > 0 else ""
        parts.append(f"<div class='v-refused'><b>{texts.REFUSED}</b>{lines}{more}</div>")
    if not parts:
        parts.append(f"<p>{escape(texts.ACCEPTED)}</p>")
    return _wrapped(f"<div class='v-fit'>{''.join(parts)}</div>")


def comparison_html(taught: TaughtPose, state: TeachState) -> str:
    """Why the two boards differ; empty without a comparison."""
    if not state.compares:
        return ""
    apart = taught.apart_deg(state.arrangement)
    figure = texts.SAME if apart < 0.05 else texts.APART.format(angle=size_deg(apart))
    return _wrapped(
        f"<h3>{escape(texts.COMPARE_TITLES[state.arrangement])}</h3>"
        f"<div class='v-figure'>{escape(figure)}</div>"
        f"<div class='v-why'>{texts.COMPARE_WHY[state.arrangement]}</div>"
    )


def untold_comparison_html(taught: TaughtPose, state: TeachState) -> str:
    """The same where a person has asked to compare; a page that compares explains it itself."""
    page = state.current_page
    told = page is not None and page.arrangement == state.arrangement
    return "" if told else comparison_html(taught, state)


def focal_uncertainty_html(taught: TaughtPose) -> str:
    """How well views like this one determine the focal length, as a number and a bar."""
    sigma = taught.sigma_px
    known = bool(np.isfinite(sigma))
    # Logarithmic, from a thousandth of the focal length to all of it.
    share = np.clip(1 + np.log10(max(sigma, 1e-9) / taught.camera.fx) / 3, 0.02, 1) if known else 1
    figure = texts.SIGMA_NOTHING
    if known:
        figure = texts.SIGMA_SHARE.format(px=f"{sigma:.{0 if sigma >= 10 else 1}f}")
    return _wrapped(
        f"<h3>{escape(texts.SIGMA_TITLE)}</h3><div class='v-figure'>{escape(figure)}</div>"
        f"<div class='v-sigma'><i style='width:{100 * float(share):.0f}%'></i></div>"
        f"<div class='v-why'>{escape(translated(taught.sigma_words))} "
        f"{escape(texts.SIGMA_BAR)}</div>"
    )


@cached_by_language(maxsize=2)
def lens_picture(camera: Camera, dark: bool) -> tuple[Picture, str]:
    """How the lens bends the picture, RGB, and the legend as HTML."""
    times, shift = distortion_magnification(camera), largest_shift_px(camera)
    legend = escape(texts.LENS_LEGEND.format(times=times, shift=shift))
    size = (_LENS_WIDTH, round(_LENS_WIDTH * camera.height / camera.width))
    return distortion_picture(camera, size, dark), _wrapped(f"<div class='v-legend'>{legend}</div>")


def question_html(state: TeachState) -> str:
    """The page's question; after an answer, whether it is right, and why."""
    page = state.current_page
    if page is None or page.question is None:
        return ""
    question = page.question
    body = f"<b>{escape(question.text)}</b>"
    if state.answer is not None:
        right = state.answer == question.right
        verdict = texts.RIGHT if right else texts.WRONG
        how = "v-done" if right else "v-wrong"
        body += f"<div class='v-refused {how}'><b>{verdict}</b>{escape(question.why)}</div>"
    return _wrapped(f"<div class='v-question'>{body}</div>")


def holder_sentence(words: Prompt) -> str:
    """The instruction for the board's holder; empty if it is the same for both sides."""
    if words.holder == words.camera:
        return ""
    holder = translated(words.holder)
    return texts.HOLDER.format(words=holder[0].lower() + holder[1:])


def class_html(view: TabView) -> str:
    """Who leads the class; empty without one."""
    text = {"follows": texts.FOLLOWS, "may-lead": texts.MAY_LEAD, "alone": ""}.get(view.role)
    if text is None:
        told = {0: texts.LEADS_NONE, 1: texts.LEADS_ONE}.get(view.others, texts.LEADS)
        text = told.format(others=view.others)
    return _wrapped(f"<div class='v-class'>{escape(text)}</div>") if text else ""


def heading_html(text: str, marked: int = 0) -> str:
    """A heading; the style sheet marks the card of this step (0: none)."""
    return f"<div class='v-steps' data-marked='{marked}'><h3>{text}</h3></div>"


def steps_html(taught: TaughtPose, theme: Theme) -> str:
    """The four steps, each a card with amount, words for both sides, and a place for its picture in
    the set "taught" (`pictures_html`): words do not wait for pictures."""
    cards = "".join(_step_card(step, theme.steps[step.number - 1]) for step in taught.steps)
    return f"<div class='v-steps v-cards'><div class='v-grid'>{cards}</div></div>"


def _step_card(step: Step, colour: str) -> str:
    prompt, amount = step_prompt(step), "–" if step.is_idle else amount_text(step, 1.0)
    words, held = translated(prompt.camera), escape(holder_sentence(prompt))
    alt = escape(texts.STEP_ALT.format(number=step.number, words=words), quote=True)
    return (
        f"<div class='v-tile' data-step='{step.number}' style='--step:{colour}'>"
        f"<div class='v-told'><b>{step.number}</b><strong>{step_style(step.number).title}</strong>"
        f"<i>{escape(amount)}</i><span>{escape(words)}</span>"
        f"<span class='v-held'>{held}</span></div>"
        f"<div class='v-shot' data-shot='taught-{step.number}' role='img' aria-label=\"{alt}\">"
        f"</div>{warning_html(corners_outside_text(len(step.corners_outside)))}</div>"
    )


def card_html(taught: TaughtPose, state: TeachState, theme: Theme, *, live: bool = True) -> str:
    """The current step: headline, amount, and the sentence for the picture and for the hands.
    `live`: who reads it may play the steps."""
    compares = state.compares
    body = _comparison(taught, state, theme) if compares else _step(taught, state, theme, live)
    return f"<div class='v-progress v-wide'>{body}</div>"


def _step(taught: TaughtPose, state: TeachState, theme: Theme, live: bool) -> str:
    step = taught.steps[state.step - 1]
    if state.at_rest or (state.focus is not None and step.is_idle):
        busy = [one for one in taught.steps if not one.is_idle]
        only = _told(busy[0], state) if len(busy) == 1 else []
        sentence = texts.THERE_SENTENCE if busy else texts.NO_WAY_SENTENCE
        offered = [(sentence, "")] if live or not busy else []
        return _now(theme.good, texts.THERE_HEADLINE, "", *offered, *only)
    if state.progress == 0.0:
        return _now(theme.good, texts.START_HEADLINE, "", (texts.START_SENTENCE, ""))
    headline = texts.STEP.format(number=step.number, title=step_style(step.number).title)
    amount = "" if step.is_idle else escape(amount_text(step, state.sweep))
    if amount and state.sweep < 1:
        whole = texts.OF.format(whole=amount_text(step, 1.0))
        amount += f"<small>{escape(whole)}</small>"
    return _now(theme.steps[step.number - 1], headline, amount, *_told(step, state))


def _told(step: Step, state: TeachState) -> list[tuple[str, str]]:
    """The step in words, and for whom; the side that is looked from comes first."""
    words = step_prompt(step)
    seen, held = translated(words.camera), translated(words.holder)
    if seen == held:
        return [(seen, texts.SIDES["both"])]
    told = [(seen, texts.SIDES["camera"]), (held, texts.SIDES["holder"])]
    return told[::-1] if state.viewpoint == "holder" else told


def _comparison(taught: TaughtPose, state: TeachState, theme: Theme) -> str:
    words = comparison_words(taught, state)
    colour = theme.good if words.turn is None else theme.steps[words.axis + 1]
    return _now(colour, words.headline, words.amount, (words.sentence, ""))


def _now(colour: str, headline: str, amount: str, *told: tuple[str, str]) -> str:
    """`amount` is HTML, the rest text; `told` are sentences and for whom they are."""
    right = f"<i>{amount}</i>" if amount else ""
    sentences = "".join(
        f"<p>{escape(sentence)}{f' <small>{escape(who)}</small>' if who else ''}</p>"
        for sentence, who in told
    )
    return (
        f"<div class='v-now' style='--step:{colour}'><div class='v-top'><b>{escape(headline)}</b>"
        f"{right}</div>{sentences}</div>"
    )

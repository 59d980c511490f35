"""The panels' texts as HTML. Left: lesson, question, whether a pose is acceptable, its information.
Right: the current step in words and numbers."""

from __future__ import annotations

from functools import lru_cache
from html import escape

import numpy as np

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.render.map_pictures import (
    distortion_magnification,
    distortion_picture,
    largest_shift_px,
)
from venus3d.render.palette import STEP_STYLES, step_style
from venus3d.render.projections import Picture
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.comparison import comparison_words
from venus3d.scene.pages.teach.scene_shapes import amount_text
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web.lesson_text import lesson_text_html
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
    present."""
    parts: list[str] = []
    if taught.locked:
        locked = f"{texts.LOCKED} {texts.LOCKED_TRY}" if live else texts.LOCKED
        parts.append(f"<div class='v-refused'><b>{texts.LOCKED_TITLE}</b>{escape(locked)}</div>")
    if taught.refusals:
        lines = "".join(f"<p>{escape(r.text)}</p>" for r in taught.refusals[:_LISTED])
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
    figure = texts.SAME if apart < 0.05 else texts.APART.format(degrees=apart)
    return _wrapped(
        f"<h3>{escape(texts.COMPARE_TITLES[state.arrangement])}</h3>"
        f"<div class='v-figure'>{escape(figure)}</div>"
        f"<div class='v-why'>{texts.COMPARE_WHY[state.arrangement]}</div>"
    )


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
        f"<h3>{escape(texts.SIGMA_TITLE)}</h3><div class='v-figure'>{escape(figure)} "
        f"<small>{escape(texts.SIGMA_OF)}</small></div>"
        f"<div class='v-sigma'><i style='width:{100 * float(share):.0f}%'></i></div>"
        f"<div class='v-why'>{escape(taught.sigma_words)} {escape(texts.SIGMA_BAR)}</div>"
    )


@lru_cache(maxsize=2)
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
        done = " v-done" if right else ""
        body += f"<div class='v-refused{done}'><b>{verdict}</b>{escape(question.why)}</div>"
    return _wrapped(f"<div class='v-question'>{body}</div>")


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
        whole = "–" if step.is_idle else amount_text(step, 1.0)
        cells.append(
            f"<div{on} style='--step:{theme.steps[step.number - 1]}'><b>{step.number}</b>"
            f"<span>{style.short_title}</span><i>{escape(whole)}</i></div>"
        )
    return "".join(cells)


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

"""The left column's texts as HTML: lesson, whether a pose is acceptable, and its information."""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web.lesson_text import lesson_text_html

_LISTED = 3


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


def lens_legend_html(times: float, shift_px: float) -> str:
    """The legend of the lens picture."""
    return _wrapped(
        f"<div class='v-legend'>{escape(texts.LENS_LEGEND.format(times=times, shift=shift_px))}"
        "</div>"
    )


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

"""What the left column says of a pose: whether it may be, what is odd about it, what it tells."""

from __future__ import annotations

from html import escape

import numpy as np

from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import TeachMoment
from venus3d.scene.web.lesson_text import LESSON_TEXT_SHEET, lesson_text_html
from venus3d.scene.web.theme import Theme

_LISTED = 3
_SHEET = """<style>
.v-lesson,.v-question{font-size:clamp(17px,2.35vh,27px);line-height:1.34;color:var(--text);
overflow-wrap:anywhere}
.v-lesson>h2{font-size:1.28em;line-height:1.15;margin:0 0 .1em}
.v-where{font-size:max(13px,.62em);color:var(--soft);margin-bottom:.5em}
.v-question{font-size:clamp(16px,2.1vh,24px)}
.v-question>b{display:block;line-height:1.25;font-weight:700}
.v-question .v-refused{font-size:.9em;line-height:1.3;margin:8px 0 0}
.mantine-ScrollArea-root:has(.v-lesson) button[data-block] .mantine-Button-label{
font-size:clamp(15px,1.95vh,22px)}
.v-fit{font-size:14px;line-height:1.32;min-height:2.7em}
.v-fit p{margin:0 0 4px}
.v-refused{border-left:5px solid var(--info);background:var(--tile);border-radius:0 6px 6px 0;
padding:5px 9px;margin-bottom:6px}
.v-refused b{display:block;font-weight:750}
.v-refused small{font-size:13px;color:var(--soft)}
.v-bar{height:14px;border-radius:7px;background:var(--tile);border:1px solid var(--line);
overflow:hidden;margin:4px 0}
.v-bar i{display:block;height:100%;background:var(--info)}
.v-figure{font-size:26px;font-weight:780;line-height:1.1}
.v-figure small{display:block;font-size:14px;line-height:1.25;color:var(--soft);font-weight:550}
.v-say{font-size:14px;line-height:1.35}
</style>"""


def _wrapped(body: str) -> str:
    return f"{_SHEET}<div class='v-progress'>{body}</div>" if body else ""


def lesson_html(title: str, where: str, text: str) -> str:
    """A page's title, which page it is, and its text (Markdown), in letters that a class can
    read."""
    small = f"<div class='v-where'>{escape(where)}</div>" if where else ""
    return _wrapped(
        f"<style>{LESSON_TEXT_SHEET}</style><div class='v-lesson'><h2>{escape(title)}</h2>{small}"
        f"{lesson_text_html(text)}</div>"
    )


def fit_html(moment: TeachMoment, *, live: bool = True) -> str:
    """Whether a person would be asked for this pose, and why not; gimbal lock.

    Args:
        live: there are sliders to try it with.
    """
    parts: list[str] = []
    if moment.locked:
        locked = f"{texts.LOCKED} {texts.LOCKED_TRY}" if live else texts.LOCKED
        parts.append(f"<div class='v-refused'><b>{texts.LOCKED_TITLE}</b>{escape(locked)}</div>")
    if moment.refusals:
        lines = "".join(f"<p>{escape(r.text)}</p>" for r in moment.refusals[:_LISTED])
        left = len(moment.refusals) - _LISTED
        more = f"<small>{texts.MORE.format(count=left)}</small>" if left > 0 else ""
        parts.append(f"<div class='v-refused'><b>{texts.REFUSED}</b>{lines}{more}</div>")
    if not parts:
        parts.append(f"<p>{escape(texts.ACCEPTED)}</p>")
    return _wrapped(f"<div class='v-fit'>{''.join(parts)}</div>")


def why_html(moment: TeachMoment, state: TeachState) -> str:
    """Why the two boards side by side differ; empty if none are shown."""
    if not state.compares:
        return ""
    apart = moment.apart_deg(state.arrangement)
    figure = texts.SAME if apart < 0.05 else texts.APART.format(degrees=apart)
    return _wrapped(
        f"<h3>{escape(texts.COMPARE_TITLES[state.arrangement])}</h3>"
        f"<div class='v-figure'>{escape(figure)}</div>"
        f"<div class='v-say'>{texts.COMPARE_WHY[state.arrangement]}</div>"
    )


def sigma_html(moment: TeachMoment) -> str:
    """How well views like this one tell the focal length, as a figure and a bar."""
    sigma = moment.sigma_px
    known = bool(np.isfinite(sigma))
    # From a thousandth of the focal length to all of it, each tenfold the same length.
    share = np.clip(1 + np.log10(max(sigma, 1e-9) / moment.camera.fx) / 3, 0.02, 1) if known else 1
    figure = texts.SIGMA_NOTHING
    if known:
        figure = texts.SIGMA_SHARE.format(px=f"{sigma:.{0 if sigma >= 10 else 1}f}")
    return _wrapped(
        f"<h3>{escape(texts.SIGMA_TITLE)}</h3><div class='v-figure'>{escape(figure)} "
        f"<small>{escape(texts.SIGMA_OF)}</small></div>"
        f"<div class='v-bar'><i style='width:{100 * float(share):.0f}%'></i></div>"
        f"<div class='v-say'>{escape(moment.sigma_words)} {escape(texts.SIGMA_BAR)}</div>"
    )


def lens_html(times: float, shift_px: float) -> str:
    """The legend of the picture of the lens."""
    return _wrapped(
        f"<div class='v-legend'>{escape(texts.LENS_LEGEND.format(times=times, shift=shift_px))}"
        "</div>"
    )


def question_html(state: TeachState, theme: Theme) -> str:
    """The page's question, and after an answer whether it is right, and why."""
    page = state.current_page
    if page is None or page.question is None:
        return ""
    question = page.question
    body = f"<b>{escape(question.text)}</b>"
    if state.answer is not None:
        right = state.answer == question.right
        verdict = texts.RIGHT if right else texts.WRONG
        colour = theme.reached if right else theme.info
        body += (
            f"<div class='v-refused' style='--info:{colour}'><b>{verdict}</b>"
            f"{escape(question.why)}</div>"
        )
    return _wrapped(f"<div class='v-question'>{body}</div>")

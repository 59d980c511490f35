"""A lesson as one HTML file that plays offline: texts, steps as the camera sees them, 3D scene.

It contains viser's player once, and a recording and four pictures per page, and loads nothing.
Without JavaScript the first page's words and pictures still show. A lesson's content is escaped
text; as a second barrier, the document's policy allows only the player's and our scripts and no
external resources.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.languages import current_language, translated
from venus3d.lessons.lesson import Lesson, Question
from venus3d.render.palette import hex_of, step_style, text_on
from venus3d.render.projections import Picture
from venus3d.scene.pages.teach import texts as teach_texts
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.export.animation import ExportedPage
from venus3d.scene.pages.teach.export.scene_recording import ASPECT, player_scripts
from venus3d.scene.pages.teach.export.sentences import pose_sentence
from venus3d.scene.pages.teach.lesson_html import (
    acceptance_html,
    comparison_html,
    focal_uncertainty_html,
    holder_sentence,
    lens_picture,
)
from venus3d.scene.web.lesson_text import lesson_text_html
from venus3d.scene.web.projections_panel import encoded
from venus3d.scene.web.theme import Theme, style_sheet

_PLAYER_BAR_PX = 32
"""Minimum height of the player's bar below the scene."""


@dataclass(frozen=True, eq=False)
class PageContent:
    """Content of one page of the document."""

    page: ExportedPage
    pictures: tuple[Picture, ...]
    """The four steps as the camera sees them, RGB."""
    recording: str
    """The scene, base64 (`scene_recording`)."""


def html_document(
    lesson: Lesson, contents: Sequence[PageContent], player: str, *, dark: bool = False
) -> str:
    """The whole file; `contents` in the pages' order, `player` is viser's."""
    pages = "".join(
        _page(content, number, len(contents), dark) for number, content in enumerate(contents)
    )
    recordings = [content.recording for content in contents]
    places = f":root{{--aspect:{ASPECT};--player-bar:{_PLAYER_BAR_PX}px}}"
    given = _GIVEN.replace("DARK", json.dumps(dark))
    script = (Path(__file__).parent / "document.js").read_text(encoding="utf-8")
    script = script.replace("GIVEN", json.dumps(given))
    script = script.replace("STYLE", json.dumps(style_sheet("player")))
    players = player_scripts(player)
    policy = _policy((script, given, *players) if players else None)
    return (
        f"<!doctype html><html lang='{current_language()}'><head><meta charset='utf-8'>"
        f"<meta http-equiv='Content-Security-Policy' content=\"{policy}\">"
        "<meta name='viewport' content='width=device-width,initial-scale=1'>"
        f"<title>{escape(lesson.title)}</title>"
        f"<style>{Theme(dark).variables}{style_sheet('style')}{style_sheet('document')}{places}</style></head><body>"
        f"<header><h1>{escape(lesson.title)}</h1><p>{escape(lesson.summary)}</p></header>"
        f"<main><div>{pages}</div><section class='scene'>"
        f"<h3>{texts.SCENE_TITLE}</h3><iframe id='scene' title='{texts.SCENE_TITLE}'></iframe>"
        f"<p class='hint'>{texts.SCENE_HINT}</p><noscript>{texts.NO_SCRIPT}</noscript></section>"
        f"</main><footer>{texts.MADE_WITH}</footer>"
        f"<script type='application/json' id='player'>{_inside(player)}</script>"
        f"<script type='application/json' id='recordings'>{_inside(recordings)}</script>"
        f"<script>{script}</script></body></html>"
    )


def _policy(scripts: Sequence[str] | None) -> str:
    """The content security policy: allows these scripts and loads nothing; the scene's frame
    inherits it.

    Args:
        scripts: None if not all are known; then all inline scripts are allowed.
    """
    allowed = "'unsafe-inline'"
    if scripts is not None:
        digests = (hashlib.sha256(script.encode()).digest() for script in scripts)
        allowed = " ".join(f"'sha256-{base64.b64encode(each).decode()}'" for each in digests)
    return (
        f"default-src 'none'; script-src {allowed} 'wasm-unsafe-eval'; style-src 'unsafe-inline'; "
        "img-src data: blob:; connect-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def _inside(value: object) -> str:
    """JSON that cannot close its script element."""
    return json.dumps(value).replace("</", "<\\/").replace("<!--", "<\\u0021--")


def _page(content: PageContent, number: int, count: int, dark: bool) -> str:
    page, taught = content.page.page, content.page.taught
    where = texts.PAGE_OF.format(page=number + 1, pages=count)
    turn = (
        f"<nav><button data-go='-1'>{texts.BACK}</button><span>{where}</span>"
        f"<button data-go='1'>{texts.ON}</button></nav>"
        if count > 1
        else ""
    )
    steps = "".join(
        _step(step, picture, dark)
        for step, picture in zip(taught.steps, content.pictures, strict=True)
    )
    return (
        f"<article data-page='{number}'{'' if number == 0 else ' hidden'}>{turn}"
        f"<h2>{escape(page.title)}</h2>{lesson_text_html(page.text)}{_figures(content.page, dark)}"
        f"{_question(page.question)}<h3>{texts.POSE_TITLE}</h3><p>{pose_sentence(page.pose)}</p>"
        f"{acceptance_html(taught, live=False)}"
        f"<h3>{texts.STEPS_TITLE}</h3><div class='steps'>{steps}</div></article>"
    )


def _figures(page: ExportedPage, dark: bool) -> str:
    """Figures for the text: the two boards, the focal length, the lens."""
    taught = page.taught
    parts = [comparison_html(taught, page.state)]
    if "sigma" in page.page.show:
        parts.append(focal_uncertainty_html(taught))
    if "distortion" in page.page.show:
        picture, legend = lens_picture(taught.camera, dark)
        title = escape(teach_texts.LENS_TITLE)
        image = f"<img class='lens' alt=\"{title}\" src='{encoded(picture)}'>"
        parts.append(f"<h3>{title}</h3>{image}{legend}")
    return "".join(parts)


def _step(step: Step, picture: Picture, dark: bool) -> str:
    style, words = step_style(step.number), translated(step_prompt(step).camera)
    colour = style.colour(dark)
    alt = escape(teach_texts.STEP_ALT.format(number=step.number, words=words), quote=True)
    look = f"--step:{hex_of(colour)};--on:{hex_of(text_on(colour))}"
    held = f"<br><small>{escape(holder_sentence(step_prompt(step)))}</small>"
    return (
        f"<figure style='{look}'><figcaption><b>{step.number}</b><span>"
        f"<strong>{style.title}</strong><br>{escape(words)}"
        f"{held}</span></figcaption>"
        f"<img alt=\"{alt}\" src='{encoded(picture)}'>"
        "</figure>"
    )


def _question(question: Question | None) -> str:
    if question is None:
        return ""
    answers = "".join(
        f"<button data-answer='{int(number == question.right)}'>{escape(answer)}</button>"
        for number, answer in enumerate(question.answers, start=1)
    )
    why = escape(question.why)
    verdicts = (
        f"<p hidden class='v-right' data-verdict='1'><b>✓ {texts.RIGHT}</b> {why}</p>"
        f"<p hidden class='v-wrong' data-verdict='0'><b>✕ {texts.WRONG}</b> {why}</p>"
    )
    return (
        f"<section class='question'><h3>{texts.QUESTION}</h3><p>{escape(question.text)}</p>"
        f"{answers}<div aria-live='polite'>{verdicts}</div></section>"
    )


# The player reads its recording from a global at its start, so each page gets a new frame.
_GIVEN = (
    "window.__VISER_EMBED_DATA__=parent.recording;window.__VISER_EMBED_CONFIG__={darkMode:DARK};"
)

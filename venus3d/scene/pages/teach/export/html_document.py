"""A lesson as one HTML file that plays offline: texts, steps as the camera sees them, 3D scene.

A lesson's content is escaped text; the document's policy (`offline_document`) is a second barrier.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.languages import translated
from venus3d.lessons.lesson import Lesson, Question
from venus3d.render.projections import Picture
from venus3d.scene.pages.teach import texts as teach_texts
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.export.animation import ExportedPage
from venus3d.scene.pages.teach.export.sentences import pose_sentence
from venus3d.scene.pages.teach.lesson_html import (
    acceptance_html,
    comparison_html,
    focal_uncertainty_html,
    holder_sentence,
    lens_picture,
)
from venus3d.scene.web.lesson_text import lesson_text_html
from venus3d.scene.web.offline_document import OfflinePage, offline_document, step_figure
from venus3d.scene.web.projections_panel import encoded


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
    pages = [OfflinePage(_page(content, dark), content.recording) for content in contents]
    return offline_document(lesson.title, lesson.summary, pages, player, dark=dark)


def _page(content: PageContent, dark: bool) -> str:
    page, taught = content.page.page, content.page.taught
    steps = "".join(
        _step(step, picture, dark)
        for step, picture in zip(taught.steps, content.pictures, strict=True)
    )
    return (
        f"<h2>{escape(page.title)}</h2>{lesson_text_html(page.text)}{_figures(content.page, dark)}"
        f"{_question(page.question)}<h3>{texts.POSE_TITLE}</h3><p>{pose_sentence(page.pose)}</p>"
        f"{acceptance_html(taught, live=False)}"
        f"<h3>{texts.STEPS_TITLE}</h3><div class='steps'>{steps}</div>"
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
    words = translated(step_prompt(step).camera)
    alt = teach_texts.STEP_ALT.format(number=step.number, words=words)
    return step_figure(step, picture, alt, words, holder_sentence(step_prompt(step)), dark=dark)


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

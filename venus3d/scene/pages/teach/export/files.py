"""A lesson, or one pose, as files: a page that plays offline, a sheet to print, a film.

What the files look like is `scene.export`'s, where they go is the command line's or the page's.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Literal, get_args

from venus3d.engine.errors import StorageError
from venus3d.lessons.lesson import Lesson, LessonPage
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.export.document import PageContent, document
from venus3d.scene.pages.teach.export.film import (
    GIF_FPS,
    GIF_WIDTH,
    MP4_FPS,
    MP4_WIDTH,
    film,
    gif,
    mp4,
)
from venus3d.scene.pages.teach.export.journey import opened
from venus3d.scene.pages.teach.export.scene3d import player, recorded
from venus3d.scene.pages.teach.export.sheet import sheet
from venus3d.scene.pages.teach.state import Vector
from venus3d.scene.pages.teach.view_model import TeachMoment
from venus3d.scene.render.offscreen import Offscreen
from venus3d.scene.render.projections import Projections
from venus3d.scene.web.server import start_server

Kind = Literal["html", "png", "mp4", "gif"]
KINDS: tuple[Kind, ...] = get_args(Kind)
_PICTURE_SIZE_PX = 640
_FIRST_PORT = 8900
Study = Callable[[Vector, str], TeachMoment]
"""Takes a pose apart: degrees and millimetres, and the order of turns shown beside "xyz"."""


def kind_of(path: Path) -> Kind:
    """What a file of this name is. Raises `StorageError` for an ending that is not known."""
    for kind in KINDS:
        if path.suffix.lower() == f".{kind}":
            return kind
    raise StorageError(
        f"A lesson is exported as .html, .png, .mp4 or .gif, not as {path.name!r}; name the file "
        "with one of these endings."
    )


def lesson_of_pose(vector: Vector) -> Lesson:
    """One pose as a lesson of one page."""
    page = LessonPage(texts.TARGET_PAGE, texts.TARGET_TEXT, vector)
    return Lesson("pose", texts.TARGET_TITLE, "", (page,))


def exported(
    lesson: Lesson, kind: Kind, study: Study, offscreen: Offscreen, *, dark: bool = False
) -> tuple[bytes, ...]:
    """The lesson's files of this kind: one; of sheets, one for each pose with anything to do."""
    moments = [study(page.pose, page.order or "zyx") for page in lesson.pages]
    if kind == "html":
        return (_html(lesson, moments, offscreen, dark).encode("utf-8"),)
    if kind == "png":
        return _sheets(lesson, moments, offscreen)
    fps, width = (MP4_FPS, MP4_WIDTH) if kind == "mp4" else (GIF_FPS, GIF_WIDTH)
    pictures = film(lesson, moments, offscreen, fps=fps, width=width, dark=dark)
    return ((mp4 if kind == "mp4" else gif)(pictures, fps),)


def _html(lesson: Lesson, moments: list[TeachMoment], offscreen: Offscreen, dark: bool) -> str:
    projections, contents = Projections(offscreen), list[PageContent]()
    server, _ = start_server("127.0.0.1", _FIRST_PORT)  # only to record; nobody is told of it
    try:
        for number, moment in enumerate(moments):
            camera = moment.camera
            size = (_PICTURE_SIZE_PX, round(_PICTURE_SIZE_PX * camera.height / camera.width))
            one, two, three, four = (
                projections.of_step(
                    step, camera, moment.board, size=size, dark=dark, header=False
                ).result()
                for step in moment.steps
            )
            state = opened(lesson, number, dark=dark)
            recording = recorded(server, moment, state)
            contents.append(PageContent(moment, state, (one, two, three, four), recording))
    finally:
        server.stop()
    return document(lesson, contents, player(), dark=dark)


def _sheets(lesson: Lesson, moments: list[TeachMoment], offscreen: Offscreen) -> tuple[bytes, ...]:
    pages = list(zip(lesson.pages, moments, strict=True))
    busy = [(p, m) for p, m in pages if not all(step.is_idle for step in m.steps)]
    return tuple(
        sheet(moment, page.pose, f"{lesson.title}: {page.title}", offscreen)
        for page, moment in busy or pages[:1]
    )

"""Exports a lesson, or one pose, to bytes: an offline page, sheets to print, a film."""

from __future__ import annotations

from pathlib import Path

from venus3d.engine.errors import StorageError
from venus3d.lessons.lesson import Lesson, LessonPage
from venus3d.render.film import mp4
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.scene.pages.teach.actions import FILE_KINDS, FileKind
from venus3d.scene.pages.teach.export import texts
from venus3d.scene.pages.teach.export.animation import (
    ExportedPage,
    animation_states,
    exported_pages,
)
from venus3d.scene.pages.teach.export.film import (
    GIF_FPS,
    GIF_WIDTH,
    MP4_FPS,
    MP4_WIDTH,
    film,
    gif,
)
from venus3d.scene.pages.teach.export.html_document import PageContent, html_document
from venus3d.scene.pages.teach.export.sheet import sheet
from venus3d.scene.pages.teach.scene_shapes import scene_shapes, scene_view_of
from venus3d.scene.pages.teach.state import Vector
from venus3d.scene.pages.teach.view_model import AnalysePose
from venus3d.scene.web.scene_recording import (
    ASPECT,
    FPS,
    player,
    recording_of,
    recording_server,
)
from venus3d.scene.web.server import LocalServer

_PICTURE_SIZE_PX = 640


def kind_of(path: Path) -> FileKind:
    """The file type of this name. Raises `StorageError` for an unknown extension."""
    for kind in FILE_KINDS:
        if path.suffix.lower() == f".{kind}":
            return kind
    raise StorageError(
        f"A lesson is exported as .html, .png, .mp4 or .gif, not as {path.name!r}; name the file "
        "with one of these endings."
    )


def lesson_of_pose(vector: Vector) -> Lesson:
    """One pose as a one-page lesson."""
    page = LessonPage(texts.TARGET_PAGE, texts.TARGET_TEXT, vector)
    return Lesson("pose", texts.TARGET_TITLE, "", (page,))


def export_files(
    lesson: Lesson,
    kind: FileKind,
    analyse: AnalysePose,
    offscreen: Offscreen,
    *,
    dark: bool = False,
) -> tuple[bytes, ...]:
    """The lesson's files of this type: one; for sheets, one per pose with anything to do."""
    pages = exported_pages(lesson, analyse, dark=dark)
    if kind == "html":
        contents = _page_contents(pages, offscreen)
        return (html_document(lesson, contents, player(), dark=dark).encode("utf-8"),)
    if kind == "png":
        busy = [page for page in pages if not page.is_idle] or pages[:1]
        return tuple(
            sheet(p.taught, p.page.pose, f"{lesson.title}: {p.page.title}", offscreen) for p in busy
        )
    if kind == "mp4":
        return (mp4(film(lesson, pages, offscreen, fps=MP4_FPS, width=MP4_WIDTH), MP4_FPS),)
    return (gif(film(lesson, pages, offscreen, fps=GIF_FPS, width=GIF_WIDTH), GIF_FPS),)


def _page_contents(pages: list[ExportedPage], offscreen: Offscreen) -> list[PageContent]:
    projections, contents = Projections(offscreen), list[PageContent]()
    with recording_server() as server:
        for page in pages:
            camera, board = page.taught.camera, page.taught.board
            size = (_PICTURE_SIZE_PX, round(_PICTURE_SIZE_PX * camera.height / camera.width))
            pictures = tuple(
                projections.of_step(
                    step, camera, board, size=size, dark=page.state.dark, header=False
                ).result()
                for step in page.taught.steps
            )
            contents.append(PageContent(page, pictures, _recording(server, page)))
    return contents


def _recording(server: LocalServer, page: ExportedPage) -> str:
    states = animation_states(page, FPS)
    moments = [scene_shapes(page.taught, state) for state in states]
    view = scene_view_of(page.taught, states[0], moments[0], ASPECT)
    return recording_of(server, moments, view, dark=page.state.dark)

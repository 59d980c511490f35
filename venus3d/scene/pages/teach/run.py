"""Runs the teaching page and exports lessons."""

from __future__ import annotations

from contextlib import closing
from functools import partial

from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.lessons.lesson import Lesson
from venus3d.lessons.reading import lesson_of, shipped_lessons
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import FILE_KINDS, FileKind
from venus3d.scene.pages.teach.export.files import export_files, lesson_of_pose
from venus3d.scene.pages.teach.options import TeachOptions
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import AnalysePose, PoseAnalysis
from venus3d.scene.pages.teach.viewer import TeachViewer
from venus3d.scene.web.page import announce_page
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.threads.latency import low_latency


def run_teach(options: TeachOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can fix."""
    camera = PAPER_CAMERA if options.camera is None else read_camera_yaml(options.camera)
    analyse = PoseAnalysis(camera, options.board.board())
    lessons, chosen = _lessons(options.lesson)
    with closing(Offscreen()) as offscreen:
        viewer = TeachViewer(
            analyse,
            offscreen,
            camera,
            host=options.host,
            port=options.port,
            lessons=lessons,
            lesson=chosen,
            save=partial(_saved_file, analyse, offscreen),
            kinds=FILE_KINDS,
        )
        with closing(viewer), low_latency():
            announce_page(texts.ANNOUNCED, viewer.url, *viewer.notes)
            while True:
                viewer.wait(1.0)


def _saved_file(
    analyse: AnalysePose, offscreen: Offscreen, state: TeachState, kind: FileKind
) -> tuple[str, bytes]:
    """Name and content of a file: the open lesson, or else the pose; a picture is always of the
    pose."""
    lesson = state.current_lesson
    if lesson is None or kind == "png":
        lesson = lesson_of_pose(state.vector)
    files = export_files(lesson, kind, analyse, offscreen, dark=state.dark)
    return texts.FILE_NAME.format(name=lesson.name, kind=kind), files[0]


def export_lesson(options: TeachOptions, kind: FileKind) -> tuple[tuple[bytes, ...], str]:
    """The chosen lesson's files of this type, and why the painter drew them if OpenGL did not.
    Raises `VenusError` for whatever the user can fix."""
    camera = PAPER_CAMERA if options.camera is None else read_camera_yaml(options.camera)
    analyse = PoseAnalysis(camera, options.board.board())
    lesson = lesson_of(options.lesson)
    with closing(Offscreen()) as offscreen:
        note = offscreen.note  # a later one is logged
        return export_files(lesson, kind, analyse, offscreen, dark=options.dark), note


def _lessons(choice: str) -> tuple[tuple[Lesson, ...], int | None]:
    """All lessons, the user's own first, and the number of the chosen one."""
    shipped = shipped_lessons()
    if not choice and not shipped:
        return (), None
    lesson = lesson_of(choice)
    if lesson in shipped:
        return shipped, shipped.index(lesson)
    return (lesson, *shipped), 0

"""Runs the teaching page and exports lessons."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import replace
from functools import lru_cache, partial

from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.languages import Language, PageLanguage, current_language
from venus3d.lessons.lesson import Lesson
from venus3d.lessons.reading import lesson_of, shipped_lessons
from venus3d.render.offscreen import Offscreen
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.pages.teach import terminal_texts, texts
from venus3d.scene.pages.teach.actions import FILE_KINDS, FileKind
from venus3d.scene.pages.teach.export.files import export_files, lesson_of_pose
from venus3d.scene.pages.teach.learner import Classroom, Learner, Look
from venus3d.scene.pages.teach.options import TeachOptions
from venus3d.scene.pages.teach.page import SaveFile, TeachPage
from venus3d.scene.pages.teach.pictures import TeachPictures
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view_model import AnalysePose, PoseAnalysis
from venus3d.scene.web.page import announce_page
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.scene.web.tabs import TabServer
from venus3d.storage.formats import camera_in
from venus3d.threads.latency import low_latency


def run_teach(options: TeachOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can fix."""
    camera = PAPER_CAMERA if options.camera is None else camera_in(options.camera).camera
    analyse = PoseAnalysis(camera, options.board.board())
    lessons, chosen = _lessons(options.lesson)
    with ExitStack() as stack:
        offscreen = stack.enter_context(closing(Offscreen()))
        server, note = start_server(
            options.host, options.port, options.language, asks_token=options.token
        )
        stack.callback(server.stop)
        teach = TeachServer(
            server,
            analyse,
            offscreen,
            lessons=lessons,
            lesson=chosen,
            translated=lambda language: _lessons(options.lesson, language)[0],
            follow_me=options.follow_me,
            save=partial(_saved_file, analyse, offscreen),
            kinds=FILE_KINDS,
        )
        stack.enter_context(closing(teach))
        outside = [note for one in lessons for note in notes_on_poses(one, analyse)]
        how = terminal_texts.FOLLOW_ME.format(url=server.url) if options.follow_me else ""
        announce_page(texts.ANNOUNCED, server, note, offscreen.note, *outside, how)
        with low_latency():
            teach.run()


class TeachServer(TabServer[Learner]):
    """All tabs of one server, each with a learner of its own."""

    def __init__(
        self,
        server: LocalServer,
        analyse: AnalysePose,
        offscreen: Offscreen,
        *,
        lessons: tuple[Lesson, ...] = (),
        lesson: int | None = None,
        translated: Callable[[Language], tuple[Lesson, ...]] | None = None,
        follow_me: bool = False,
        save: SaveFile | None = None,
        kinds: tuple[FileKind, ...] = (),
        dark: bool = True,
    ) -> None:
        """Accept learners. The caller closes server and renderer afterwards.

        Args:
            analyse: called on the drawing thread; a few milliseconds at most.
            lesson: the number of the lesson open at first; None: free.
            translated: the same lessons in a tab's language.
            follow_me: whether one tab, on this machine, leads all others.
            save, kinds: makes files, and the available types; called on separate threads.
        """
        self._first = TeachState(dark=dark, lessons=lessons).opened(lesson)
        self._translated = translated
        self._analyse = lru_cache(maxsize=64)(analyse)
        self._room = Classroom(lambda: set(server.get_clients())) if follow_me else None
        pictures = TeachPictures(offscreen)
        super().__init__(
            server,
            texts.ANNOUNCED,
            self._learner,
            partial(TeachPage, pictures=pictures, save=save, kinds=kinds),
            wishes=lambda learner: learner.language,
        )

    def _learner(self, number: int) -> Learner:
        client, first = self.server.get_clients()[number], self._first
        if self._translated is not None:
            first = replace(first, lessons=self._translated(current_language()))

        def look() -> Look:
            camera = client.camera
            view = SceneCamera(camera.position.copy(), camera.look_at.copy(), camera.fov)
            return view, camera.image_width / max(camera.image_height, 1)

        return Learner(
            self._analyse,
            first,
            number=number,
            room=self._room,
            may_lead=self.server.is_on_this_machine(number),
            look=look,
        )


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


def notes_on_poses(lesson: Lesson, analyse: AnalysePose) -> list[str]:
    """A sentence for each page whose board is not all in the picture."""
    notes: list[str] = []
    for number, page in enumerate(lesson.pages, start=1):
        count = analyse(page.pose, page.order or "zyx").corners_outside
        if count:
            notes.append(
                terminal_texts.LEAVES_PICTURE.format(
                    lesson=lesson.title, page=number, title=page.title, count=count
                )
            )
    return notes


def export_lesson(
    options: TeachOptions, kind: FileKind
) -> tuple[tuple[bytes, ...], tuple[str, ...]]:
    """The chosen lesson's files of this type, and notes: why the painter drew them if OpenGL did
    not, and which poses leave the picture. Raises `VenusError` for whatever the user can fix."""
    camera = PAPER_CAMERA if options.camera is None else camera_in(options.camera).camera
    analyse = PoseAnalysis(camera, options.board.board())
    lesson = lesson_of(options.lesson, options.language or "en")
    language = PageLanguage(lesson.language or options.language)
    with closing(Offscreen()) as offscreen, language.spoken():
        notes = (offscreen.note, *notes_on_poses(lesson, analyse))  # a later one is logged
        files = export_files(lesson, kind, analyse, offscreen, dark=options.dark)
        return files, tuple(note for note in notes if note)


def _lessons(choice: str, language: Language = "en") -> tuple[tuple[Lesson, ...], int | None]:
    """All lessons, the user's own first, and the number of the chosen one."""
    shipped = shipped_lessons(language)
    if not choice and not shipped:
        return (), None
    lesson = lesson_of(choice, language)
    if lesson in shipped:
        return shipped, shipped.index(lesson)
    return (lesson, *shipped), 0

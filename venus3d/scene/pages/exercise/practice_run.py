"""The practice server: every tab is a trainee with their own board, scene and panels. Only the file
and the server are shared. Closing a tab discards its trainee."""

from __future__ import annotations

import sys
import time
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing, suppress
from typing import Any

import viser

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.render.offscreen import Offscreen
from venus3d.render.shapes import Shape
from venus3d.scene.pages.exercise.exercise import Exercise
from venus3d.scene.pages.exercise.options import PracticeOptions
from venus3d.scene.pages.exercise.page import Picture
from venus3d.scene.pages.exercise.picture_turns import fitting
from venus3d.scene.pages.exercise.practice import Practice, PracticeSettings
from venus3d.scene.pages.exercise.practice_page import PracticePage
from venus3d.scene.pages.exercise.practice_shapes import (
    picture_background,
    picture_finish,
    picture_shapes,
    target_picture_shapes,
)
from venus3d.scene.pages.exercise.practice_texts import TITLE, WRITTEN
from venus3d.scene.pages.exercise.server import ExerciseServer, Tab
from venus3d.scene.pages.exercise.view_model import PracticeViewModel, Request
from venus3d.scene.web.page import announce_page
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.storage.exercise import ExerciseFile, ExerciseRow
from venus3d.threads.latency import low_latency

FILE = "practice.csv"
_PERIOD_S = 1 / 30
_PICTURE_SIZE = (480, 270)


def run_practice(options: PracticeOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can fix,
    `KeyboardInterrupt` if nothing was written."""
    options.check()
    camera = PAPER_CAMERA if options.camera is None else read_camera_yaml(options.camera)
    path = options.output / FILE
    settings = PracticeSettings.of(camera, options.board.board(), options.seed, str(path))
    with ExitStack() as stack:
        file = stack.enter_context(closing(ExerciseFile(path, "practice")))
        before = len(file.rows)
        offscreen = stack.enter_context(closing(Offscreen()))
        server, note = start_server(options.host, options.port)
        stack.callback(server.stop)
        practice = stack.enter_context(closing(PracticeServer(server, settings, file, offscreen)))
        announce_page(TITLE, server.url, note, offscreen.note)
        with suppress(KeyboardInterrupt):
            practice.run()
    if len(file.rows) == before:
        raise KeyboardInterrupt
    print(WRITTEN.format(path=path))


class PracticeServer(ExerciseServer[PracticeViewModel]):
    """All trainees of one server. `run` returns after another thread has called `close`."""

    _title = TITLE

    def __init__(
        self,
        server: LocalServer,
        settings: PracticeSettings,
        file: ExerciseFile,
        offscreen: Offscreen,
    ) -> None:
        """Accept trainees. The caller closes server, file and renderer afterwards."""
        super().__init__(server)
        self._settings, self._file, self._offscreen = settings, file, offscreen
        # So that a slow disk blocks nobody.
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="rows")
        self._open()

    @low_latency()
    def run(self) -> None:
        """Serve until `close`."""
        while not self._stop.is_set():
            started = time.monotonic()
            more = self.step()
            self._stop.wait(_PERIOD_S - (time.monotonic() - started))
            # Clocks, flights and window sizes change without requests.
            self._wake.wait(timeout=0 if more else 0.1)
            self._wake.clear()

    def close(self) -> None:
        """Disconnect everybody and finish writing. May be called twice."""
        self._stop.set()
        self._wake.set()
        self._writer.shutdown(wait=True)
        super().close()

    def _exercise_of(self, number: int) -> Practice:
        return Practice(self._settings, number + 1, self._write, self._file.rows)

    def _make_page(
        self,
        client: viser.ClientHandle,
        exercise: Exercise[PracticeViewModel],
        ask: Callable[[Request], None],
    ) -> PracticePage:
        return PracticePage(client, ask, exercise.view(), self._settings.reach)

    def _next_view(self, tab: Tab[PracticeViewModel]) -> PracticeViewModel | None:
        changed = tab.exercise.tick(time.monotonic()) or tab.shown is None
        for request in tab.drain():
            tab.exercise.handle(request)
            changed = True
        return tab.exercise.view() if changed else None

    def _order_pictures(
        self, tab: Tab[PracticeViewModel], view: PracticeViewModel, before: PracticeViewModel | None
    ) -> None:
        page = tab.page
        assert isinstance(page, PracticePage)
        if before is None or _seen_key(before) != _seen_key(view):
            shapes, finish = picture_shapes(view), picture_finish(view)
            self._order(tab, "seen", view, shapes, page.show_picture, finish)
        if view.help == "none" and (before is None or _target_key(before) != _target_key(view)):
            shapes = target_picture_shapes(view)
            self._order(tab, "target", view, shapes, page.show_target_picture)

    def _order(
        self,
        tab: Tab[PracticeViewModel],
        what: str,
        view: PracticeViewModel,
        shapes: Sequence[Shape],
        deliver: Callable[[Picture], None],
        finish: Callable[[Any], Any] | None = None,
    ) -> None:
        def draw() -> None:
            picture = self._offscreen.render(
                view.camera,
                shapes,
                background=picture_background(view.dark),
                size=fitting(view.camera.image_size, _PICTURE_SIZE),
                finish=finish,
            )
            deliver(picture)

        self._turns.ask(tab.client.client_id, what, draw)

    def _write(self, row: ExerciseRow) -> None:
        self._writer.submit(self._file.append, row).add_done_callback(self._written)

    def _written(self, future: Future[None]) -> None:
        error = future.exception()
        if isinstance(error, StorageError):
            print(f"venus3d: {error}", file=sys.stderr, flush=True)
            for tab in self.tabs:
                tab.page.warn(str(error))
        elif error is not None:
            traceback.print_exception(error, file=sys.stderr)


def _seen_key(view: PracticeViewModel) -> tuple[object, ...]:
    """Equal for two views whose cameras see the same."""
    done = all(view.match.within)
    return (*_target_key(view), id(view.pose), view.match.active_step, done)


def _target_key(view: PracticeViewModel) -> tuple[object, ...]:
    """The same for a camera that sees the board at the target."""
    return (id(view.target), view.help, view.dark)

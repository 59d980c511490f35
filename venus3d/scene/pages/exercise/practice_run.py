"""The practice server: every tab is a trainee with a board, a scene and panels of its own.

    viser's pool  pages are laid out for new tabs; what people do is queued
    practice      (the caller's thread) wishes and the clock -> each trainee -> page; then, in
                  turns, what their cameras see
    rows          writes practice.csv, so that a slow disk keeps nobody waiting

Scenes and pictures have one thread on purpose: two would take Python's lock from each other at each
call of OpenGL, of which a picture needs hundreds, and both would be slower.

Only the file and the server are common to all. A tab that goes takes its trainee along.
"""

from __future__ import annotations

import queue
import sys
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import viser

from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.scene.pages.exercise.pictures import Picture, PictureQueue, fitting
from venus3d.scene.pages.exercise.practice_options import PracticeOptions
from venus3d.scene.pages.exercise.shapes import (
    picture_background,
    picture_finish,
    picture_shapes,
    target_picture_shapes,
)
from venus3d.scene.pages.exercise.texts import BROKEN, STANDS_STILL, TITLE, WRITTEN
from venus3d.scene.pages.exercise.trainee import Course, Trainee
from venus3d.scene.pages.exercise.view import PracticePage
from venus3d.scene.pages.exercise.view_model import PracticeMoment, Wish
from venus3d.scene.render.offscreen import Offscreen
from venus3d.scene.render.shapes import Shape
from venus3d.scene.web.drawing import Failures, tell_tab
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.scene.web.texts import DRAWING_FAILED
from venus3d.storage.camera_yaml import read_camera_yaml
from venus3d.storage.practice import PracticeFile
from venus3d.threads.latency import low_latency

FILE = "practice.csv"
_PERIOD_S = 1 / 30
_PICTURE_ROOM = (480, 270)
_FORGIVEN_S = 60.0
"""So long after a page was drawn anew, the next failure counts as the first."""
_ROUND_S = 0.12
"""So long after the last look at what people did, pictures wait for the next round."""


@dataclass(eq=False)
class Desk:
    """One tab and its trainee."""

    client: viser.ClientHandle
    trainee: Trainee
    page: PracticePage
    wishes: queue.SimpleQueue[Wish]
    shown: PracticeMoment | None = field(default=None)
    failed_at: float = -np.inf
    """When its page was drawn anew, seconds of the clock."""


def run_practice(options: PracticeOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for whatever the user can mend."""
    camera = PAPER_CAMERA if options.camera is None else read_camera_yaml(options.camera)
    path = options.output / FILE
    course = Course.of(camera, options.board.board(), options.seed, str(path))
    with ExitStack() as rooms:
        file = rooms.enter_context(closing(PracticeFile(path)))
        offscreen = rooms.enter_context(closing(Offscreen()))
        server, note = start_server(options.host, options.port)
        rooms.callback(server.stop)
        hall = rooms.enter_context(closing(Hall(server, course, file, offscreen)))
        for line in (note, offscreen.note):
            if line:
                print(line, flush=True)
        host = "localhost" if options.host in ("0.0.0.0", "::") else options.host
        print(f"Practice: http://{host}:{server.get_port()}   (Ctrl-C ends it)", flush=True)
        with suppress(KeyboardInterrupt):
            hall.run()
    print(WRITTEN.format(path=path))


class Hall:
    """All trainees of one server. `run` returns after `close` was called by another thread."""

    def __init__(
        self, server: LocalServer, course: Course, file: PracticeFile, offscreen: Offscreen
    ) -> None:
        """Let trainees in. Server, file and renderer are closed by the caller, after the hall."""
        self._server, self._course, self._file, self._offscreen = server, course, file, offscreen
        self._desks: dict[int, Desk] = {}
        self._lock = threading.Lock()
        self._wake = threading.Event()
        self._stop = threading.Event()
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="rows")
        self._turns = PictureQueue()
        self._failures = Failures()
        camera = server.initial_camera
        camera.near, camera.far = 0.01, 50.0
        server.on_client_connect(self._enter)
        server.on_client_disconnect(self._leave)

    @property
    def desks(self) -> tuple[Desk, ...]:
        """Who is here."""
        with self._lock:
            return tuple(self._desks.values())

    @low_latency()
    def run(self) -> None:
        """Serve everybody until `close`."""
        while not self._stop.is_set():
            started = time.monotonic()
            moving = [self._serve(desk) for desk in self.desks]
            waiting = self._draw_until(started + _ROUND_S)
            self._stop.wait(_PERIOD_S - (time.monotonic() - started))
            # Clocks run, views fly and windows change by themselves.
            self._wake.wait(timeout=0 if waiting or any(moving) else 0.1)
            self._wake.clear()

    def close(self) -> None:
        """Send everybody home and write what is still to be written. May be called twice."""
        self._stop.set()
        self._wake.set()
        self._writer.shutdown(wait=True)
        with self._lock:
            self._desks.clear()

    # -- on viser's threads ----------------------------------------------------------------------

    def _enter(self, client: viser.ClientHandle) -> None:
        number = client.client_id
        if number not in self._server.get_clients():  # gone before anybody came to the door
            return
        trainee = Trainee(self._course, number + 1)
        wishes: queue.SimpleQueue[Wish] = queue.SimpleQueue()
        try:
            page = self._page(client, trainee, wishes)
        except Exception as error:
            self._failures.tell(error, STANDS_STILL)
            client.add_notification(TITLE, BROKEN, color="red")
            return
        desk = Desk(client, trainee, page, wishes)
        with self._lock:
            self._desks[number] = desk
        # It may have gone while its page was laid out; then nobody else would clear the desk.
        if number not in self._server.get_clients():
            self._leave(client)
        self._wake.set()

    def _page(
        self, client: viser.ClientHandle, trainee: Trainee, wishes: queue.SimpleQueue[Wish]
    ) -> PracticePage:
        def wish(asked: Wish) -> None:
            wishes.put(asked)
            self._wake.set()

        return PracticePage(client, wish, trainee.moment(time.monotonic()), self._course.reach)

    def _leave(self, client: viser.ClientHandle) -> None:
        with self._lock:
            self._desks.pop(client.client_id, None)
        self._turns.forget(client.client_id)

    # -- on the practice thread ------------------------------------------------------------------

    def _serve(self, desk: Desk) -> bool:
        """Obey one trainee and show what came of it; whether something on the page still moves.

        A mistake of ours here is theirs alone.
        """
        try:
            now = time.monotonic()
            changed = desk.trainee.tick(now) or desk.shown is None
            while not desk.wishes.empty():  # one reader, so a thing seen is still there
                desk.trainee.obey(desk.wishes.get(), now, self._file.rows)
                changed = True
            for row in desk.trainee.new_rows:
                self._writer.submit(self._file.append, row).add_done_callback(self._written)
            desk.trainee.new_rows.clear()
            if changed:
                self._show(desk, desk.trainee.moment(now))
            if desk.page.is_moving:
                desk.page.advance()
            return desk.page.is_moving
        except Exception as error:
            self._failed(desk, error)
            return False

    def _show(self, desk: Desk, moment: PracticeMoment) -> None:
        before, desk.shown = desk.shown, moment
        desk.page.show(moment)
        if before is None or _seen_key(before) != _seen_key(moment):
            shapes, finish = picture_shapes(moment), picture_finish(moment)
            self._ask(desk, "seen", moment, shapes, desk.page.show_picture, finish)
        if moment.help == "none" and (before is None or _target_key(before) != _target_key(moment)):
            shapes = target_picture_shapes(moment)
            self._ask(desk, "target", moment, shapes, desk.page.show_target_picture)

    def _ask(
        self,
        desk: Desk,
        what: str,
        moment: PracticeMoment,
        shapes: Sequence[Shape],
        deliver: Callable[[Picture], None],
        finish: Callable[[Any], Any] | None = None,
    ) -> None:
        def draw() -> None:
            picture = self._offscreen.render(
                moment.camera,
                shapes,
                background=picture_background(moment.dark),
                size=fitting(moment.camera.image_size, _PICTURE_ROOM),
                finish=finish,
            )
            deliver(picture)

        self._turns.ask(desk.client.client_id, what, draw)

    def _draw_until(self, end_s: float) -> bool:
        """Draw pictures, at least one, until this time; whether others still wait for theirs."""
        while (turn := self._turns.take()) is not None:
            who, draw = turn
            try:
                draw()
            except Exception as error:
                with self._lock:
                    desk = self._desks.get(who)
                if desk is not None:
                    self._failed(desk, error)
            if time.monotonic() >= end_s:
                return True
        return False

    def _failed(self, desk: Desk, error: Exception) -> None:
        """Draw one tab's page anew; one that breaks again at once stands still until reloaded."""
        client, now = desk.client, time.monotonic()
        if client.client_id not in self._server.get_clients():
            self._leave(client)  # what is drawn for a tab that was just closed may fail in any way
            return
        self._failures.tell(error, DRAWING_FAILED)
        self._turns.forget(client.client_id)
        again, desk.failed_at = now - desk.failed_at < _FORGIVEN_S, now
        try:
            if again:
                raise error
            client.gui.reset()
            client.scene.reset()
            desk.page, desk.shown = self._page(client, desk.trainee, desk.wishes), None
            tell_tab(client, error)
        except Exception as worse:
            self._failures.tell(worse, STANDS_STILL)
            self._leave(client)
            desk.page.warn(BROKEN)

    def _written(self, future: Future[None]) -> None:
        error = future.exception()
        if isinstance(error, StorageError):
            print(f"venus3d: {error}", file=sys.stderr, flush=True)
            for desk in self.desks:
                desk.page.warn(str(error))
        elif error is not None:
            traceback.print_exception(error, file=sys.stderr)


def _seen_key(moment: PracticeMoment) -> tuple[object, ...]:
    """What two moments share if their cameras see the same."""
    done = all(moment.match.within)
    return (*_target_key(moment), id(moment.pose), moment.match.active_step, done)


def _target_key(moment: PracticeMoment) -> tuple[object, ...]:
    """The same for a camera that looks at a board at the target."""
    return (id(moment.target), moment.help, moment.dark)

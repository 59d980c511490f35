"""The teaching page in the browser: owns what is shown and draws it.

One thread draws the scene and the panels, another one the pictures; for each the newest wins, so
that a hand on a slider never waits. Callbacks only change the frozen state. What a pose means is
worked out by `study`, which the app gives.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.lesson import Lesson
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.controls import after_action
from venus3d.scene.pages.teach.pictures import TeachPictures
from venus3d.scene.pages.teach.stage import stage_shapes, stage_view
from venus3d.scene.pages.teach.state import TeachState, Vector
from venus3d.scene.pages.teach.view import TeachPage
from venus3d.scene.pages.teach.view_model import TeachMoment
from venus3d.scene.render.offscreen import Offscreen
from venus3d.scene.render.shapes import Shape
from venus3d.scene.render.viewpoints import Flight
from venus3d.scene.web.drawing import DrawingThreads, tell_of_failure
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, serve_anew, start_server

Study = Callable[[Vector, str], TeachMoment]
"""Takes a pose apart: what it is given are the six numbers, and the order of turns to compare."""
Save = Callable[[TeachState, str], tuple[str, bytes]]
"""Makes a file of a kind from what is shown: its name and content. Raises `VenusError`."""

_PERIOD_S = 1 / 30
_QUIET_S = 0.25
"""So long after the last change, pictures are drawn once more, fine."""


class TeachViewer:
    """One page, shared by all tabs that are open on it."""

    def __init__(
        self,
        study: Study,
        offscreen: Offscreen,
        camera: Camera,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        lessons: tuple[Lesson, ...] = (),
        lesson: int | None = None,
        save: Save | None = None,
        kinds: tuple[str, ...] = (),
        dark: bool = True,
    ) -> None:
        """Serve the page.

        Args:
            study: called on the drawing thread; a few milliseconds at most.
            offscreen: draws the pictures; its owner closes it.
            lesson: the number of the lesson that is open at first; None: free.
            save, kinds: makes files, and of which kinds; called on threads of their own.

        Raises `AddressError` if the address cannot be bound.
        """
        server, note = start_server(host, port)
        self.host, self.port = host, server.get_port()
        self.notes: tuple[str, ...] = tuple(n for n in (note, offscreen.note) if n)
        self._study, self._save = study, save
        self._pictures = TeachPictures(offscreen)
        self._wake = threading.Condition()
        self._state = TeachState(dark=dark, lessons=lessons).opened(lesson)
        self._changed = True
        self._studied: tuple[object, TeachMoment] | None = None
        self._wanted: tuple[TeachMoment, TeachState] | None = None
        self._wanted_came = threading.Event()
        self._kinds, self._aspect = kinds, camera.width / camera.height
        self._lay_out(server)
        self._threads = DrawingThreads(
            self._draw_anew, scene=self._scene_loop, pictures=self._picture_loop
        )
        self._threads.start()

    @property
    def url(self) -> str:
        """The page's address on this machine."""
        return self._server.url

    @property
    def state(self) -> TeachState:
        """What is shown now."""
        return self._state

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names of the shapes that the scene shows now."""
        return self._scene.names

    def change(self, change: Callable[[TeachState], TeachState]) -> TeachState:
        """Show something else; from any thread."""
        with self._wake:
            self._state, self._changed = change(self._state), True
            self._wake.notify_all()
            return self._state

    def wait(self, seconds: float) -> None:
        """Wait while the page is open."""
        self._threads.stop.wait(seconds)

    def close(self) -> None:
        """Stop drawing and serving. May be called twice."""
        if self._threads.end(self._rouse):
            self._server.stop()

    # -- what people do; on viser's threads -------------------------------------------------------

    def _act(self, action: str, client: Any) -> None:
        if action.startswith("save "):
            kind = action.split()[1]
            threading.Thread(target=self._hand_out, args=(kind, client), daemon=True).start()
            return
        self.change(lambda state: after_action(state, action))

    def _hand_out(self, kind: str, client: Any) -> None:
        if self._save is None:
            self._page.say(client, texts.NOTHING_TO_SAVE)
            return
        label = texts.SAVE_LABELS[kind]
        unsay = self._page.say(client, texts.SAVING.format(kind=label), busy=True)
        try:
            name, content = self._save(self._state, kind)
        except VenusError as error:
            self._page.say(client, str(error))
            return
        except Exception:
            # Our mistake: the tab must not wait for ever, and the traceback is still told.
            self._page.say(client, texts.SAVING_FAILED)
            raise
        finally:
            unsay()
        receiver = self._server if client is None else client
        receiver.send_file_download(name, content, save_immediately=True)
        self._page.say(client, texts.SAVED.format(name=name), seconds=8.0)

    # -- drawing ----------------------------------------------------------------------------------

    def _lay_out(self, server: LocalServer) -> None:
        """Put an empty page on a server without one."""
        self._server = server
        self._drawn: TeachState | None = None
        self._looking: tuple[object, ...] | None = None
        self._scene = SceneView(server)
        self._flight = Flight(server)
        self._page = TeachPage(
            server,
            self._act,
            self._state.lessons,
            on_pose=lambda vector: self.change(lambda state: state.posed(vector)),
            on_lesson=lambda number: self.change(lambda state: state.opened(number)),
            on_way=lambda share: self.change(lambda state: state.scrubbed(share)),
            kinds=self._kinds,
            aspect=self._aspect,
        )

    def _draw_anew(self, error: Exception) -> None:
        self._lay_out(serve_anew(self._server, self._threads.stop))
        tell_of_failure(self._server, error)
        self._rouse()

    def _rouse(self) -> None:
        self._wanted_came.set()
        with self._wake:
            self._wake.notify_all()

    def _scene_loop(self) -> None:
        before = time.monotonic()
        while not self._threads.stop.is_set():
            with self._wake:
                moving = self._state.playing or self._flight.is_due
                if not self._changed:
                    self._wake.wait(timeout=_PERIOD_S if moving else 0.25)
                now = time.monotonic()
                if self._state.playing and self._studied is not None:
                    idle = self._studied[1].idle(self._state.arrangement)
                    self._state = self._state.after(now - before, idle)
                state, self._changed = self._state, False
            before = now
            if state is not self._drawn:
                self._draw(state)
                self._drawn = state
            if self._flight.is_due:
                self._flight.advance()
            self._threads.stop.wait(max(0.0, now + _PERIOD_S - time.monotonic()))

    def _moment_of(self, state: TeachState) -> TeachMoment:
        key = (state.vector, state.order)
        if self._studied is None or self._studied[0] != key:
            self._studied = (key, self._study(state.vector, state.order))
        return self._studied[1]

    def _draw(self, state: TeachState) -> None:
        moment = self._moment_of(state)
        shapes = stage_shapes(moment, state)
        with self._server.atomic():
            self._scene.draw(shapes, dark=state.dark)
            self._page.show(moment, state)
        self._server.flush()
        self._look(moment, state, shapes)
        self._wanted = (moment, state)
        self._wanted_came.set()

    def _look(self, moment: TeachMoment, state: TeachState, shapes: tuple[Shape, ...]) -> None:
        """Fly when another view is asked for, or when the target has gone far out of this one."""
        place = moment.pose.t
        far = tuple(np.ceil(np.abs(place) / (0.15, 0.12, 0.25)).tolist())
        looking = (
            state.viewpoint,
            state.arrangement,
            state.lesson,
            state.page,
            far if state.arrangement == "place" else None,
        )
        if looking == self._looking:
            return
        at_once, self._looking = self._looking is None, looking
        self._flight.go(partial(stage_view, moment, state, shapes), at_once=at_once)

    def _picture_loop(self) -> None:
        shown: tuple[TeachMoment, TeachState] | None = None
        sheet_of: tuple[TeachMoment, TeachState] | None = None
        fine = False
        while not self._threads.stop.is_set():
            came = self._wanted_came.wait(timeout=None if fine or shown is None else _QUIET_S)
            self._wanted_came.clear()
            wanted = self._wanted
            if wanted is None or self._threads.stop.is_set() or (fine and wanted is shown):
                continue
            # Quick while things move; once it is quiet the same again, fine, until they move again.
            fine = not came
            picture = self._pictures.moment(*wanted, fine=fine)
            self._page.show_moment(picture)
            self._scene.set_picture(picture)
            self._server.flush()
            shown = wanted
            if fine or sheet_of is None or _sheet_differs(sheet_of, wanted):
                sheet = self._pictures.sheet(*wanted, fine=fine, wanted=self._still(fine))
                if sheet is not None:
                    self._page.show_sheet(sheet)
                    self._server.flush()
                    sheet_of = wanted

    def _still(self, fine: bool) -> Callable[[], bool]:
        return lambda: not (fine and self._wanted_came.is_set())


def _sheet_differs(
    one: tuple[TeachMoment, TeachState], other: tuple[TeachMoment, TeachState]
) -> bool:
    return (one[0], one[1].dark, one[1].step) != (other[0], other[1].dark, other[1].step)

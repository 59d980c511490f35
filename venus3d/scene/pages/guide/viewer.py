"""The page in the browser: takes snapshots and pictures, gives back what people asked for.

Any thread may call it. Two small threads draw, each from a one-slot box in which the newest wins:
one the scene and the panels, one the live picture, which so never waits for the rest. Callbacks
only queue intents or change the view's options; what an intent means is the guidance loop's.
Another program can feed it: `Viewer().show(snapshot)`.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import intents
from venus3d.scene.pages.guide.control_panel import Action, after_action
from venus3d.scene.pages.guide.picture_feed import Came, PictureFeed
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.pages.guide.uncertainty.panel import KnowledgePanel
from venus3d.scene.pages.guide.view import Page
from venus3d.scene.render.annotated_picture import (
    PICTURE_WIDTH,
    LivePicture,
    annotate,
    small_picture,
)
from venus3d.scene.render.describe import SceneOptions, describe
from venus3d.scene.render.projections import Projections
from venus3d.scene.render.shapes import Shape
from venus3d.scene.web.drawing import DrawingThreads, tell_of_failure
from venus3d.scene.web.gizmo import BoardGizmo
from venus3d.scene.web.help import Command
from venus3d.scene.web.projections_panel import Picture, Tiles
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, serve_anew, start_server
from venus3d.scene.web.theme import Theme

_SCENE_PERIOD_S = 1 / 50
_NOTE_SECONDS = 6.0
Addition = Callable[[LocalServer], Sequence[Command]]
"""Puts something on a page; gives back the commands, for the page's help."""


class Viewer:
    """One page, shared by all tabs that are open on it.

    What goes wrong in drawing stays here: it is logged, the page is drawn anew, whoever looks is
    told, and whoever feeds the page hears nothing of it.
    """

    _picture_width = PICTURE_WIDTH

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 8080,
        *,
        dark: bool = True,
        projections: Projections | None = None,
        draggable_board: bool = False,
        autopilot: bool = False,
        tour: bool = False,
    ) -> None:
        """Serve the page.

        Args:
            host, port: where; if the port is taken, the next free one is used and `notes` says so.
            dark: the page's brightness at the start.
            projections: draws the four steps as the camera sees them; the caller closes it.
            draggable_board: put a gizmo on the board; for the simulation.
            autopilot: whether the simulation's autopilot is on at the start.
            tour: show a browser that is new here around.

        Raises `AddressError` if the address cannot be bound.
        """
        server, note = start_server(host, port)
        self.host, self.port = host, server.get_port()
        self.notes: tuple[str, ...] = (note,) if note else ()
        self._intents: queue.SimpleQueue[intents.Intent] = queue.SimpleQueue()
        self._wake = threading.Condition()
        self._state = ViewState(dark=dark, autopilot=autopilot)
        self._snapshot: Snapshot | None = None
        self._changed = True
        self._note, self._note_until, self._saved = "", 0.0, ""
        self._projections, self._tiles = projections, Tiles()
        self._additions: list[Addition] = []
        self._draggable, self._tour = draggable_board, tour
        self._lay_out(server)
        self._pictures = PictureFeed(self._draw_picture)
        self._threads = DrawingThreads(
            self._draw_anew, scene=self._scene_loop, picture=self._pictures.loop
        )
        self._threads.start()

    @property
    def url(self) -> str:
        """The page's address on this machine."""
        host = "localhost" if self.host in ("0.0.0.0", "::", "") else self.host
        return f"http://{host}:{self.port}"

    @property
    def state(self) -> ViewState:
        """What is shown now."""
        return self._state

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names of the shapes that the scene shows now."""
        return self._scene.names

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment; the newest wins."""
        self._snapshot = snapshot
        self._touch()
        if self._state.paused:
            self._pictures.again()  # no frame comes that would bring the new outline

    def show_picture(self, image: LivePicture, observation: Observation | None = None) -> None:
        """Show this live picture (BGR or grey), with the corners of `observation`, or by default
        of the newest snapshot; the newest wins."""
        self._pictures.put(image, observation)

    def keep_view(self, number: int, image: LivePicture) -> None:
        """Keep the picture (BGR or grey) of the captured view of this number, to be looked at."""
        if self.page.uncertainty is not None:
            self.page.uncertainty.keep(number, image)

    def say(self, text: str, seconds: float = _NOTE_SECONDS) -> None:
        """Show a sentence for some seconds."""
        with self._wake:
            self._note, self._note_until = text, time.monotonic() + seconds
        self._touch()

    def saved(self, text: str) -> None:
        """Show a sentence on where the result is, for as long as the calibration has ended."""
        self._saved = text
        self._touch()

    def extend(self, addition: Addition) -> None:
        """Put something more on the page, now and whenever the page is drawn anew.

        Raises `ValueError` if a command has a key that the page has.
        """
        self._additions.append(addition)
        try:
            self.page.help.explain(addition(self.server))
        except ValueError:
            self._additions.remove(addition)
            raise

    def drain_intents(self) -> list[intents.Intent]:
        """What people asked for since the last call, in order."""
        drained: list[intents.Intent] = []
        while not self._intents.empty():  # one reader, so a thing seen is still there
            drained.append(self._intents.get())
        return drained

    def close(self) -> None:
        """Stop drawing and serving. May be called twice."""
        if self._threads.end(self._end_loops):
            self.server.stop()

    # -- what a subclass may show otherwise ------------------------------------------------------

    def _make_page(self, *, dark: bool, simulated: bool, tour: bool) -> Page:
        return Page(self.server, self._act, self._ask, dark=dark, simulated=simulated, tour=tour)

    def _draw_on(self, rgb: Picture, snapshot: Snapshot, state: ViewState) -> None:
        newest = self._pictures.newest
        seen = None if newest is None else newest[1]
        annotate(rgb, snapshot, seen, state.step, Theme(True).step_colours[state.step - 1])

    # -- what people do; on viser's threads ------------------------------------------------------

    def _act(self, action: Action) -> None:
        plain: dict[str, intents.Intent] = {
            "capture": intents.Capture(),
            "skip": intents.SkipTarget(),
            "undo": intents.UndoView(),
            "finish": intents.Finish(),
        }
        if action in plain:
            self._intents.put(plain[action])
            return
        state = self._change(lambda state: after_action(state, action))
        if action == "pause":
            self._intents.put(intents.Pause(state.paused))
        elif action == "autopilot":
            self._intents.put(intents.Autopilot(state.autopilot))

    def _ask(self, intent: intents.Intent) -> None:
        if isinstance(intent, intents.ChooseAlternative):
            self._change(lambda state: state.following(True))  # from step 1 of another pose
        self._intents.put(intent)

    def _dragged(self, pose: Pose) -> None:
        if self._state.autopilot:
            self._change(lambda state: replace(state, autopilot=False))
            self._intents.put(intents.Autopilot(False))
        self._intents.put(intents.DragBoard(pose))

    def _change(self, change: Callable[[ViewState], ViewState]) -> ViewState:
        with self._wake:
            self._state, self._changed = change(self._state), True
            self._wake.notify_all()
            return self._state

    def _touch(self) -> None:
        with self._wake:
            self._changed = True
            self._wake.notify_all()

    # -- drawing ---------------------------------------------------------------------------------

    def _lay_out(self, server: LocalServer, known: KnowledgePanel | None = None) -> None:
        """Put an empty page on a server without one; what was known goes on."""
        self.server = server
        self._scene = SceneView(server)
        self._looking_at: object = (False, 1.0)
        page = self._make_page(dark=self._state.dark, simulated=self._draggable, tour=self._tour)
        if page.uncertainty is not None:
            page.uncertainty.on_change = self._touch
            if known is not None:
                page.uncertainty.go_on_from(known)
        self.page = page
        self._gizmo = BoardGizmo(server, self._dragged) if self._draggable else None
        for addition in self._additions:
            self.page.help.explain(addition(server))

    def _draw_anew(self, error: Exception) -> None:
        """A new server in the old one's place: whatever broke, nothing of it is left."""
        self._lay_out(serve_anew(self.server, self._threads.stop), self.page.uncertainty)
        tell_of_failure(self.server, error)
        self._pictures.again()
        self._touch()

    def _end_loops(self) -> None:
        self._pictures.stop()
        self._touch()

    def _scene_loop(self) -> None:
        before, moved, stop = time.monotonic(), False, self._threads.stop
        while not stop.is_set():
            with self._wake:
                if not self._changed:
                    moving = moved or self._is_moving
                    self._wake.wait(timeout=_SCENE_PERIOD_S if moving else 0.5)
                now = time.monotonic()
                state = self._state.after(now - before)
                if self._snapshot is not None:
                    state = state.seeing(self._snapshot)
                # Once more after what moved has ended, or its last moment would stay.
                moved, ended = self._is_moving, moved
                over = self._note and now > self._note_until
                due = self._changed or moved or ended or over
                self._state, self._changed, snapshot = state, False, self._snapshot
                if now > self._note_until:
                    self._note = ""
                note = self._note
            before = now
            if due:
                self._draw(snapshot, state, note)
            stop.wait(max(0.0, now + _SCENE_PERIOD_S - time.monotonic()))

    @property
    def _is_moving(self) -> bool:
        known = self.page.uncertainty
        return self._state.playing or bool(known and known.is_moving)

    def _draw(self, snapshot: Snapshot | None, state: ViewState, note: str) -> None:
        if snapshot is None or snapshot.target is None:
            self._tiles.forget()
        tiles, known = self._tiles.shown(), self.page.uncertainty
        drawn_by = "" if self._projections is None else self._projections.note
        with self.server.atomic():
            if snapshot is not None:
                self._draw_scene(snapshot, state)
                note = note or self._standing_note(snapshot)
            self.page.show(snapshot, state, tiles, note, drawn_by)
            if self._gizmo is not None and snapshot is not None:
                self._gizmo.follow(snapshot.pose, shown=not state.autopilot)
            if known is not None and snapshot is not None:
                known.show(snapshot, Theme(state.dark))
        self.server.flush()
        # Only now: the board that moved is to be seen before maps, and pictures of a new target.
        if known is not None and snapshot is not None:
            known.show_map(snapshot, Theme(state.dark))
        self._order_steps(snapshot, state)

    def _draw_scene(self, snapshot: Snapshot, state: ViewState) -> None:
        options = SceneOptions(
            step=state.step,
            strip=state.strip,
            dark=state.dark,
            sweep=state.sweep,
            show_live=not state.playing,
        )
        shapes, known = describe(snapshot, options), self.page.uncertainty
        with_known = shapes if known is None else known.put(snapshot, shapes, Theme(state.dark))
        self._scene.draw(with_known, dark=state.dark)
        self._look(shapes, state)
        if known is not None:
            known.bind(self._scene)

    def _standing_note(self, snapshot: Snapshot) -> str:
        """What is said while nothing new is."""
        if self.page.uncertainty is not None and self.page.uncertainty.caption:
            return self.page.uncertainty.caption
        if self._saved and snapshot.phase in ("converged", "finished"):
            return self._saved
        return snapshot.warnings[-1] if snapshot.warnings else ""

    def _look(self, shapes: tuple[Shape, ...], state: ViewState) -> None:
        """Turn the tabs' cameras where it is needed."""
        tab_camera = self.page.tab_camera
        self._looking_at = tab_camera.follow(shapes, state.target, self._looking_at)

    def _order_steps(self, snapshot: Snapshot | None, state: ViewState) -> None:
        """Have the target's four steps drawn as the camera sees them, if they are not yet."""
        if snapshot is None or snapshot.target is None or self._projections is None:
            return
        target, key = snapshot.target, (id(snapshot.target), state.dark)
        if key != self._tiles.key:
            pictures = self._projections.of(
                target, snapshot.camera, snapshot.board, dark=state.dark, header=False
            )
            self._tiles.expect(key, target.steps, pictures)
            pictures[-1].add_done_callback(lambda _: self._touch())

    def _draw_picture(self, came: Came) -> None:
        rgb, snapshot = small_picture(came[0], self._picture_width), self._snapshot
        self._scene.set_picture(rgb)
        if snapshot is not None:
            self._draw_on(rgb, snapshot, self._state.seeing(snapshot))
        self.page.show_picture(rgb)
        self.server.flush()

"""The page in the browser: shows snapshots and pictures, returns intents.

Any thread may call it. One thread draws scene and panels, another the live picture, which so never
waits. Callbacks only queue intents or change view options; the guidance loop carries them out.
Other programs can feed it poses (`show_pose`) or a session's snapshots (`show`).
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.prompts import Wording
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.engine.planning.target import Target
from venus3d.languages import Language
from venus3d.render.annotated_picture import (
    PICTURE_WIDTH,
    LivePicture,
    small_picture,
)
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.offscreen import Offscreen
from venus3d.render.projections import Projections
from venus3d.render.redrawing import looks_alike, still_shows
from venus3d.render.shapes import Shape
from venus3d.render.straighten import Straightener
from venus3d.render.strip import shows_strip
from venus3d.scene.pages.guide import intents
from venus3d.scene.pages.guide.film_strip import FilmStrip
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.pages.guide.subject import Subject, subject_of
from venus3d.scene.pages.guide.uncertainty.panel import UncertaintyPanel
from venus3d.scene.pages.guide.view import GuideView
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.delivery import deliver
from venus3d.scene.web.gizmo import BoardGizmo
from venus3d.scene.web.help import Command
from venus3d.scene.web.layer import Layer
from venus3d.scene.web.page import Page
from venus3d.scene.web.picture_feed import PictureFeed, SeenPicture
from venus3d.scene.web.projections_panel import RemainingTiles, Tiles
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.scene.web.steady_framing import SteadyFraming
from venus3d.scene.web.step_card import NO_NOTE, Note
from venus3d.scene.web.theme import Theme
from venus3d.scene.web.told_moment import ToldMoment
from venus3d.sources.camera_settings import CameraSetting

_NOTE_SECONDS = 6.0
_TURNS = (
    intents.PageAction.FINISH,
    intents.PageAction.END_NOW,
    intents.PageAction.GO_ON,
    intents.PageAction.NEW_SESSION,
)
"""After these the page is about something else."""
Addition = Callable[[LocalServer], Sequence[Command]]
"""Adds to a page; returns its commands, for the page's help."""


class Viewer(Page[ViewState]):
    """The page of a guided calibration, shared by all its tabs."""

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 8080,
        *,
        dark: bool = True,
        projections: Projections | None = None,
        step_pictures: bool = False,
        draggable_board: bool = False,
        autopilot: bool = False,
        tour: bool = False,
        wording: Wording = "holder",
        language: Language | None = None,
        explain: bool = False,
        recorded: bool = False,
    ) -> None:
        """Serve the page.

        Args:
            host, port: where; if the port is taken, the next free one is used and `notes` says so.
            dark: the page's initial brightness.
            projections: draws the four steps as the camera sees them; the caller closes it.
            step_pictures: draw them with a renderer of the viewer's own, which starts OpenGL.
            draggable_board: put a gizmo on the board; for the simulation.
            autopilot: whether the simulation's autopilot is on at the start.
            tour: show new browsers around.
            wording: whose left and right the page means at the start.
            language: of the page; the first browser's by default.
            explain: whether the loop of the method is shown at the start.
            recorded: offer nothing that would change the session.

        Raises `AddressError` if the address cannot be bound.
        """
        state = ViewState(
            dark=dark,
            autopilot=autopilot,
            camera_words=wording == "camera",
            explain=explain,
        )
        super().__init__(*start_server(host, port, language), state=state)
        self._intents: queue.SimpleQueue[intents.Intent] = queue.SimpleQueue()
        self._snapshot: Snapshot | None = None
        self._sent: SeenPicture | None = None
        self._moved = False
        self._note, self._note_until, self._saved = NO_NOTE, 0.0, ""
        self._offscreen = Offscreen() if step_pictures and projections is None else None
        own = None if self._offscreen is None else Projections(self._offscreen)
        self._projections = projections or own
        self._tiles = RemainingTiles(self._projections, self.wake)
        self._built = Tiles()
        self._drawn: RemainingSteps | None = None
        self._additions: list[Addition] = []
        self._draggable, self._tour, self._recorded = draggable_board, tour, recorded
        uncertainty = self._uncertainty = UncertaintyPanel(
            None if recorded else lambda number: self._ask(intents.DropView(number)), self.wake
        )
        self.layers: tuple[Layer, ...] = (uncertainty,)
        self._film = FilmStrip(uncertainty.open_view)
        self._straightener, self._told = Straightener(), ToldMoment()
        self._pictures = PictureFeed(self._draw_picture)
        self.on_sent: Callable[[float], None] = lambda came_s: None
        """Called on a drawing thread when a picture has been sent, with the time when it came."""
        self._open(picture=self._pictures.loop)

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names of the shapes in the scene."""
        return self._scene.names

    def show(self, snapshot: Snapshot) -> None:
        """Show this moment; the newest wins."""
        self._snapshot = snapshot
        self.wake()

    def show_pose(
        self,
        board: Board,
        camera: Camera,
        pose: Pose | None,
        target: Pose | Target | None = None,
    ) -> None:
        """Show a board's pose from another program; the newest wins.

        Args:
            board, camera: the board, and the camera that sees it.
            pose: `T_camera_board`; None while the board is not seen.
            target: the pose to reach; the remaining steps are shown.
        """
        self.show(pose_snapshot(board, camera, pose, target, self._snapshot))

    def show_picture(
        self,
        image: LivePicture,
        observation: Observation | None = None,
        came_s: float | None = None,
    ) -> None:
        """Show this live picture (BGR or grey), with the corners of `observation`, or by default of
        the newest snapshot; the newest wins. `came_s`: when it came, by `time.monotonic`, for
        `on_sent`."""
        self._pictures.put(image, observation, came_s)

    def keep_view(self, number: int, image: LivePicture) -> None:
        """Keep the picture (BGR or grey) of the captured view of this number, for its card and for
        the film strip."""
        self._film.keep_picture(number, image)
        for layer in self.layers:
            layer.keep_picture(number, image)

    def say(self, text: str, seconds: float = _NOTE_SECONDS) -> None:
        """Show a sentence for some seconds."""
        self._tell(Note(text), seconds)

    def warn(self, text: str, seconds: float = _NOTE_SECONDS) -> None:
        """Show for some seconds that something went wrong."""
        self._tell(Note(text, warns=True), seconds)

    def no_pictures(self, text: str, *, other_size: bool = False) -> None:
        """Say instead of an instruction that no pictures come, or that they have another size;
        empty: they come again."""
        self.change(lambda state: replace(state, no_pictures=text, other_size=other_size))

    def flows(self, text: str) -> None:
        """Show how pictures flow: rates, age, what was left out; empty: nothing."""
        self.change(lambda state: replace(state, flow=text))

    def show_camera(self, settings: tuple[CameraSetting, ...]) -> None:
        """Show the settings of a camera at this machine."""
        self.change(lambda state: replace(state, camera=settings))

    def measure_at(self, url: str) -> None:
        """Link to the page on which one measures with the camera, once the calibration is over."""
        self.change(lambda state: replace(state, measure_url=url))

    def saved(self, text: str) -> None:
        """Show where the result is, as long as the calibration has ended."""
        self._saved = text
        self.wake()

    def extend(self, addition: Addition) -> None:
        """Add to the page, now and whenever it is reloaded. Raises `ValueError` if a command's key
        is taken."""
        self._additions.append(addition)
        try:
            with self.language.spoken():
                self.view.help.explain(addition(self.server))
        except ValueError:
            self._additions.remove(addition)
            raise

    def drain_intents(self) -> list[intents.Intent]:
        """Intents since the last call, in order."""
        drained: list[intents.Intent] = []
        while not self._intents.empty():  # the only reader, so nothing is taken in between
            drained.append(self._intents.get())
        return drained

    def close(self) -> None:
        """Stop drawing and serving. May be called twice."""
        super().close()
        if self._offscreen is not None:
            self._offscreen.close()

    # -- what people do; on viser's threads ------------------------------------------------------

    def _dragged(self, pose: Pose) -> None:
        self._ask(intents.DragBoard(pose))

    def _ask(self, intent: intents.Intent) -> None:
        if intent == intents.PageAction.FINISH and self.state.asked_to_end:
            intent = intents.PageAction.END_NOW
        if intent in _TURNS and not self._note.warns:
            self._note = NO_NOTE  # of what was before
        self.change(lambda state: state.after(intent))
        self._intents.put(intent)

    # -- drawing ---------------------------------------------------------------------------------

    def _lay_out(self, server: LocalServer) -> None:
        self._rig = CameraRig(server, wake=self.nudge)
        self._scene = SceneView(server, wake=self.nudge, arrived=lambda: self._rig.arrived)
        self._framing = SteadyFraming(self._rig)
        self._spread = False
        nothing = subject_of((), 0)
        self._framing.look(nothing.content, nothing.name)
        self.view = GuideView(
            server,
            self._ask,
            self._rig,
            self.layers,
            self._film,
            dark=self._state.dark,
            simulated=self._draggable,
            tour=self._tour,
            recorded=self._recorded,
        )
        self._gizmo = BoardGizmo(server, self._dragged) if self._draggable else None
        for addition in self._additions:
            self.view.help.explain(addition(server))

    def _wake_loops(self) -> None:
        if self._stopping.is_set():
            self._pictures.stop()
        self._pictures.again()
        self.wake()

    @property
    def _is_moving(self) -> bool:
        return self._moved or self._moves_now or self._rig.is_due or self._scene.is_due

    @property
    def _moves_now(self) -> bool:
        return self._state.playing or any(layer.is_moving for layer in self.layers)

    def _draw(self, changed: bool, seconds: float) -> None:
        snapshot = self._snapshot

        def advanced(state: ViewState) -> ViewState:
            state = state.later(seconds)
            return state if snapshot is None else state.seeing(snapshot)

        state, moves = self._advance(advanced), self._moves_now
        over = bool(self._note.text) and time.monotonic() > self._note_until
        if over:
            self._note = NO_NOTE
        # Once more after a movement has ended, to show its last moment.
        if changed or over or moves or self._moved:
            self._draw_page(snapshot, state, self._note)
        self._moved = moves
        self._scene.refresh()  # before the eye moves
        if self._rig.is_due:
            self._rig.advance()

    def _draw_page(self, snapshot: Snapshot | None, state: ViewState, note: Note) -> None:
        if snapshot is None or snapshot.target is None:
            self._tiles.forget()
        self._order_built(snapshot, state)
        theme = Theme(state.dark)
        drawn_by = "" if self._projections is None else self._projections.note
        with self.server.atomic():
            if snapshot is not None:
                self._draw_scene(snapshot, state)
                note = note if note.text else self._standing_note(snapshot)
            tiles, built = self._tiles.shown(), self._built.shown()
            old = self._tiles.outdated(None if snapshot is None else snapshot.remaining)
            self.view.show(snapshot, state, tiles, old, built, note, self._saved, drawn_by)
            if snapshot is not None:
                self._tell_of(snapshot, state)
                for layer in self.layers:
                    layer.show(snapshot, theme)
                self._film.show(snapshot.captured, self._uncertainty.state.view)
        deliver(self.server)
        if snapshot is not None:
            # Only now: the moved board comes before maps and pictures of a target.
            for layer in self.layers:
                layer.show_late(snapshot, theme)
            self.view.end_map.show(snapshot, theme)
            self._tiles.order(snapshot, dark=state.dark)

    def _draw_scene(self, snapshot: Snapshot, state: ViewState) -> None:
        options = SceneOptions(
            step=state.step,
            strip=state.strip,
            dark=state.dark,
            sweep=state.sweep,
            show_live=not state.playing,
            all_steps=state.all_steps,
            surroundings=state.surroundings,
        )
        # An arrow stays while the board only trembles, and the strip while its pictures would.
        stays = still_shows if state.strip else looks_alike
        if not stays(self._drawn, snapshot.remaining):
            self._drawn = snapshot.remaining
        shapes = self._shapes(snapshot, options)
        if options.strip and not shows_strip(shapes):  # a replayed search has taken its place
            shapes = self._shapes(snapshot, replace(options, strip=False))
        if self._gizmo is not None:
            self._gizmo.follow(snapshot.pose, shown=not (state.autopilot or state.strip))
            shapes = (*shapes, *self._gizmo.shapes(dark=state.dark))
        self._scene.draw(shapes, dark=state.dark)
        now = snapshot.remaining
        self._look(subject_of(shapes, state.target, () if now is None else now.steps), state)
        for layer in self.layers:
            layer.bind(self._scene)

    def _shapes(self, snapshot: Snapshot, options: SceneOptions) -> tuple[Shape, ...]:
        shapes = describe(snapshot, options, self._drawn)
        for layer in self.layers:
            shapes = layer.put(snapshot, shapes, Theme(options.dark))
        return shapes

    def _tell(self, note: Note, seconds: float) -> None:
        self._note, self._note_until = note, time.monotonic() + seconds
        self.wake()

    def _standing_note(self, snapshot: Snapshot) -> Note:
        """The note while there is no newer one."""
        caption = next((layer.caption for layer in self.layers if layer.caption), "")
        if caption:
            return Note(caption)
        return Note(snapshot.warnings[-1], warns=True) if snapshot.warnings else NO_NOTE

    def _look(self, subject: Subject, state: ViewState) -> None:
        """Turn the tabs' cameras where needed."""
        is_held = self._gizmo is not None and self._gizmo.is_held
        plays = state.playing and subject.name == self._framing.subject
        self._framing.look(
            subject.content,
            subject.name,
            forward=subject.forward,
            still=is_held or plays or subject.is_empty,
            asked=state.strip != self._spread,
        )
        self._spread = state.strip

    def _order_built(self, snapshot: Snapshot | None, state: ViewState) -> None:
        """Have the target's steps from upright drawn, if they are asked for and not drawn."""
        target = None if snapshot is None else snapshot.target
        if snapshot is None or target is None or not state.built or self._projections is None:
            self._built.forget()
            return
        key = (target, state.dark)
        if key != self._built.key:
            camera, board = snapshot.camera, snapshot.board
            pictures = self._projections.of(
                target.steps, camera, board, dark=state.dark, header=False, letters=False
            )
            self._built.expect(key, pictures)
            pictures[-1].add_done_callback(lambda _: self.wake())

    def _tell_of(self, snapshot: Snapshot, state: ViewState) -> None:
        """Have the live picture's overlay of this moment, too: at once if it says something else,
        or if no frame would bring it."""
        is_another, newest = self._told.tell(snapshot, state.step), self._pictures.newest
        if newest is not None and (is_another or state.paused):
            self._show_picture(newest)

    def _show_picture(self, newest: SeenPicture) -> None:
        with self._told.lock:
            rgb, snapshot = small_picture(newest.image, PICTURE_WIDTH), self._told.snapshot
            self._scene.set_picture(rgb)
            self._told.annotate(rgb, newest.observation)
            known = None if snapshot is None else snapshot.calibration
            if known is not None and all(known.free):
                self._straightener.straighten(rgb, known.camera, self._state.straight_share)
            self.view.show_picture(rgb)

    def _draw_picture(self, newest: SeenPicture) -> None:
        self._show_picture(newest)
        self.server.flush()
        if newest.came_s is not None and newest is not self._sent:
            self._sent = newest
            self.on_sent(newest.came_s)

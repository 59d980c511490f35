"""The teaching page in the browser: owns the state and draws it. One thread draws scene and panels,
another the pictures; the newest state wins, so a slider never waits. Callbacks only change the
frozen state."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import partial

import numpy as np
import viser

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.lesson import Lesson
from venus3d.render.offscreen import Offscreen
from venus3d.render.shapes import Shape
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import Action, FileKind, Save, after_action
from venus3d.scene.pages.teach.camera_pictures import TeachPictures
from venus3d.scene.pages.teach.scene_shapes import scene_shapes, scene_view_of
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.pages.teach.view import TeachView
from venus3d.scene.pages.teach.view_model import AnalysePose, TaughtPose
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.page import Page
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, start_server

SaveFile = Callable[[TeachState, FileKind], tuple[str, bytes]]
"""Makes a file of a type from the state: name and content. Raises `VenusError`."""

_PERIOD_S = 1 / 30
_QUIET_S = 0.25
"""Seconds after the last change after which pictures are redrawn in fine quality."""


class TeachViewer(Page[TeachState]):
    """One page, shared by all its tabs."""

    def __init__(
        self,
        analyse: AnalysePose,
        offscreen: Offscreen,
        camera: Camera,
        *,
        host: str = "127.0.0.1",
        port: int = 8080,
        lessons: tuple[Lesson, ...] = (),
        lesson: int | None = None,
        save: SaveFile | None = None,
        kinds: tuple[FileKind, ...] = (),
        dark: bool = True,
    ) -> None:
        """Serve the page.

        Args:
            analyse: called on the drawing thread; a few milliseconds at most.
            offscreen: draws the pictures; the caller closes it.
            lesson: the number of the lesson open at first; None: free.
            save, kinds: makes files, and the available types; called on separate threads.

        Raises `AddressError` if the address cannot be bound.
        """
        server, note = start_server(host, port)
        state = TeachState(dark=dark, lessons=lessons).opened(lesson)
        super().__init__(server, note, offscreen.note, state=state, period_s=_PERIOD_S)
        self._analyse, self._save = analyse, save
        self._kinds, self._aspect = kinds, camera.width / camera.height
        self._pictures = TeachPictures(offscreen)
        self._analysed: tuple[object, TaughtPose] | None = None
        self._wanted: tuple[TaughtPose, TeachState] | None = None
        self._wanted_came = threading.Event()
        self._open(pictures=self._picture_loop)

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names of the shapes in the scene."""
        return self._scene.names

    # -- what people do; on viser's threads -------------------------------------------------------

    def _act(self, action: Action, client: viser.ClientHandle | None) -> None:
        if isinstance(action, Save):
            threading.Thread(target=self._hand_out, args=(action, client), daemon=True).start()
        else:
            self.change(lambda state: after_action(state, action))

    def _hand_out(self, action: Save, client: viser.ClientHandle | None) -> None:
        if self._save is None:
            self._view.notify(client, texts.NOTHING_TO_SAVE)
            return
        label = texts.SAVE_LABELS[action.kind]
        end_note = self._view.notify(client, texts.SAVING.format(kind=label), busy=True)
        try:
            name, content = self._save(self._state, action.kind)
        except VenusError as error:
            self._view.notify(client, str(error))
            return
        except Exception:
            # Our error: the tab must not wait for ever, and the traceback is still printed.
            self._view.notify(client, texts.SAVING_FAILED)
            raise
        finally:
            end_note()
        receiver = self.server if client is None else client
        receiver.send_file_download(name, content, save_immediately=True)
        self._view.notify(client, texts.SAVED.format(name=name), seconds=8.0)

    # -- drawing ----------------------------------------------------------------------------------

    def _lay_out(self, server: LocalServer) -> None:
        self._looking_at: tuple[object, ...] | None = None
        self._scene = SceneView(server, wake=self.nudge)
        self._rig = CameraRig(server, wake=self.nudge)
        self._view = TeachView(
            server,
            self._act,
            self._state.lessons,
            on_pose=lambda vector: self.change(lambda state: state.with_vector(vector)),
            on_lesson=lambda number: self.change(lambda state: state.opened(number)),
            on_progress=lambda share: self.change(lambda state: state.carried_to(share)),
            kinds=self._kinds,
            aspect=self._aspect,
        )

    def _wake_loops(self) -> None:
        self._wanted_came.set()
        self.wake()

    @property
    def _is_moving(self) -> bool:
        return self._state.playing or self._rig.is_due or self._scene.is_due

    def _draw(self, changed: bool, seconds: float) -> None:
        before = self._state
        if before.playing:
            idle = self._pose_of(before).idle(before.arrangement)
            self._advance(lambda state: state.after(seconds, idle))
        if changed or self._state is not before:
            self._draw_state(self._state)
        if self._rig.is_due:
            self._rig.advance()
        self._scene.refresh()

    def _pose_of(self, state: TeachState) -> TaughtPose:
        key = (state.vector, state.order)
        if self._analysed is None or self._analysed[0] != key:
            self._analysed = (key, self._analyse(state.vector, state.order))
        return self._analysed[1]

    def _draw_state(self, state: TeachState) -> None:
        taught = self._pose_of(state)
        shapes = scene_shapes(taught, state)
        with self.server.atomic():
            self._scene.draw(shapes, dark=state.dark)
            self._view.show(taught, state)
        self.server.flush()
        self._turn_cameras(taught, state, shapes)
        self._wanted = (taught, state)
        self._wanted_came.set()

    def _turn_cameras(
        self, taught: TaughtPose, state: TeachState, shapes: tuple[Shape, ...]
    ) -> None:
        """Fly when another view is chosen, or when the target has moved far out of this one."""
        far = tuple(np.ceil(np.abs(taught.pose.t) / (0.15, 0.12, 0.25)).tolist())
        looking_at = (
            state.viewpoint,
            state.arrangement,
            state.lesson,
            state.page,
            far if state.arrangement == "place" else None,
        )
        if looking_at != self._looking_at:
            at_once, self._looking_at = self._looking_at is None, looking_at
            self._rig.go(partial(scene_view_of, taught, state, shapes), at_once=at_once)

    def _picture_loop(self) -> None:
        shown: tuple[TaughtPose, TeachState] | None = None
        steps_of: tuple[TaughtPose, TeachState] | None = None
        fine = False
        while not self._stopping.is_set():
            came = self._wanted_came.wait(timeout=None if fine or shown is None else _QUIET_S)
            self._wanted_came.clear()
            wanted = self._wanted
            if wanted is None or self._stopping.is_set() or (fine and wanted is shown):
                continue
            # Quick while things move; the same again, fine, once it is quiet.
            fine = not came
            picture = self._pictures.camera_picture(*wanted, fine=fine)
            self._view.show_camera_picture(picture)
            self._scene.set_picture(picture)
            self.server.flush()
            shown = wanted
            if fine or steps_of is None or _steps_differ(steps_of, wanted):
                steps = self._pictures.steps_picture(*wanted, fine=fine, wanted=self._still(fine))
                if steps is not None:
                    self._view.show_steps_picture(steps)
                    self.server.flush()
                    steps_of = wanted

    def _still(self, fine: bool) -> Callable[[], bool]:
        return lambda: not (fine and self._wanted_came.is_set())


def _steps_differ(one: tuple[TaughtPose, TeachState], other: tuple[TaughtPose, TeachState]) -> bool:
    return (one[0], one[1].dark, one[1].step) != (other[0], other[1].dark, other[1].step)

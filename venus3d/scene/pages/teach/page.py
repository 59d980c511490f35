"""One tab of the teaching page: its panels, its scene, its pictures.

left    who leads the class; the lesson, its question, its live figures; the pose in six numbers and
whether it is acceptable
middle  the 3D scene
right   the camera's view; the current step in words; progress and its controls; viewpoints; the
menu; the four steps as the camera sees them
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable
from contextvars import copy_context
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import viser

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.decomposition import Step
from venus3d.languages import translated_error
from venus3d.lessons.lesson import Lesson
from venus3d.render.shapes import Shape
from venus3d.render.viewpoints import SceneCamera
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import Action, CarryTo, FileKind, PageAction, Save
from venus3d.scene.pages.teach.controls import LOOK_ROW, STEP_ROW, Menu, StateButtons
from venus3d.scene.pages.teach.learner import Look, TabView
from venus3d.scene.pages.teach.lesson_html import card_html, heading_html, steps_html
from venus3d.scene.pages.teach.lesson_panel import LessonPanel
from venus3d.scene.pages.teach.pictures import TeachPictures, camera_key, step_key
from venus3d.scene.pages.teach.scene_shapes import scene_shapes, scene_view_of
from venus3d.scene.pages.teach.state import TeachState
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.panels import PanelStyle, fit_width
from venus3d.scene.web.projections_panel import encoded, pictures_html
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.tabs import Ask, Job
from venus3d.scene.web.theme import Theme

SaveFile = Callable[[TeachState, FileKind], tuple[str, bytes]]
"""Makes a file of a type from the state: name and content. Raises `VenusError`."""

# (lowest height of the window, width on the left, width on the right), pixels
_WIDTHS = ((900, 520, 500), (0, 390, 424))
_JPEG_QUALITY = 82
_QUIET_S = 0.25
"""Seconds after the last change after which pictures are redrawn in fine quality."""
_MARKS = (0, 25, 50, 75, 100)


class TeachPage:
    """All panels and the scene of one tab. Callbacks come on viser's threads."""

    def __init__(
        self,
        client: viser.ClientHandle,
        ask: Ask,
        view: TabView,
        *,
        pictures: TeachPictures,
        save: SaveFile | None,
        kinds: tuple[FileKind, ...],
    ) -> None:
        """Lay everything out.

        Args:
            ask: gets the person's requests.
            pictures: draws for all tabs.
            save, kinds: makes files, and the available types; called on threads of their own.
        """
        self._client, self._gui, self._ask = client, client.gui, ask
        self._pictures, self._save = pictures, save
        self._shown = view
        self._style = PanelStyle(client.gui)
        self._looking_at: object = None
        self._drawn: object = None
        self._changed_s, self._is_fine = 0.0, False
        self._steps_drawn: dict[int, _DrawnStep] = {}
        with client.atomic():
            self._rig = CameraRig(client)
            self._scene = SceneView(client, arrived=lambda: self._rig.arrived)
            self._make_right()
            self._make_left(view.state.lessons)
            self._menu = Menu(client, self._act, kinds, self._rig.command)
        self.show(view)

    @property
    def is_moving(self) -> bool:
        """Whether the board or the tab's camera is on its way."""
        by_itself = self._shown.state.playing or self._shown.role == "follows"
        return by_itself or self._rig.is_due or self._scene.is_due

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names of the shapes in the scene."""
        return self._scene.names

    def advance(self) -> None:
        """Advance the tab's camera, and what faces it."""
        self._scene.refresh()  # before the eye moves
        if self._rig.is_due:
            self._rig.advance()

    def show(self, view: TabView) -> None:
        """Show one view on panels and scene; unchanged parts are not touched."""
        self._shown = view
        taught, state, theme = view.taught, view.state, Theme(view.state.dark)
        shapes = scene_shapes(taught, state)
        with self._client.atomic():
            self._scene.draw(shapes, dark=state.dark)
            self._style.show(theme)
            self._menu.show(state, theme)
            self.lesson.show(view, theme)
            may = view.role != "follows"
            _put(self.card, card_html(taught, state, theme, live=may))
            marked = 0 if state.at_rest else state.step
            _put(self._steps_head, heading_html(texts.STEPS_PICTURE_TITLE, marked))
            _put(self.steps, steps_html(taught, theme))
            for row in self._rows:
                row.show(state, visible=may)
            self._show_progress(state, may)
        self._client.flush()
        self._turn_camera(view, shapes)

    def pictures(self) -> Iterable[tuple[str, Job]]:
        """The pictures that are due: quick ones after a change, fine ones once it is quiet."""
        view, now_s = self._shown, time.monotonic()
        taught, state = view.taught, view.state
        key = camera_key(state)
        if key != self._drawn:
            self._drawn, self._changed_s, self._is_fine = key, now_s, False
        elif self._is_fine or now_s - self._changed_s < _QUIET_S:
            return
        else:
            self._is_fine = True
        yield "camera", partial(self._draw_camera, view, self._is_fine)
        for step in taught.steps:
            drawn = self._steps_drawn.get(step.number)
            # A fine picture is not replaced by a coarse one of the same.
            if drawn is None or not drawn.serves(step, state.dark, self._is_fine):
                yield f"step{step.number}", partial(self._draw_step, view, step, self._is_fine)

    def warn(self, text: str) -> None:
        """Report an error in a persistent note."""
        self._client.add_notification(texts.ANNOUNCED, text, color="red")

    def toggle_menu(self) -> None:
        """Open or close the menu."""
        self._menu.toggle()

    # -- what the person asks for; on viser's threads ----------------------------------------------

    def _act(self, action: Action) -> None:
        if isinstance(action, Save):
            hand_out = partial(copy_context().run, self._hand_out, action.kind)
            threading.Thread(target=hand_out, daemon=True).start()
        elif action is PageAction.MENU:
            self.toggle_menu()
        else:
            self._ask(action)

    def _hand_out(self, kind: FileKind) -> None:
        if self._save is None:
            self._notify(texts.NOTHING_TO_SAVE)
            return
        note = self._notify(texts.SAVING.format(kind=texts.SAVE_LABELS[kind]), loading=True)
        try:
            name, content = self._save(self._shown.state, kind)
        except VenusError as error:
            self._notify(translated_error(error))
            return
        except Exception:
            # Our error: the tab must not wait for ever, and the traceback is still printed.
            self._notify(texts.SAVING_FAILED)
            raise
        finally:
            note.remove()
        self._client.send_file_download(name, content, save_immediately=True)
        self._notify(texts.SAVED.format(name=name), auto_close_seconds=8.0)

    def _notify(self, text: str, **options: Any) -> Any:
        return self._client.add_notification(texts.SAVE, text, **options)

    # -- drawing -----------------------------------------------------------------------------------

    def _turn_camera(self, view: TabView, shapes: tuple[Shape, ...]) -> None:
        """Fly when another view is chosen, or when the target has moved far out of this one. A tab
        that follows looks from where the leading one does."""
        state, at_once = view.state, self._looking_at is None
        if view.look is not None:
            if view.look is not self._looking_at:
                self._looking_at = view.look
                self._rig.go(partial(_as_wide, view.look), at_once=True)
            return
        far = tuple(np.ceil(np.abs(view.taught.pose.t) / (0.15, 0.12, 0.25)).tolist())
        looking_at = (
            state.viewpoint,
            state.arrangement,
            state.lesson,
            state.page,
            far if state.arrangement == "place" else None,
        )
        if looking_at != self._looking_at:
            self._looking_at = looking_at
            self._rig.go(partial(scene_view_of, view.taught, state, shapes), at_once=at_once)

    def _draw_camera(self, view: TabView, fine: bool) -> None:
        picture = self._pictures.camera_picture(view.taught, view.state, fine=fine)
        self.picture.image = picture
        self._scene.set_picture(picture)
        self._client.flush()

    def _draw_step(self, view: TabView, step: Step, fine: bool) -> None:
        taught, dark, drawn = view.taught, view.state.dark, self._steps_drawn
        picture = self._pictures.step_picture(taught, step, dark, fine=fine)
        drawn[step.number] = _DrawnStep(step_key(step, dark), fine, encoded(picture))
        # All four at once.
        now = [drawn.get(each.number) for each in taught.steps]
        ready = [
            one.source
            for one, each in zip(now, taught.steps, strict=True)
            if one is not None and one.serves(each, dark, fine)
        ]
        if len(ready) == len(now):
            self._shots.content = pictures_html("taught", tuple(ready))
            self._client.flush()

    def _show_progress(self, state: TeachState, visible: bool) -> None:
        share = round(25 * min(state.progress, 4.0))
        if share != self._share:
            # Only on a change: the slider has its new value before `CarryTo` comes.
            self._share = share
            if not state.dragged:
                self.progress.value = share
        self.progress.disabled = not visible

    # -- layout ------------------------------------------------------------------------------------

    def _make_left(self, lessons: tuple[Lesson, ...]) -> None:
        panel = self._gui.add_panel()
        with panel.add_tab(texts.LESSON_TAB, viser.Icon.SCHOOL):
            self._style.add()
            self.lesson = LessonPanel(self._gui, self._act, self._ask, lessons)
        panel.dock_left()
        panel.expand()  # phones fold panels at first
        fit_width(self._client, panel, lambda height: _widths(height)[0])

    def _make_right(self) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        self._style.add()
        gui.add_html(heading_html(texts.PICTURE_TITLE))
        camera = self._shown.taught.camera
        blank = np.full((round(480 * camera.height / camera.width), 480, 3), 40, np.uint8)
        self.picture = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)
        self.card = gui.add_html("")
        self._rows = [StateButtons(gui, texts.STEPS, STEP_ROW, self._act, texts.STEPS_HINT)]
        marks = tuple(zip(_MARKS, texts.PROGRESS_MARKS, strict=True))
        self.progress: Any = gui.add_slider(
            texts.PROGRESS, 0, 100, 1, 100, marks=marks, hint=texts.PROGRESS_HINT
        )
        self._share = 100

        def moved(event: Any) -> None:
            if event.client is not None:
                self._ask(CarryTo(event.target.value / 100))

        self.progress.on_update(moved)
        self._rows.append(StateButtons(gui, texts.LOOK, LOOK_ROW, self._act, texts.LOOK_HINT))
        self._shots, self._steps_head, self.steps = (gui.add_html("") for _ in range(3))
        fit_width(self._client, gui.main_panel, lambda height: _widths(height)[1])


@dataclass(frozen=True)
class _DrawnStep:
    """The picture of a step as it was sent last."""

    key: tuple[object, ...]
    fine: bool
    source: str
    """Of an HTML image."""

    def serves(self, step: Step, dark: bool, fine: bool) -> bool:
        """Whether it shows this step, and as fine as wanted."""
        return self.key == step_key(step, dark) and self.fine >= fine


def _put(handle: Any, content: str) -> None:
    if handle.content != content:
        handle.content = content


def _as_wide(look: Look, aspect: float) -> SceneCamera:
    """The look in a window of another aspect, which sees at least as much."""
    camera, theirs = look
    slope = np.tan(camera.fov_rad / 2) * max(1.0, theirs / aspect)
    return SceneCamera(camera.position, camera.look_at, float(2 * np.arctan(slope)))


def _widths(height: int) -> tuple[int, int]:
    """Widths of the left and right panel in a window of this height, pixels."""
    return next((left, right) for low, left, right in _WIDTHS if height >= low)

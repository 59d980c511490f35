"""One trainee's page: everything in it belongs to one tab.

left    what to do, how far it is, time and way; level and help; the poses so far
middle  the scene, from outside or through the camera; the board is dragged in it
right   what the camera sees, what it should see (help: none), sliders, keys

One thread calls `show`; the pictures may come on another one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.exercise import Reach
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.board_drag import BoardDrag
from venus3d.scene.pages.exercise.choices import ChoicePanel
from venus3d.scene.pages.exercise.keys import practice_commands
from venus3d.scene.pages.exercise.panel import (
    bars_html,
    card_html,
    clock_html,
    keys_html,
    legend_html,
    title_html,
)
from venus3d.scene.pages.exercise.pictures import Picture
from venus3d.scene.pages.exercise.results import ResultsPanel
from venus3d.scene.pages.exercise.shapes import scene_shapes
from venus3d.scene.pages.exercise.tab_view import TabView
from venus3d.scene.pages.exercise.view_model import MoveBoard, PracticeMoment, Wish
from venus3d.scene.web.dressing import Dressing
from venus3d.scene.web.gizmo import BoardGizmo
from venus3d.scene.web.help import HelpOverlay, add_commands
from venus3d.scene.web.pose_panel import PosePanel
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.theme import Theme

_LEFT_WIDTH, _RIGHT_WIDTH = 380, 560
_SMALL_SCREEN_HEIGHT, _SMALL_LEFT_WIDTH, _SMALL_RIGHT_WIDTH = 850, 330, 340
_PHONE = 0.62
"""Width over height of the scene below which all panels are one sheet, the right one first."""
_JPEG_QUALITY = 80
_UNITS = np.array([1.0, 1.0, 1.0, 1000.0, 1000.0, 1000.0])  # metres to the sliders' millimetres
_STEPS = (0.5, 0.5, 0.5, 1.0, 1.0, 1.0)


class PracticePage:
    """All panels and the scene of one tab."""

    def __init__(
        self,
        client: viser.ClientHandle,
        wish: Callable[[Wish], None],
        moment: PracticeMoment,
        reach: Reach,
    ) -> None:
        """Lay everything out as it is at this moment.

        Args:
            client: the tab.
            wish: called on viser's threads; must not block.
            moment: what is shown first.
            reach: how far the sliders go.
        """
        self._client, self._gui, self._wish = client, client.gui, wish
        self._dressing = Dressing(client.gui)
        self._shown: PracticeMoment | None = None
        self._form: tuple[bool, bool] | None = None
        self._scene = SceneView(client)
        self._view = TabView(client)
        with client.atomic():
            self._make_right(moment, reach)
            self._make_left(moment)
            commands = practice_commands(wish)
            add_commands(client, commands)
            self._help = HelpOverlay(client, commands, dark=moment.dark)
            self._scene.draw(scene_shapes(moment), dark=moment.dark)
            self._gizmo = BoardGizmo(client, lambda pose: wish(MoveBoard(pose, "gizmo")))
            self._drag = BoardDrag(
                self._scene.node("/board/live"),
                lambda pose: wish(MoveBoard(pose, "picture")),
                moment.pose,
            )
        self.show(moment)

    @property
    def is_moving(self) -> bool:
        """Whether `advance` has something to do."""
        return self._view.is_due or self._form != self._wanted_form

    def advance(self) -> None:
        """Move on what moves by itself: the view, and the widths after the window's change."""
        self._view.advance()
        self._fit()

    def show(self, moment: PracticeMoment) -> None:
        """Put one moment on the page."""
        before, self._shown = self._shown, moment
        theme = Theme(moment.dark)
        with self._client.atomic():
            self._dressing.show(theme)
            self._scene.draw(scene_shapes(moment), dark=moment.dark)
            self._gizmo.follow(moment.pose, shown=moment.look == "outside")
            self._drag.follow(moment.pose)
            self._card.content = self._first_card.content = card_html(moment, theme)
            self._bars.content = bars_html(moment, theme)
            self._clock.content = clock_html(moment)
            if before is None or _chosen(before) != _chosen(moment):
                self._show_chosen(moment, theme)
            moved = before is None or before.pose is not moment.pose
            if moved and moment.last_mover != "sliders":
                # Whoever drags a slider is ahead of what comes back.
                self._sliders.show(_vector_of(moment.pose))
            if before is None or before.free != moment.free:
                self._sliders.enable(moment.free)
                self._gizmo.offer(moment.free)
        self._client.flush()
        if before is None or (before.look, before.target) != (moment.look, moment.target):
            self._view.go(moment, at_once=before is None)

    def _show_chosen(self, moment: PracticeMoment, theme: Theme) -> None:
        self._choices.show(moment)
        self._help.show(theme)
        self._results.show(moment, theme)
        self._legend.content = legend_html(say.PICTURE_LEGENDS[moment.help])
        alone = moment.help == "none"
        self._target_title.visible = self._target_picture.visible = alone

    def show_picture(self, rgb: Picture) -> None:
        """What the camera sees, (H, W, 3) RGB."""
        self._picture.image = rgb
        self._client.flush()

    def show_target_picture(self, rgb: Picture) -> None:
        """What the camera should see, (H, W, 3) RGB."""
        self._target_picture.image = rgb
        self._client.flush()

    def warn(self, text: str) -> None:
        """Say that something went wrong, in a note that stays."""
        self._client.add_notification(say.TITLE, text, color="red")

    @property
    def _wanted_form(self) -> tuple[bool, bool]:
        """Whether the window is low, and whether it is a phone's."""
        camera = self._client.camera
        return camera.image_height < _SMALL_SCREEN_HEIGHT, camera.aspect < _PHONE

    def _fit(self) -> None:
        if self._form == self._wanted_form:
            return
        self._form = low, phone = self._wanted_form
        left, right = _LEFT_WIDTH, _RIGHT_WIDTH
        if low:
            left, right = _SMALL_LEFT_WIDTH, _SMALL_RIGHT_WIDTH
        self._first_card.visible = phone
        self._left.set_width(left)
        self._gui.main_panel.set_width(right)

    def _make_left(self, moment: PracticeMoment) -> None:
        gui = self._gui
        self._left = gui.add_panel()
        with self._left.add_tab(say.TITLE, viser.Icon.TARGET_ARROW):
            self._dressing.add()
            self._card = gui.add_html("")
            self._bars = gui.add_html("")
            self._clock = gui.add_html("")
            self._choices = ChoicePanel(gui, self._wish, moment)
            self._results = ResultsPanel(gui, Theme(moment.dark))
        self._left.dock_left()
        self._left.expand()  # on a phone panels are folded at first

    def _make_right(self, moment: PracticeMoment, reach: Reach) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        gui.set_panel_label(say.PICTURE_TITLE)
        self._dressing.add()
        self._first_card = gui.add_html("", visible=False)
        blank = np.full((270, 480, 3), 128, np.uint8)
        self._picture = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)
        self._legend = gui.add_html("")
        self._target_title = gui.add_html(title_html(say.TARGET_PICTURE_TITLE))
        self._target_picture = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)
        with gui.add_folder(say.SLIDERS):
            self._sliders = PosePanel(
                gui,
                lambda vector: self._wish(MoveBoard(_pose_of(vector), "sliders")),
                _vector_of(moment.pose),
                ranges=[
                    (low * unit, high * unit, step)
                    for (low, high), unit, step in zip(reach, _UNITS.tolist(), _STEPS, strict=True)
                ],
            )
        gui.add_html(keys_html())


def _chosen(moment: PracticeMoment) -> tuple[object, ...]:
    """What changes with a choice or a pose that is done with, and not with every move."""
    choices = (moment.level, moment.help, moment.climb, moment.look, moment.dark)
    return (*choices, moment.stage, len(moment.scores))


def _vector_of(pose: Pose) -> list[float]:
    """Degrees and millimetres."""
    return (pose.vector() * _UNITS).tolist()


def _pose_of(vector: Array) -> Pose:
    return Pose.from_vector(vector / _UNITS)

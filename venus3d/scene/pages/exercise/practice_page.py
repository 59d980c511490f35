"""One trainee's page.

left    what to do, distance, time and path; level and help; the poses so far
middle  the scene, from outside or through the camera, in which the board can be dragged
right   what the camera sees, what it should see (help: none), sliders, keys
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.exercise import Reach
from venus3d.render.board_mesh import board_outline, board_shape
from venus3d.render.framing import content_of
from venus3d.render.offscreen import Offscreen
from venus3d.render.viewpoints import view_from
from venus3d.scene.pages.exercise import html, plots
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.board_drag import BoardDrag
from venus3d.scene.pages.exercise.page import Ask, ExercisePage, Job
from venus3d.scene.pages.exercise.practice_controls import PracticeControls, practice_commands
from venus3d.scene.pages.exercise.shapes import (
    ORANGE,
    picture_background,
    picture_finish,
    scene_shapes,
)
from venus3d.scene.pages.exercise.view_model import MoveBoard, PracticeViewModel
from venus3d.scene.web.help import Command
from venus3d.scene.web.panels import fit_width
from venus3d.scene.web.pose_panel import PosePanel
from venus3d.scene.web.theme import Theme

_LEFT_WIDTHS, _RIGHT_WIDTHS = (345, 380), (370, 560)
"""In a low window and in a higher one, CSS pixels."""
_LOW = 850
_PLOT_HEIGHT = 150
_PICTURE_SIZE = (480, 270)
_JPEG_QUALITY = 80
_UNITS = np.array([1.0, 1.0, 1.0, 1000.0, 1000.0, 1000.0])  # metres to the sliders' millimetres
_SLIDER_STEPS = (0.5, 0.5, 0.5, 1.0, 1.0, 1.0)


class PracticePage(ExercisePage[PracticeViewModel]):
    """All panels and the scene of one trainee's tab."""

    @property
    def _title(self) -> str:
        return say.PRACTICE

    def __init__(
        self,
        client: viser.ClientHandle,
        ask: Ask,
        view: PracticeViewModel,
        *,
        reach: Reach,
        offscreen: Offscreen,
    ) -> None:
        """
        Args:
            reach: range of the sliders.
            offscreen: draws the pictures; the caller closes it.
        """
        self._reach, self._offscreen = reach, offscreen
        self._ordered: dict[str, tuple[object, ...]] = {}
        super().__init__(client, ask, view)

    def pictures(self) -> Iterable[tuple[str, Job]]:
        """What the camera sees, and what it should see, if they have changed."""
        view = self._shown
        if view is None:
            return
        goal = (id(view.target), view.help, view.dark)
        seen = (*goal, id(view.pose), view.match.active_step, all(view.match.within))
        if self._ordered.get("seen") != seen:
            self._ordered["seen"] = seen
            finish = picture_finish(view)
            yield "seen", partial(self._draw, view, view.pose, self._picture, finish)
        if view.help == "none" and self._ordered.get("target") != goal:
            self._ordered["target"] = goal
            yield "target", partial(self._draw, view, view.target, self._target_picture)

    def _draw(
        self,
        view: PracticeViewModel,
        pose: Pose,
        shown_in: Any,
        finish: Callable[[Any], Any] | None = None,
    ) -> None:
        """Draw the camera's picture of the board in this pose into a picture of the page."""
        shown_in.image = self._offscreen.render(
            view.camera,
            (board_shape(view.board, pose),),
            background=picture_background(view.dark),
            size=fitting(view.camera.image_size, _PICTURE_SIZE),
            finish=finish,
        )
        self._client.flush()

    def _put(self, view: PracticeViewModel, before: PracticeViewModel | None, theme: Theme) -> None:
        self._gizmo.follow(view.pose, shown=view.side == "outside")
        shapes = (*scene_shapes(view), *self._gizmo.shapes(dark=view.dark))
        self._scene.draw(shapes, dark=view.dark)
        self._drag.follow(view.pose)
        self._card.content = html.practice_card_html(view, theme)
        self._first_card.content = f"<div class='v-on-phones'>{self._card.content}</div>"
        self._bars.content = html.bars_html(view, theme)
        self._clock.content = html.clock_html(view)
        if before is None or _chosen(before) != _chosen(view):
            self._controls.show(view)
            self._results.content = html.results_html(view)
            for plot, line in zip(self._plots, plots.practice_lines(view.rows) or (), strict=False):
                plot.show([line], [4], theme)
            alone = view.help == "none"
            legend = say.PICTURE_LEGENDS[view.help]
            self._legend.content = html.practice_legend_html(legend, two=alone)
            self._target_title.visible = self._target_picture.visible = alone
        moved = before is None or before.pose is not view.pose
        if moved and view.last_mover != "sliders":
            # While a slider is dragged, it is ahead of the values that come back.
            self._sliders.show(_vector_of(view.pose))
        if before is None or before.attempt.free != view.attempt.free:
            self._sliders.enable(view.attempt.free)
            self._gizmo.offer(view.attempt.free)

    def _look(self, view: PracticeViewModel, before: PracticeViewModel | None) -> None:
        turned = before is None or before.side != view.side
        if view.side == "outside":
            # The target counts even where no help shows it.
            goal = board_outline(view.board, view.target, "/target/board", ORANGE[view.dark])
            self._framing.look(
                content_of((*scene_shapes(view), goal), view.match.steps),
                view.target.vector().tobytes(),
                still=self._gizmo.is_held or self._drag.is_held,
                asked=turned,
            )
        elif turned:
            ahead = view.target.t[None]
            self._rig.go(
                lambda aspect: view_from("camera", view.camera, ahead, aspect),
                at_once=before is None,
            )

    def _commands(self) -> tuple[Command, ...]:
        return practice_commands(self._ask)

    def _lay_out(self, view: PracticeViewModel) -> None:
        self._make_right(view)
        self._make_left(view)
        self._scene.draw(scene_shapes(view), dark=view.dark)
        self._gizmo = self._make_gizmo()
        self._drag = BoardDrag(
            self._scene.node("/board/live"),
            lambda pose, grabbed: self._ask(MoveBoard(pose, "picture", grabbed)),
            view.pose,
        )
        fit_width(self._client, self._left, partial(_in_window, _LEFT_WIDTHS))
        fit_width(self._client, self._gui.main_panel, partial(_in_window, _RIGHT_WIDTHS))

    def _make_left(self, view: PracticeViewModel) -> None:
        gui = self._gui
        self._left = gui.add_panel()
        with self._left.add_tab(say.PRACTICE, viser.Icon.TARGET_ARROW):
            self._style.add()
            self._card, self._bars, self._clock = (gui.add_html("") for _ in range(3))
            self._controls = PracticeControls(gui, self._ask, view)
            self._results = gui.add_html("")
            self._plots = [
                plots.PosePlot(gui, label, _PLOT_HEIGHT, [label])
                for label in (say.TIME_PLOT, say.WAY_PLOT)
            ]
        self._left.dock_left()
        self._left.expand()  # phones fold panels at first

    def _make_right(self, view: PracticeViewModel) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        gui.set_panel_label(say.PICTURE_TITLE)
        self._style.add()
        self._first_card = gui.add_html("")  # a phone's sheet begins with this panel
        self._picture = self._make_picture(_PICTURE_SIZE[0], _JPEG_QUALITY)
        self._legend = gui.add_html("")
        self._target_title = gui.add_html(html.title_html(say.TARGET_PICTURE_TITLE))
        self._target_picture = self._make_picture(_PICTURE_SIZE[0], _JPEG_QUALITY)
        with gui.add_folder(say.SLIDERS):
            self._sliders = PosePanel(
                gui,
                lambda vector: self._ask_to_move(_pose_of(vector), "sliders"),
                _vector_of(view.pose),
                ranges=[
                    (low * unit, high * unit, step)
                    for (low, high), unit, step in zip(
                        self._reach, _UNITS.tolist(), _SLIDER_STEPS, strict=True
                    )
                ],
            )
        gui.add_html(html.keys_html())


def _chosen(view: PracticeViewModel) -> tuple[object, ...]:
    """What changes with a choice or a finished pose, but not with every move."""
    choices = (view.level, view.help, view.auto_level, view.side, view.dark)
    return (*choices, view.stage, len(view.rows))


def _in_window(widths: tuple[int, int], height: int) -> int:
    return widths[height >= _LOW]


def _vector_of(pose: Pose) -> list[float]:
    """Degrees and millimetres."""
    return (pose.vector() * _UNITS).tolist()


def _pose_of(vector: Array) -> Pose:
    return Pose.from_vector(vector / _UNITS)


def fitting(size: tuple[int, int], room: tuple[int, int]) -> tuple[int, int]:
    """The largest (width, height) of this aspect within `room`; at least one pixel each."""
    scale = min(room[0] / size[0], room[1] / size[1])
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))

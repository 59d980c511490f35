"""The page of a trial: the same volunteer, the same poses, and only one help at a time.

left    participant, help, pose, time; Start and Give up
right   for the axes and the outline: the live picture, large, with the help drawn into it
        for the steps: live picture and the four steps, with scene and text in the middle, exactly
        as in a calibration, since the real page is timed
        at the end: the times

The scene stays beside the large picture only if a simulated board is dragged in it; it then shows
that board and no target.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import viser

from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.render.describe import SceneOptions, describe
from venus3d.render.framing import content_of
from venus3d.render.redrawing import looks_alike
from venus3d.render.shapes import Shape
from venus3d.scene.pages.exercise import html, plots
from venus3d.scene.pages.exercise import texts as say
from venus3d.scene.pages.exercise.page import Ask, ExercisePage, Job, press_commands
from venus3d.scene.pages.exercise.trial_pictures import (
    LARGE_PICTURE_WIDTH,
    Layout,
    TrialPictures,
    layout_of,
)
from venus3d.scene.pages.exercise.trial_plan import times_of
from venus3d.scene.pages.exercise.view_model import (
    TRIAL_HELPS,
    Action,
    Press,
    TrialViewModel,
)
from venus3d.scene.web.help import Command
from venus3d.scene.web.keys import KEYS
from venus3d.scene.web.panels import fit_width
from venus3d.scene.web.projections_panel import ProjectionsPanel
from venus3d.scene.web.step_card import picture_legend_html
from venus3d.scene.web.theme import Theme
from venus3d.scene.web.window import window_height

_KEYS: dict[Action, str] = {
    "next": KEYS["go_on"],
    "give_up": KEYS["other_pose"],
    "theme": KEYS["theme"],
    "autopilot": KEYS["autopilot"],
}
_PICTURE_PERIOD_S = 1 / 15
_JPEG_QUALITY = 75
_SIDE_WIDTH, _LEFT_WIDTH, _RIGHT_WIDTH = 340, 480, 510
_SMALL_WINDOW_HEIGHT, _SMALL_LEFT_WIDTH, _SMALL_RIGHT_WIDTH = 850, 400, 350
# Height in the window of a card, a legend and their frame, pixels.
_AROUND_THE_PICTURE = 230
_SHARE_BESIDE_THE_SCENE = 0.68
_PLOT_HEIGHT = 330
_AHEAD = np.array([0.0, 1.18, 1.65])
"""Direction of the view beside the picture: from behind, so that left and right match it."""


class TrialPage(ExercisePage[TrialViewModel]):
    """All panels of a trial in one tab."""

    _layout: Layout

    @property
    def _title(self) -> str:
        return say.TRIAL

    def __init__(
        self,
        client: viser.ClientHandle,
        ask: Ask,
        view: TrialViewModel,
        *,
        pictures: TrialPictures,
        simulated: bool,
    ) -> None:
        """`simulated`: the board can be dragged in the scene."""
        self._pictures, self._simulated = pictures, simulated
        self._picture_due_s = 0.0
        self._drawn: RemainingSteps | None = None
        super().__init__(client, ask, view)

    def pictures(self) -> Iterable[tuple[str, Job]]:
        """The live picture, 15 times a second."""
        now = time.monotonic()
        if self._pictures.image is not None and now >= self._picture_due_s:
            self._picture_due_s = now + _PICTURE_PERIOD_S
            yield "live", self._draw_picture

    def _draw_picture(self) -> None:
        view = self._shown
        pictures = None if view is None else self._pictures.live(view)
        if pictures is not None:
            rgb, self._picture.image = pictures
            self._scene.set_picture(rgb)
            self._client.flush()

    def _put(self, view: TrialViewModel, before: TrialViewModel | None, theme: Theme) -> None:
        if layout_of(view) != self._layout:
            self._arrange(layout_of(view))
        tiles = self._pictures.steps(view)
        steps, result = self._layout == "steps", self._layout == "result"
        if not looks_alike(self._drawn, view.snapshot.remaining):
            self._drawn = view.snapshot.remaining
        shapes = _shapes(view, self._layout, self._drawn)
        if self._gizmo is not None:
            self._gizmo.follow(view.pose, shown=not view.autopilot)
            shapes = (*shapes, *self._gizmo.shapes(dark=view.dark))
        self._scene.draw(shapes, dark=view.dark)
        self._side.content = html.side_html(view)
        self._start.visible = view.stage == "ready" and view.snapshot.number > 0
        self._give_up.visible = view.is_running
        self._card.content = html.trial_card_html(view, theme)
        self._legend.content = html.trial_legend_html(view)
        self._card.visible = self._legend.visible = not steps
        self._picture.visible = not result
        self._steps_legend.visible = self._projections.visible = steps
        if steps:
            self._guidance.content = html.steps_html(view, theme)
            remaining = view.snapshot.remaining
            self._projections.show(remaining, tiles, view.step, theme, self._pictures.note)
        if result:
            times = times_of(view.rows)
            self._result.content = html.times_html(view, times, theme)
            self._plot.show(plots.trial_lines(times), [*plots.HELP_COLOURS.values()], theme)

    def _arrange(self, layout: Layout) -> None:
        self._layout = layout
        # The scene is useless without steps or a simulated board to drag.
        dragged = self._simulated and layout == "picture"
        self._client.scene.set_global_visibility(layout == "steps" or dragged)
        self._guidance_panel.visible = layout == "steps"
        if layout == "steps":  # a hidden panel loses its place
            self._guidance_panel.dock_above(self._left)
        self._left.set_width(self._left_width(self._height))
        self._gui.main_panel.set_width(self._right_width(self._height))

    def _look(self, view: TrialViewModel, before: TrialViewModel | None) -> None:
        if self._layout == "result":
            return
        now = view.snapshot.remaining
        steps = () if now is None else now.steps
        content = content_of(_shapes(view, self._layout, self._drawn), steps)
        goal = view.target.vector().tobytes() if view.target is not None else b""
        is_held = self._gizmo is not None and self._gizmo.is_held
        self._framing.look(
            content,
            (self._layout, goal),
            forward=_AHEAD if self._layout == "picture" else None,
            still=is_held or (before is not None and not len(content.boards)),
        )

    def _left_width(self, height: int) -> int:
        """Width of the left panel in a window of this height, pixels."""
        if self._layout != "steps":
            return _SIDE_WIDTH
        return _SMALL_LEFT_WIDTH if height < _SMALL_WINDOW_HEIGHT else _LEFT_WIDTH

    def _right_width(self, height: int) -> int:
        """Width of the right panel in a window of this height, pixels."""
        self._height = height  # as it is when the layout changes
        if self._layout == "steps":
            return _SMALL_RIGHT_WIDTH if height < _SMALL_WINDOW_HEIGHT else _RIGHT_WIDTH
        # As wide as a 16:9 picture that fits the window's height.
        whole = max(480.0, (height - _AROUND_THE_PICTURE) * 16 / 9)
        beside = self._simulated and self._layout == "picture"
        return round(whole * (_SHARE_BESIDE_THE_SCENE if beside else 1.0))

    def _commands(self) -> tuple[Command, ...]:
        keys: dict[Action, str] = {
            a: k for a, k in _KEYS.items() if self._simulated or a != "autopilot"
        }
        return press_commands(keys, say.TRIAL_COMMANDS, self._ask)

    def _lay_out(self, view: TrialViewModel) -> None:
        self._make_right()
        self._make_left()
        self._gizmo = self._make_gizmo() if self._simulated else None
        self._height = window_height(self._client)
        self._arrange(layout_of(view))
        fit_width(self._client, self._left, self._left_width)
        fit_width(self._client, self._gui.main_panel, self._right_width)

    def _make_left(self) -> None:
        gui = self._gui
        self._guidance_panel = gui.add_panel()
        with self._guidance_panel.add_tab(say.GUIDANCE_TAB, viser.Icon.HAND_MOVE):
            self._style.add()
            self._guidance = gui.add_html("")
        self._guidance_panel.dock_left()
        self._guidance_panel.expand()  # phones fold panels at first
        self._left = gui.add_panel()
        with self._left.add_tab(say.TRIAL, viser.Icon.CLOCK):
            self._style.add()
            self._side = gui.add_html("")
            self._start = gui.add_button(
                say.START, icon=viser.Icon.PLAYER_PLAY, visible=False, hint=say.START_HINT
            )
            self._start.on_click(lambda _: self._ask(Press("next")))
            self._give_up = gui.add_button(
                say.GIVE_UP,
                icon=viser.Icon.PLAYER_SKIP_FORWARD,
                visible=False,
                hint=say.GIVE_UP_HINT,
            )
            self._give_up.on_click(lambda _: self._ask(Press("give_up")))
        self._left.dock_left()

    def _make_right(self) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        self._style.add()
        self._card = gui.add_html("")
        self._picture = self._make_picture(LARGE_PICTURE_WIDTH, _JPEG_QUALITY)
        self._legend = gui.add_html("")
        self._steps_legend = gui.add_html(picture_legend_html(), visible=False)
        self._projections = ProjectionsPanel(gui)
        self._projections.visible = False
        self._result = gui.add_html("")
        names = [say.TRIAL_HELP_NAMES[help_] for help_ in TRIAL_HELPS]
        self._plot = plots.PosePlot(gui, say.SECONDS_SINCE, _PLOT_HEIGHT, names)


def _shapes(
    view: TrialViewModel, layout: Layout, drawn: RemainingSteps | None
) -> tuple[Shape, ...]:
    if layout == "steps":
        return describe(view.snapshot, SceneOptions(step=view.step, dark=view.dark), drawn)
    bare = replace(view.snapshot, target=None, match=None, remaining=None)
    return describe(bare, SceneOptions(dark=view.dark))

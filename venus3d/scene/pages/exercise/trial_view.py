"""The page of a trial: the same volunteer, the same poses, one help at a time and nothing else.

left    participant, help, pose, time; Start and Give up
right   for the axes and the outline: the live picture, large, with the help drawn into it
        for the steps: live picture and the four steps, with scene and text in the middle, just as
        in a calibration: what is timed is the real page
        at the end: the times

The scene stays visible beside the large picture only where the simulated board is dragged in it;
it shows the board there, and no target.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
import viser

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.exercise import trial_texts as say
from venus3d.scene.pages.exercise.trial_panel import (
    card_html,
    legend_html,
    progress_lines,
    progress_series,
    result_html,
    side_html,
)
from venus3d.scene.pages.exercise.trial_view_model import HELPS, Help, TrialMoment, TrialSnapshot
from venus3d.scene.pages.guide.guidance_panel import guidance_html
from venus3d.scene.pages.guide.intents import Begin, Intent, SkipTarget, Toggle
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.pages.guide.view import JPEG_QUALITY, LEFT_WIDTH, GuideView
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.render.annotated_picture import PICTURE_WIDTH
from venus3d.scene.render.overlay import draw_axes, draw_outline
from venus3d.scene.render.shapes import Shape
from venus3d.scene.render.viewpoints import view_kept_wide
from venus3d.scene.web.help import Command, HelpOverlay, add_commands
from venus3d.scene.web.layer import Layer
from venus3d.scene.web.projections_panel import Picture, ProjectionsPanel, ShownSteps
from venus3d.scene.web.step_card import PICTURE_LEGEND_HTML
from venus3d.scene.web.theme import Theme

Layout = Literal["steps", "picture", "result"]
_LARGE_PICTURE_WIDTH = 1280
_SIDE_WIDTH = 340
# What a card, a legend and the frame around them take of the window's height, pixels.
_AROUND_THE_PICTURE = 230
_SHARE_BESIDE_THE_SCENE = 0.68
# The scene beside the picture is narrow: seen from behind the camera, left and right are as in it.
_NARROW = 0.45  # width over height
_BEHIND, _BEHIND_AT = np.array([0.0, -1.1, -1.1]), np.array([0.0, 0.08, 0.55])


class TrialViewer(Viewer):
    """A viewer that shows `TrialSnapshot`s."""

    def _make_view(self, *, dark: bool, simulated: bool, tour: bool) -> GuideView:
        # Nobody is shown around in front of a clock.
        return TrialPage(self.server, self._ask, dark=dark, simulated=simulated, tour=False)

    def _make_layers(self) -> tuple[Layer, ...]:
        return ()

    def _draw_page(self, snapshot: Snapshot | None, state: ViewState, note: str) -> None:
        if snapshot is not None and layout_of(snapshot) != "steps":
            self._picture_width = _LARGE_PICTURE_WIDTH
            snapshot = replace(snapshot, target=None, match=None)
        else:
            self._picture_width = PICTURE_WIDTH
        super()._draw_page(snapshot, state, note)

    def _look(self, shapes: tuple[Shape, ...], state: ViewState) -> None:
        if any(shape.name.startswith("/target/") for shape in shapes):
            super()._look(shapes, state)
        elif self._looking_at != "beside":
            self._looking_at = "beside"
            self._rig.go(partial(view_kept_wide, _BEHIND, _BEHIND_AT, _NARROW), at_once=True)

    def _draw_on(self, rgb: Picture, snapshot: Snapshot, state: ViewState) -> None:
        moment, target = trial_of(snapshot), snapshot.target
        if moment is None or target is None:
            return
        if moment.help == "steps":
            super()._draw_on(rgb, snapshot, state)
            return
        draw = draw_axes if moment.help == "axes" else draw_outline
        draw(rgb, snapshot.camera, snapshot.board, snapshot.pose, target.pose)


class TrialPage(GuideView):
    """All panels of a trial."""

    def show(
        self,
        snapshot: Snapshot | None,
        state: ViewState,
        tiles: ShownSteps | None,
        note: str,
        drawn_by: str,
    ) -> None:
        """Put one moment on the page."""
        theme = Theme(state.dark)
        self._set_theme(theme)
        moment = trial_of(snapshot)
        self._lay_out("picture" if snapshot is None else layout_of(snapshot))
        steps, result = self._layout == "steps", self._layout == "result"
        self._side.content = side_html(moment, note)
        self._start.visible = moment is not None and moment.stage == "ready"
        self._give_up.visible = moment is not None and moment.stage == "running"
        seen = snapshot is not None and snapshot.pose is not None
        self._card.content = card_html(moment, theme, seen=seen)
        self._card.visible = self._legend.visible = not steps
        self._legend.content = legend_html(moment)
        self.picture.visible = not result
        self.guidance_panel.visible = self._steps_legend.visible = steps
        self.projections.visible = steps
        if steps:
            text = guidance_html(snapshot, state, theme, note)
            self.guidance.content = f"<div class='v-wide'>{text}</div>"
            self.projections.show(tiles, state.step, theme, drawn_by)
        if moment is not None and result:
            self._show_result(moment, theme)

    def _show_result(self, moment: TrialMoment, theme: Theme) -> None:
        self._result.content = result_html(moment, theme)
        lines = progress_lines(moment.times)
        if lines is not None and not self._plot.visible:
            self._shown = [times.help for times in moment.times]
            self._plot.series = progress_series(theme, self._shown)
            self._plot.data = lines
            self._plot.visible = True

    def _recolour(self, theme: Theme) -> None:
        self._plot.series = progress_series(theme, self._shown)
        across, up = self._plot.axes or ({}, {})
        self._plot.axes = ({**across, "stroke": theme.quiet}, {**up, "stroke": theme.quiet})
        self.help.show(theme)

    def _lay_out(self, layout: Layout) -> None:
        if layout == self._layout:
            return
        self._layout = layout
        self._show_scene()
        self.guidance_panel.visible = layout == "steps"
        if layout == "steps":  # a hidden panel has no place, so it is given one each time
            self.guidance_panel.dock_above(self.left_panel)
        self.left_panel.set_width(LEFT_WIDTH if layout == "steps" else _SIDE_WIDTH)
        for client in self._server.get_clients().values():
            client.gui.main_panel.set_width(self._right_width(client.camera.image_height))

    def _show_scene(self) -> None:
        # It is of no use where neither steps are shown nor a simulated board is dragged.
        dragged = self._simulated and self._layout == "picture"
        self._server.scene.set_global_visibility(self._layout == "steps" or dragged)

    def _right_width(self, height: int) -> int:
        if self._layout == "steps":
            return super()._right_width(height)
        # As wide as a picture of 16:9 that fits the window's height.
        whole = max(480.0, (height - _AROUND_THE_PICTURE) * 16 / 9)
        beside = self._simulated and self._layout == "picture"
        return round(whole * (_SHARE_BESIDE_THE_SCENE if beside else 1.0))

    def _make_right(self) -> None:
        gui = self._gui
        self._layout: Layout = "picture"
        self._shown: Sequence[Help] = HELPS  # the lines of the plot
        self._show_scene()
        gui.main_panel.dock_right()
        self._dressing.add()
        self._card = gui.add_html("")
        blank = np.full((_LARGE_PICTURE_WIDTH * 9 // 16, _LARGE_PICTURE_WIDTH, 3), 40, np.uint8)
        self.picture = gui.add_image(blank, format="jpeg", jpeg_quality=JPEG_QUALITY)
        self._legend = gui.add_html("")
        self._steps_legend = gui.add_html(PICTURE_LEGEND_HTML, visible=False)
        self.projections = ProjectionsPanel(gui)
        self.projections.visible = False
        self._result = gui.add_html("")
        start = np.array([0.0, 1.0])
        self._plot = gui.add_uplot(
            (start, *(start for _ in range(3))),
            progress_series(Theme(True)),
            scales={"x": {"time": False}},
            axes=(
                {"label": say.POSE, "labelSize": 18, "size": 30, "incrs": (1.0, 2.0, 5.0)},
                {"label": say.SECONDS_SINCE, "labelSize": 18, "size": 50},
            ),
            legend={"show": False},
            height=330,
            padding=(12, 16, 0, 0),
            visible=False,
        )

    def _make_left(self, theme: Theme) -> None:
        gui = self._gui
        panel = self.left_panel = gui.add_panel()
        with panel.add_tab(say.TAB, viser.Icon.CLOCK):
            self._dressing.add()
            self._side = gui.add_html("")
            self._start = gui.add_button(
                say.START, icon=viser.Icon.PLAYER_PLAY, visible=False, hint=say.START_HINT
            )
            self._start.on_click(lambda _: self._ask(Begin()))
            self._give_up = gui.add_button(
                say.GIVE_UP,
                icon=viser.Icon.PLAYER_SKIP_FORWARD,
                visible=False,
                hint=say.GIVE_UP_HINT,
            )
            self._give_up.on_click(lambda _: self._ask(SkipTarget()))
        panel.dock_left()
        panel.set_width(_SIDE_WIDTH)

    def _make_commands(self, tour: bool) -> None:
        asks: list[tuple[tuple[str, str], str, Intent]] = [
            (say.START_COMMAND, "space", Begin()),
            (say.GIVE_UP_COMMAND, "K", SkipTarget()),
            (say.THEME_COMMAND, "B", Toggle("dark")),
        ]
        if self._simulated:
            asks.append((say.AUTOPILOT_COMMAND, "O", Toggle("autopilot")))
        commands = [
            Command(texts[0], key, texts[1], lambda intent=intent: self._ask(intent))
            for texts, key, intent in asks
        ]
        add_commands(self._server, commands)
        self.help = HelpOverlay(self._server, commands)


def trial_of(snapshot: Snapshot | None) -> TrialMoment | None:
    """The trial around a snapshot, if there is one."""
    return snapshot.trial if isinstance(snapshot, TrialSnapshot) else None


def layout_of(snapshot: Snapshot) -> Layout:
    """How the page is laid out for this moment."""
    moment = trial_of(snapshot)
    if moment is not None and moment.stage == "over":
        return "result"
    steps = moment is not None and moment.stage == "running" and moment.help == "steps"
    return "steps" if steps else "picture"

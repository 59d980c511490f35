"""The page's layout, and how one moment is shown on it.

left    what to do now, in large letters; below it the progress (views, purpose of the next pose,
its alternatives) and, in its own tab, the camera's parameters
middle  the 3D scene
above   the loop of the method, when asked for
below   under the scene, the captured views
right   live picture, the four steps as the camera sees them, controls, how this pose is built and
        how poses are found
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.guidance.loop import Loop
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import PICTURE_WIDTH
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.alternatives_panel import AlternativesPanel
from venus3d.scene.pages.guide.built_panel import BuiltPanel
from venus3d.scene.pages.guide.camera_panel import CameraPanel
from venus3d.scene.pages.guide.control_panel import ControlPanel
from venus3d.scene.pages.guide.diagnosis_panel import diagnoses_html
from venus3d.scene.pages.guide.end_panel import OVER, EndButtons, EndMap, result_html
from venus3d.scene.pages.guide.film_strip import FilmStrip
from venus3d.scene.pages.guide.guidance_panel import guidance_html
from venus3d.scene.pages.guide.intents import Intent
from venus3d.scene.pages.guide.loop_line import loop_html
from venus3d.scene.pages.guide.method_panel import MethodPanel
from venus3d.scene.pages.guide.parameters_panel import ParametersPanel
from venus3d.scene.pages.guide.progress_panel import progress_html
from venus3d.scene.pages.guide.state import ViewState
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.camera_rig import CameraRig
from venus3d.scene.web.help import HelpOverlay, add_commands
from venus3d.scene.web.layer import Layer
from venus3d.scene.web.panels import PanelStyle, fit_width
from venus3d.scene.web.projections_panel import Flags, ProjectionsPanel, Sources
from venus3d.scene.web.step_card import (
    Note,
    halves_legend_html,
    picture_legend_html,
    picture_line_html,
)
from venus3d.scene.web.theme import Theme
from venus3d.scene.web.tour import Tour, TourStep

_LEFT_WIDTHS, _RIGHT_WIDTHS = (400, 480), (350, 480)
"""Least and greatest."""
_SMALL_WINDOW = 850
_LETTERS_AND_BUTTONS, _PICTURES = 566, 1.125
"""Height of all that stands in the right panel: this many pixels, and the pictures' share of the
panel's width."""
JPEG_QUALITY = 75
_MARKS = ("", "guidance", "pictures", "scene", "guidance")
"""What each step of the tour highlights."""
TOUR_KEY = "tour-guide"


class GuideView:
    """All panels of one server. `ask` is called on viser's threads."""

    def __init__(
        self,
        server: viser.ViserServer,
        ask: Callable[[Intent], None],
        rig: CameraRig,
        layers: Sequence[Layer],
        film: FilmStrip,
        *,
        dark: bool,
        simulated: bool,
        tour: bool,
        recorded: bool = False,
    ) -> None:
        """Lay everything out, each layer in its own tab.

        Args:
            rig: turns the scene's cameras.
            film: the strip of captured views.
            simulated: whether there is a simulated hand.
            tour: show new browsers around.
            recorded: the session is one of a record, which nothing changes.
        """
        self._recorded = recorded
        self._server, self._gui = server, server.gui
        self._style = PanelStyle(server.gui)
        self._ask, self._rig = ask, rig
        self._layers, self._film, self._simulated = layers, film, simulated
        self._views = self._captures = 0
        theme = Theme(dark)
        self._make_guidance()
        self._make_left(theme)
        self._make_right()
        self._make_commands(tour)
        self._set_theme(theme)
        fit_width(server, self._gui.main_panel, self._right_width)
        fit_width(server, self.guidance_panel, lambda height: _LEFT_WIDTHS[height > _SMALL_WINDOW])

    def show_picture(self, rgb: NDArray[np.uint8]) -> None:
        """Show the live picture (H, W, 3) RGB."""
        self.picture.image = rgb

    def show(
        self,
        snapshot: Snapshot | None,
        state: ViewState,
        tiles: Sources | None,
        outdated: Flags,
        built: Sources | None,
        note: Note,
        saved: str,
        drawn_by: str,
    ) -> None:
        """Show one moment.

        Args:
            tiles: pictures of the steps from here; None without a target.
            outdated: of each of them, whether it shows something else than is to be done.
            built: pictures of the steps from upright; None unless asked for.
            saved: says where the result is.
            drawn_by: the renderer's note, if any.
        """
        theme = Theme(state.dark)
        self._set_theme(theme)
        text = guidance_html(snapshot, state, theme, note)
        self.guidance.content = f"<div class='v-wide'>{text}</div>{self._flash(snapshot)}"
        self.diagnoses.content = diagnoses_html(snapshot)
        self.diagnoses.visible = bool(self.diagnoses.content)
        self.progress.content = progress_html(snapshot)
        self.alternatives.show(None if self._recorded else snapshot)
        remaining, target = (
            (None, None) if snapshot is None else (snapshot.remaining, snapshot.target)
        )
        self.projections.show(
            remaining, tiles, state.step, theme, drawn_by, state.wording, outdated
        )
        self.built.show(target, built, theme, state.wording)
        phase = "startup" if snapshot is None else snapshot.phase
        # After the end no target follows, so none is announced or drawn.
        ended = phase in OVER
        self.projections.visible = tiles is not None or not ended
        known = None if snapshot is None else snapshot.calibration
        is_known = known is not None and all(known.free)
        halves = ended and is_known and 0 < state.straight_share < 1
        self._legend.visible = halves or not ended
        self._legend.content = halves_legend_html() if halves else picture_legend_html()
        self.flow.visible = bool(state.flow)
        if state.flow:
            self.flow.content = picture_line_html(state.flow)
        self.loop.visible = state.explain
        if state.explain:
            self.loop.content = loop_html(Loop() if snapshot is None else snapshot.loop)
        if not self._recorded:
            self.end_buttons.show(state, phase)
            self.camera.show(state.camera)
        self.controls.show(state, phase, known=is_known)
        if snapshot is not None:
            self.result.content = result_html(snapshot, saved, state.measure_url)
            self.progress.visible = not self.result.content
            if not self._recorded:
                self.method.show(snapshot)
            self.parameters.show(snapshot)

    def _flash(self, snapshot: Snapshot | None) -> str:
        """A mark that changes with each capture: the style sheet flashes the scene, once."""
        views = 0 if snapshot is None else snapshot.captured_count
        if views > self._views:
            self._captures += 1
        self._views = views
        turn = self._captures % 2
        return f"<i class='v-captured' data-turn='{turn}'></i>" if self._captures else ""

    def _right_width(self, height: int) -> int:
        """Width of the right panel in a window of this height, pixels."""
        least, greatest = _RIGHT_WIDTHS
        return round(min(max((height - _LETTERS_AND_BUTTONS) / _PICTURES, least), greatest))

    def _make_guidance(self) -> None:
        panel = self.guidance_panel = self._gui.add_panel()
        with panel.add_tab(say.GUIDANCE_TAB, viser.Icon.HAND_MOVE):
            self._style.add()
            self.guidance = self._gui.add_html("")
            self.end_buttons = EndButtons(self._gui, self._ask)
        panel.dock_left()
        panel.expand()  # phones fold panels at first

    def _make_left(self, theme: Theme) -> None:
        gui = self._gui
        panel = self.left_panel = gui.add_panel()
        with panel.add_tab(say.PROGRESS_TAB, viser.Icon.CHART_LINE):
            self._style.add()
            self.diagnoses = gui.add_html("", visible=False)
            self.result = gui.add_html("")
            self.progress = gui.add_html("")
            self.alternatives = AlternativesPanel(gui, self._ask)
        with panel.add_tab(say.PARAMETERS_TAB, viser.Icon.CAMERA_COG):
            self._style.add()
            self.parameters = ParametersPanel(gui, theme)
        for layer in self._layers:
            with panel.add_tab(layer.title, layer.icon):
                self._style.add()
                layer.lay_out(gui)
        panel.dock_below(self.guidance_panel)

    def _make_right(self) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        self._style.add()
        blank = np.full((PICTURE_WIDTH * 9 // 16, PICTURE_WIDTH, 3), 40, np.uint8)
        self.picture = gui.add_image(blank, format="jpeg", jpeg_quality=JPEG_QUALITY)
        self.flow = gui.add_html("", visible=False)
        self._legend = gui.add_html(picture_legend_html())
        self.loop = gui.add_html("", visible=False)
        self.projections = ProjectionsPanel(gui)
        self.controls = ControlPanel(
            gui, self._ask, simulated=self._simulated, recorded=self._recorded
        )
        title, hint = say.ROWS["page"]
        labels = {name: say.BUTTONS[name][0] for name in ("help", "tour", "fit")}
        ButtonRow(gui, title, labels, self._asked_about_page, hint=hint)
        self.camera = CameraPanel(gui, self._ask)
        self.built = BuiltPanel(gui)
        self.end_map = EndMap(gui)
        if not self._recorded:
            self.method = MethodPanel(gui, self._ask)
        self._film.lay_out(gui)

    def _make_commands(self, tour: bool) -> None:
        panels = (self.controls, *self._layers)
        if not self._recorded:
            panels = (self.controls, self.alternatives, *self._layers, self.method)
        commands = (*(c for panel in panels for c in panel.commands), self._rig.command)
        add_commands(self._server, commands)
        steps = [TourStep(*texts, marks) for texts, marks in zip(say.TOUR, _MARKS, strict=True)]
        self.tour = Tour(self._server, TOUR_KEY, steps, at_first=tour)
        self.help = HelpOverlay(self._server, (*commands, *self.tour.commands))

    def _asked_about_page(self, what: str, client: viser.ClientHandle | None) -> None:
        if client is not None:
            {"help": self.help.toggle, "tour": self.tour.start, "fit": self._rig.fit}[what](client)

    def _set_theme(self, theme: Theme) -> None:
        if self._style.show(theme):
            self._recolour(theme)

    def _recolour(self, theme: Theme) -> None:
        self.parameters.recolour(theme)
        self.tour.show(theme)
        self.help.show(theme)

"""The page's layout: what stands where, and how one moment is put on it.

left    progress: views, what the next pose is for and which others would do, parameters, trend,
        captured views
middle  the 3D scene, with the large guidance text below it
right   live picture, the four steps as the camera sees them, controls, how poses are found
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from venus3d.engine.snapshot import Snapshot
from venus3d.scene.guide.alternatives_panel import AlternativesPanel
from venus3d.scene.guide.control_panel import Action, ControlPanel
from venus3d.scene.guide.diagnosis_panel import diagnoses_html
from venus3d.scene.guide.guidance_panel import guidance_html
from venus3d.scene.guide.intents import DropView, Intent
from venus3d.scene.guide.method_panel import MethodPanel
from venus3d.scene.guide.progress_panel import (
    parameters_html,
    progress_html,
    trend,
    trend_caption,
    trend_series,
)
from venus3d.scene.guide.view_state import ViewState
from venus3d.scene.picture import PICTURE_WIDTH
from venus3d.scene.projections_panel import projections_html
from venus3d.scene.strip import STRIP_CENTRE
from venus3d.scene.style import Theme

LEFT_WIDTH, _RIGHT_WIDTH, _GUIDE_WIDTH = 340, 600, 940
_SMALL_SCREEN_HEIGHT, _SMALL_RIGHT_WIDTH = 850, 370
# Neutral: the steps have the colours.
_BRAND = {True: (150, 163, 184), False: (70, 82, 102)}
JPEG_QUALITY = 75
PICTURE_LEGEND = (
    "<div class='v-steps'><div class='v-legend'><b>Thick outline</b>: where this step ends &nbsp; "
    "<b>dashes</b>: the target &nbsp; <b>dots</b>: corners found</div></div>"
)
_Point = tuple[float, float, float]
# Where the person looks from: behind, above and to the side of the camera.
_NEAR_TARGET = 0.45
"""Up to this distance of the target, metres, the scene is seen from `_LOOK_FROM`."""
_LOOK_FROM, _LOOK_AT, _FOV_RAD = (-0.60, -0.42, -0.33), (-0.02, 0.16, 0.27), np.radians(42.0)


class Page:
    """All panels of one server. `act` and `ask` are called on viser's threads."""

    def __init__(
        self,
        server: viser.ViserServer,
        act: Callable[[Action], None],
        ask: Callable[[Intent], None],
        *,
        dark: bool,
        simulated: bool,
    ) -> None:
        """Lay everything out."""
        self._server, self._gui = server, server.gui
        self._dark: bool | None = None
        self._styles: list[Any] = []
        self._ask = ask
        camera = server.initial_camera
        camera.fov, camera.near, camera.far = float(_FOV_RAD), 0.01, 50.0
        self._look(_LOOK_FROM, _LOOK_AT)
        theme = Theme(dark)
        self._set_theme(theme)
        self._make_right(act, simulated)
        self._make_left(theme)
        self._make_guidance()
        self._set_theme(theme, force=True)
        server.on_client_connect(self._fit)

    def look_at_scene(self, back: float) -> None:
        """Every tab looks at camera, board and target, from `back` times as far away as usual."""
        (fx, fy, fz), (ax, ay, az) = _LOOK_FROM, _LOOK_AT
        self._look((back * fx, back * fy, back * fz), (back * ax, back * ay, back * az))

    def look_at_strip(self, bounds: NDArray[np.float64]) -> None:
        """Every tab looks from behind the camera at a strip with these bounds, (2, 3), metres."""
        x, y, z = STRIP_CENTRE
        width = 1.1 * float(bounds[1, 0] - bounds[0, 0])
        # The scene's part of the page is about as wide as it is high; what stands in front of the
        # steps' common depth (where the board comes from) looks larger and needs room as well.
        distance = 0.55 * width / float(np.tan(_FOV_RAD / 2)) + max(0.0, z - float(bounds[0, 2]))
        # The text covers the lower third, so the strip stands above the middle.
        middle = y + 0.16 * width
        self._look((x, middle - 0.25 * distance, z - distance), (x, middle, z))

    def show_picture(self, rgb: NDArray[np.uint8]) -> None:
        """The live picture (H, W, 3) RGB."""
        self.picture.image = rgb

    def show(
        self,
        snapshot: Snapshot | None,
        state: ViewState,
        projections: tuple[str, ...],
        note: str,
        drawn_by: str,
    ) -> None:
        """Put one moment on the page; `drawn_by` says what draws the projections, if it matters."""
        theme = Theme(state.dark)
        self._set_theme(theme)
        text = guidance_html(snapshot, state, theme, note)
        self.guidance.content = f"<div class='v-wide'>{text}</div>"
        self.diagnoses.content = diagnoses_html(snapshot)
        self.diagnoses.visible = bool(self.diagnoses.content)
        self.progress.content = progress_html(snapshot)
        self.alternatives.show(snapshot)
        self.parameters.content = parameters_html(snapshot)
        self.projections.content = projections_html(projections, state.step, theme, drawn_by)
        # Once it has ended no target follows, so none is announced.
        ended = snapshot is not None and snapshot.phase in ("converged", "finished")
        self.projections.visible = bool(projections) or not ended
        self.controls.show(state)
        if snapshot is not None:
            self.method.show(snapshot)
            self._show_trend(snapshot)
            self._show_views(snapshot)

    def _right_width(self, height: int) -> int:
        """Width of the right panel in a window of this height, pixels."""
        return _SMALL_RIGHT_WIDTH if height < _SMALL_SCREEN_HEIGHT else _RIGHT_WIDTH

    def _fit(self, client: viser.ClientHandle) -> None:
        # Only this client's own window: another one may be on a large screen.
        shown = _RIGHT_WIDTH

        def fit() -> None:
            nonlocal shown
            wanted = self._right_width(client.camera.image_height)
            if wanted != shown:
                shown = wanted
                client.gui.main_panel.set_width(wanted)

        fit()
        client.camera.on_update(lambda _: fit())  # also told when the window changes its size

    def _look(self, position: _Point, look_at: _Point) -> None:
        initial = self._server.initial_camera
        initial.position, initial.look_at = position, look_at
        for client in self._server.get_clients().values():
            with client.atomic():
                client.camera.position, client.camera.look_at = position, look_at

    def _make_right(self, act: Callable[[Action], None], simulated: bool) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        gui.main_panel.set_width(_RIGHT_WIDTH)
        self._add_style()
        blank = np.full((PICTURE_WIDTH * 9 // 16, PICTURE_WIDTH, 3), 40, np.uint8)
        self.picture = gui.add_image(blank, format="jpeg", jpeg_quality=JPEG_QUALITY)
        gui.add_html(PICTURE_LEGEND)
        self.projections = gui.add_html("")
        self.controls = ControlPanel(self._server, act, simulated=simulated)
        self.method = MethodPanel(self._server, self._ask)

    def _make_left(self, theme: Theme) -> None:
        gui = self._gui
        panel = gui.add_panel()
        with panel.add_tab("Progress", viser.Icon.CHART_LINE):
            self._add_style()
            self.diagnoses = gui.add_html("", visible=False)
            self.progress = gui.add_html("")
            self.alternatives = AlternativesPanel(self._server, self._ask)
            self.parameters = gui.add_html("")
            self._caption = gui.add_html("", visible=False)
            start = np.array([0.0, 1.0])
            self.trend = gui.add_uplot(
                (start, *(np.ones(2) for _ in range(9))),
                trend_series(theme),
                scales={"x": {"time": False}, "y": {"distr": 3}},
                axes=(
                    {"label": "views", "labelSize": 18, "size": 30, "incrs": (1.0, 2.0, 5.0, 10.0)},
                    {"label": "%", "labelSize": 16, "size": 44},
                ),
                legend={"show": False},
                height=160,
                padding=(12, 16, 0, 0),
                visible=False,
            )
            self._views = gui.add_dropdown("View", ["–"], visible=False)
            self._drop_button = gui.add_button(
                "Leave this view out",
                icon=viser.Icon.TRASH,
                visible=False,
                hint="Calibrate again without the view chosen above.",
            )
            self._drop_button.on_click(lambda _: self._drop_chosen())
        panel.dock_left()
        panel.set_width(LEFT_WIDTH)

    def _make_guidance(self) -> None:
        panel = self.guidance_panel = self._gui.add_panel()
        with panel.add_tab("What to do now", viser.Icon.HAND_MOVE):
            self._add_style()
            self.guidance = self._gui.add_html("")
        panel.float(x=16, y=-16, width=_GUIDE_WIDTH)

    def _add_style(self) -> None:
        # A panel that is folded takes its style sheet along, so each has its own.
        self._styles.append(self._gui.add_html(""))

    def _set_theme(self, theme: Theme, *, force: bool = False) -> None:
        if theme.dark == self._dark and not force:
            return
        self._dark = theme.dark
        self._gui.configure_theme(
            dark_mode=theme.dark,
            show_logo=False,
            show_share_button=False,
            brand_color=_BRAND[theme.dark],
        )
        for style in self._styles:
            style.content = theme.sheet
        if self._styles:
            self._recolour(theme)

    def _recolour(self, theme: Theme) -> None:
        self.trend.series = trend_series(theme)
        self._caption.content = trend_caption(theme)

    def _show_trend(self, snapshot: Snapshot) -> None:
        lines = trend(snapshot.history)
        self._caption.visible = self.trend.visible = lines is not None
        if lines is not None:
            self.trend.data = lines

    def _show_views(self, snapshot: Snapshot) -> None:
        options = tuple(f"{view.number} · {view.rms_px:.2f} px" for view in snapshot.views)
        self._views.visible = self._drop_button.visible = len(options) > 1
        if options and self._views.options != options:
            # viser falls back on the first option when the chosen one's text has changed.
            chosen = str(self._views.value).split(" ")[0]
            self._views.options = options
            same = [option for option in options if option.split(" ")[0] == chosen]
            self._views.value = same[0] if same else options[-1]

    def _drop_chosen(self) -> None:
        number = str(self._views.value).split(" ")[0]
        if number.isdigit():
            self._ask(DropView(int(number)))


def steps_back(distance: float) -> float:
    """How much farther away to look from, 1 ... 2.5, so that a target `distance` metres away from
    the camera is seen; in halves, so that the view a person has turned to is mostly kept."""
    return float(min(2.5, max(1.0, np.ceil(2 * distance / _NEAR_TARGET) / 2)))

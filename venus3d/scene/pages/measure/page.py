"""The page: the undistorted picture with what was measured over it, and one panel beside it.

Picture, board and points of one moment come from one observation, so they agree however the board
moves. A click is a ray from the lens; where it meets the board's plane is a point of the board,
which stays there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from html import escape
from typing import Any

import numpy as np
import viser

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.camera_plausibility import WrongCamera
from venus3d.engine.calibration.measurement import MeasuringCamera, measure, on_plane
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.languages import number
from venus3d.render.annotated_picture import small_picture
from venus3d.render.picture_plane import undistortion
from venus3d.scene.pages.measure import texts as say
from venus3d.scene.pages.measure.shapes import measure_shapes
from venus3d.scene.pages.measure.state import MeasureState
from venus3d.scene.pages.measure.texts import Tool
from venus3d.scene.web.buttons import ButtonRow, ChoiceList
from venus3d.scene.web.delivery import deliver
from venus3d.scene.web.help import Command, HelpOverlay, add_commands
from venus3d.scene.web.keys import KEYS
from venus3d.scene.web.lens_view import LensView
from venus3d.scene.web.page import Page
from venus3d.scene.web.panels import PanelStyle
from venus3d.scene.web.scene_view import SceneView
from venus3d.scene.web.server import LocalServer, start_server
from venus3d.scene.web.theme import Theme

_PERIOD_S = 1 / 15
_PICTURE_WIDTH = 1280
_PANEL_WIDTH = 400
_HIT = 0.7
"""Standard deviation of a click's coordinate, in pixels of the screen."""
_EDGES_MM = (10.0, 200.0, 5.0)
_SCALE_PERCENT = 1


class MeasurePage(Page[MeasureState]):
    """One page for all tabs; its state is what was clicked."""

    def __init__(
        self,
        host: str,
        port: int,
        by: MeasuringCamera,
        board: Board,
        language: Any = None,
    ) -> None:
        """Serve the page. Raises `AddressError` for an address that cannot be bound."""
        super().__init__(
            *start_server(host, port, language), state=MeasureState(), period_s=_PERIOD_S
        )
        self.on_hold: Callable[[bool], None] = lambda _: None
        """Called when the picture is held, or goes on; must not block."""
        self._by, self._board = by, board
        self._seen: tuple[Observation, Pose | None] | None = None
        self._remark = ""
        self._wrong = WrongCamera(by.camera, board)
        self._open()

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of the pictures of the camera that is measured with."""
        return self._by.camera.image_size

    @property
    def is_wrong(self) -> bool:
        """Whether the last pictures show the board as this camera cannot see it."""
        return self._wrong.is_sure

    def measure_by(self, by: MeasuringCamera, board: Board) -> None:
        """Measure with another camera from now on, and begin anew."""
        self._seen, self._by, self._board = None, by, board
        self._wrong = WrongCamera(by.camera, board)
        self.clear()

    def show(self, observation: Observation) -> None:
        """Show this picture with the board that is in it; from one thread."""
        before = None if self._seen is None else self._seen[1]
        camera = self._by.camera
        pose = (
            estimate_pose(camera, self._board, observation, before) if observation.count else None
        )
        self._wrong.look(observation, pose)
        self._seen = (observation, pose)
        self.wake()

    def click(self, ray: Array, px_of_screen: float) -> None:
        """A click along a ray (3,) from the lens; from any thread.

        Args:
            px_of_screen: how many of the picture's pixels are one of the screen's.
        """
        seen = self._seen
        if seen is None or seen[1] is None or not ray[2] > 0:
            return
        observation, pose = seen[0], seen[1]
        pixel = self._by.camera.project(ray[None] / ray[2])
        x, y = on_plane(self._by.camera, pose, pixel)[0].tolist()
        if not np.isfinite([x, y]).all():
            self._remark = say.MISSED
            self.wake()
            return
        self._remark = ""
        after = self.change(lambda state: state.clicked((x, y)))
        ends = after.ends
        if ends is not None:
            pixels = self._by.camera.project(pose.apply(ends))
            found = measure(
                self._by, self._board, observation, pose, pixels, _HIT * max(px_of_screen, 0.5)
            )
            self.change(lambda state: replace(state, measured=found) if state is after else state)

    def clear(self) -> None:
        """Take the points away."""
        self._remark = ""
        self.change(MeasureState.cleared)

    def hold(self) -> None:
        """Hold the picture, or go on."""
        self.on_hold(self.change(lambda state: replace(state, held=not state.held)).held)

    # -- drawing ---------------------------------------------------------------------------------

    def _lay_out(self, server: LocalServer) -> None:
        self._scene, self._lens = SceneView(server), LensView(server, self.wake)
        gui = server.gui
        gui.main_panel.dock_right()
        gui.main_panel.set_width(_PANEL_WIDTH)
        gui.set_panel_label(say.TITLE)
        self._style = PanelStyle(gui)
        self._style.add()
        self._text = gui.add_html("")
        self._tools: ChoiceList[Tool] = ChoiceList(
            gui, say.TOOL_LABEL, say.TOOLS, self._choose, hint=say.TOOL_HINT
        )
        low, high, step = _EDGES_MM
        self._edge = gui.add_slider(say.CUBE_EDGE, low, high, step, 1000 * self.state.edge_m)
        self._edge.on_update(self._resize)
        ButtonRow(
            gui,
            say.ACTIONS_LABEL,
            {"clear": say.CLEAR, "hold": say.HOLD},
            lambda action, _: self.clear() if action == "clear" else self.hold(),
            hint=say.ACTIONS_HINT,
        )
        self._note = gui.add_html("")
        commands = (
            Command(say.CLEAR_COMMAND, KEYS["undo"], say.CLEAR_COMMAND_HINT, self.clear),
            Command(say.HOLD_COMMAND, KEYS["go_on"], say.HOLD_COMMAND_HINT, self.hold),
            Command(say.THEME_COMMAND, KEYS["theme"], say.THEME_COMMAND_HINT, self._turn_theme),
        )
        add_commands(server, commands)
        self._help = HelpOverlay(server, commands)
        server.scene.on_click()(self._clicked)

    def _choose(self, tool: Tool) -> None:
        self.change(lambda state: state.with_tool(tool))

    def _resize(self, event: Any) -> None:
        if event.client is not None:
            self.change(lambda state: replace(state, edge_m=float(event.target.value) / 1000))

    def _turn_theme(self) -> None:
        self.change(lambda state: replace(state, dark=not state.dark))

    def _clicked(self, event: viser.SceneClickEvent) -> None:
        camera, client = self._by.camera, event.client.camera
        on_screen = max(client.image_height, 1) / (2 * np.tan(client.fov / 2))
        self.click(np.array(event.ray_direction, dtype=np.float64), camera.fy / on_screen)

    def _draw(self, changed: bool, seconds: float) -> None:
        state, seen = self.state, self._seen
        with self.server.atomic():
            theme = Theme(state.dark)
            if self._style.show(theme):
                self._help.show(theme)
            self._edge.visible = state.tool == "cube"
            self._note.content = self._note_html(state)
            self._text.content = self._text_html(state, seen)
            if seen is not None:
                self._draw_picture(seen[0])
                label = "" if state.measured is None else _length(state)
                self._scene.draw(measure_shapes(state, seen[1], label), dark=state.dark)
        self._lens.fit()
        self._scene.refresh()
        deliver(self.server)

    def _draw_picture(self, observation: Observation) -> None:
        if observation.image is None:
            return
        rgb = small_picture(observation.image, _PICTURE_WIDTH)
        straight = undistortion(self._by.camera.scaled((rgb.shape[1], rgb.shape[0])))
        self._lens.show_picture(straight.straightened(rgb), straight.plane)

    def _text_html(self, state: MeasureState, seen: tuple[Observation, Pose | None] | None) -> str:
        if self.is_wrong:
            what = say.WRONG
        elif seen is None or seen[1] is None:
            what = say.NO_BOARD
        elif state.tool == "cube":
            what = say.CUBE
        else:
            what = (say.FIRST, say.SECOND, say.AGAIN)[len(state.points)]
        attention = " class='v-attention'" if self.is_wrong else ""
        told = f"<p{attention}>{escape(what)}</p>"
        found = "" if state.measured is None else f"<div class='v-measured'>{_length(state)}</div>"
        held = f"<div class='v-line'>{escape(say.HELD)}</div>" if state.held else ""
        remark = f"<div class='v-line v-attention'>{escape(self._remark)}</div>" * bool(
            self._remark
        )
        return f"<div class='v-measure'>{found}{told}{held}{remark}</div>"

    def _note_html(self, state: MeasureState) -> str:
        if state.tool == "cube":
            return f"<div class='v-measure-note'><p>{escape(say.CHECK_CUBE)}</p></div>"
        square = number(f"{1000 * self._board.square:.4g}")
        check = say.CHECK if self._by.covariance is not None else say.CHECK_WITHOUT_CAMERA
        check = check.format(percent=_SCALE_PERCENT, square=square)
        return f"<div class='v-measure-note'><p>{escape(check)}</p></div>"


def _length(state: MeasureState) -> str:
    """The length with its ±, as many digits as the ± has meaning."""
    assert state.measured is not None
    length, sigma = 1000 * state.measured.length_m, 1000 * state.measured.sigma_m
    digits = int(np.clip(np.ceil(-np.log10(max(sigma, 1e-9))), 0, 2))
    return say.LENGTH.format(
        length=number(f"{length:.{digits}f}"), sigma=number(f"{sigma:.{digits}f}")
    )

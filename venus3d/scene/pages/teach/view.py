"""The layout of a teaching page, and how one pose is shown on it.

left    the lesson, its question, its live figures; the pose in six numbers and whether it is
acceptable
middle  the 3D scene
right   the camera's view; the current step in words; progress and its controls; viewpoints; the
four steps as the camera sees them; saving
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from venus3d.lessons.lesson import Lesson
from venus3d.render.projections import Picture
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import FileKind, Save
from venus3d.scene.pages.teach.controls import (
    LOOK_ROW,
    MORE_ROW,
    SHOW_ROW,
    STEP_ROW,
    TEMPO_ROW,
    Act,
    StateButtons,
    make_commands,
)
from venus3d.scene.pages.teach.lesson_html import card_html
from venus3d.scene.pages.teach.lesson_panel import LessonPanel
from venus3d.scene.pages.teach.state import TeachState, Vector
from venus3d.scene.pages.teach.view_model import TaughtPose
from venus3d.scene.web.buttons import ButtonRow
from venus3d.scene.web.panels import PanelStyle, fit_width
from venus3d.scene.web.theme import Theme

# (lowest height of the window, width on the left, width on the right), pixels
_WIDTHS = ((900, 520, 500), (0, 400, 340))
_JPEG_QUALITY = 82
MARKS = tuple(zip((0, 25, 50, 75, 100), texts.PROGRESS_MARKS, strict=True))


class TeachView:
    """All panels of one server. Callbacks come on viser's threads."""

    def __init__(
        self,
        server: viser.ViserServer,
        act: Act,
        lessons: tuple[Lesson, ...],
        *,
        on_pose: Callable[[Vector], object],
        on_lesson: Callable[[int | None], object],
        on_progress: Callable[[float], object],
        kinds: tuple[FileKind, ...],
        aspect: float,
    ) -> None:
        """Lay everything out.

        Args:
            on_progress: gets a share of the path, 0 ... 1.
            kinds: the available file types.
            aspect: the camera picture's width over its height.
        """
        self._server, self._gui = server, server.gui
        self._style = PanelStyle(server.gui)
        self._make_right(act, on_progress, aspect)
        panel = self._left = self._gui.add_panel()
        with panel.add_tab(texts.LESSON_TAB, viser.Icon.SCHOOL):
            self._style.add()
            self.lesson = LessonPanel(self._gui, act, lessons, on_pose, on_lesson)
            for label, row, hint in (
                (texts.TEMPO, TEMPO_ROW, texts.TEMPO_HINT),
                (texts.PAGE, MORE_ROW, texts.PAGE_HINT),
            ):
                self._rows.append(StateButtons(self._gui, label, row, act, hint))
            if kinds:
                labels = {Save(kind): texts.SAVE_LABELS[kind] for kind in kinds}
                ButtonRow(self._gui, texts.SAVE, labels, act, hint=texts.SAVE_HINT)
        panel.dock_left()
        panel.expand()  # phones fold panels at first
        self._help = make_commands(server, act, [Save(kind) for kind in kinds])
        fit_width(server, panel, lambda height: _widths(height)[0])
        fit_width(server, self._gui.main_panel, lambda height: _widths(height)[1])

    def show(self, taught: TaughtPose, state: TeachState) -> None:
        """Show one pose."""
        theme = Theme(state.dark)
        self._style.show(theme)
        self._help.show(theme)
        self.lesson.show(taught, state, theme)
        card = card_html(taught, state, theme)
        if self.card.content != card:
            self.card.content = card
        for row in self._rows:
            row.show(state)
        share = round(25 * min(state.progress, 4.0))
        if share != self._share:
            # Only on a change: the slider has its new value before `on_progress` is called.
            self._share = share
            if not state.dragged:
                self.progress.value = share

    def show_camera_picture(self, picture: Picture) -> None:
        """Show the camera's view, RGB."""
        self.picture.image = picture

    def show_steps_picture(self, picture: Picture) -> None:
        """Show the four steps in one picture, RGB."""
        self.steps_picture.image = picture

    def notify(
        self,
        client: viser.ClientHandle | None,
        text: str,
        *,
        seconds: float | None = None,
        busy: bool = False,
    ) -> Callable[[], None]:
        """Show one tab, or all, a sentence, for some seconds or until closed; returns a function
        that removes it. `busy`: with a spinner."""
        clients = self._server.get_clients().values() if client is None else (client,)
        notes = [
            one.add_notification(texts.SAVE, text, loading=busy, auto_close_seconds=seconds)
            for one in clients
        ]

        def remove() -> None:
            for note in notes:
                note.remove()

        return remove

    def _make_right(self, act: Act, on_progress: Callable[[float], object], aspect: float) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        self._style.add()
        self._heading(texts.PICTURE_TITLE)
        blank = np.full((round(480 / aspect), 480, 3), 40, np.uint8)
        self.picture = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)
        self.card = gui.add_html("")
        self._rows = [StateButtons(gui, texts.STEPS, STEP_ROW, act, texts.STEPS_HINT)]
        self.progress: Any = gui.add_slider(
            texts.PROGRESS, 0, 100, 1, 100, marks=MARKS, hint=texts.PROGRESS_HINT
        )
        self._share = 100

        def moved(event: Any) -> None:
            if event.client is not None:
                on_progress(event.target.value / 100)

        self.progress.on_update(moved)
        rows = (
            (texts.LOOK, LOOK_ROW, texts.LOOK_HINT),
            (texts.SHOW, SHOW_ROW, texts.SHOW_HINT),
        )
        self._rows += [StateButtons(gui, label, row, act, hint) for label, row, hint in rows]
        self._heading(texts.STEPS_PICTURE_TITLE)
        self.steps_picture = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)

    def _heading(self, text: str) -> None:
        self._gui.add_html(f"<div class='v-progress'><div class='v-head2'>{text}</div></div>")


def _widths(height: int) -> tuple[int, int]:
    """Widths of the left and right panel in a window of this height, pixels."""
    return next((left, right) for low, left, right in _WIDTHS if height >= low)

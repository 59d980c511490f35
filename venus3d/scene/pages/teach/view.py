"""The layout of a teaching page: what stands where, and how one moment is put on it.

left    the lesson, its question, what it shows live; the pose in six numbers and whether it may be
middle  the 3D scene
right   what the camera sees now; what happens, in words; the way and its controls; where to look
        from; the four steps as the camera sees them; saving
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from venus3d.lessons.lesson import Lesson
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.card import card_html
from venus3d.scene.pages.teach.controls import (
    LOOK_ROW,
    MORE_ROW,
    SHOW_ROW,
    STEP_ROW,
    TEMPO_ROW,
    Act,
    ButtonRow,
    make_commands,
)
from venus3d.scene.pages.teach.lesson_panel import LessonPanel
from venus3d.scene.pages.teach.state import TeachState, Vector
from venus3d.scene.pages.teach.view_model import TeachMoment
from venus3d.scene.render.projections import Picture
from venus3d.scene.web.dressing import Dressing
from venus3d.scene.web.theme import Theme
from venus3d.scene.web.windows import fit_width

# (lowest height of the window, width on the left, width on the right), pixels
_WIDTHS = ((900, 520, 500), (0, 400, 340))
_JPEG_QUALITY = 82
MARKS = tuple(zip((0, 25, 50, 75, 100), texts.WAY_MARKS, strict=True))


class TeachPage:
    """All panels of one server. Callbacks come on viser's threads."""

    def __init__(
        self,
        server: viser.ViserServer,
        act: Act,
        lessons: tuple[Lesson, ...],
        *,
        on_pose: Callable[[Vector], object],
        on_lesson: Callable[[int | None], object],
        on_way: Callable[[float], object],
        kinds: tuple[str, ...],
        aspect: float,
    ) -> None:
        """Lay everything out.

        Args:
            on_way: gets a share of the way, 0 ... 1.
            kinds: the kinds of file that can be saved.
            aspect: the camera picture's width over its height.
        """
        self._server, self._gui = server, server.gui
        self._dressing = Dressing(server.gui)
        self._make_right(act, on_way, aspect)
        panel = self._left = self._gui.add_panel()
        with panel.add_tab(texts.LESSON_TAB, viser.Icon.SCHOOL):
            self._dressing.add()
            self.lesson = LessonPanel(self._gui, act, lessons, on_pose, on_lesson)
            for label, row, hint in (
                (texts.TEMPO, TEMPO_ROW, texts.TEMPO_HINT),
                (texts.PAGE, MORE_ROW, texts.PAGE_HINT),
            ):
                self._rows.append(ButtonRow(self._gui, label, row, act, hint))
            if kinds:
                self._make_saving(act, kinds)
        panel.dock_left()
        panel.expand()  # on a phone panels are folded at first
        self._help = make_commands(server, act, kinds)
        fit_width(server, panel, lambda height: _widths(height)[0])
        fit_width(server, self._gui.main_panel, lambda height: _widths(height)[1])

    def show(self, moment: TeachMoment, state: TeachState) -> None:
        """Put one moment on the page."""
        theme = Theme(state.dark)
        self._dressing.show(theme)
        self._help.show(theme)
        self.lesson.show(moment, state, theme)
        card = card_html(moment, state, theme)
        if self.card.content != card:
            self.card.content = card
        for row in self._rows:
            row.show(state)
        share = round(25 * min(state.way, 4.0))
        if share != self._share:
            # Not otherwise: where it was put is in the slider before `on_way` hears of it.
            self._share = share
            if not state.dragged:
                self.way.value = share

    def show_moment(self, picture: Picture) -> None:
        """What the camera sees now, RGB."""
        self.picture.image = picture

    def show_sheet(self, picture: Picture) -> None:
        """The four steps in one picture, RGB."""
        self.sheet.image = picture

    def say(
        self,
        client: viser.ClientHandle | None,
        text: str,
        *,
        seconds: float | None = None,
        busy: bool = False,
    ) -> Callable[[], None]:
        """Tell one tab, or all, a sentence, for some seconds or until it is closed.

        Args:
            busy: with a mark that turns: something is going on.

        Returns what takes it back.
        """
        clients = self._server.get_clients().values() if client is None else (client,)
        notes = [
            one.add_notification(texts.SAVE, text, loading=busy, auto_close_seconds=seconds)
            for one in clients
        ]

        def unsay() -> None:
            for note in notes:
                note.remove()

        return unsay

    def _make_right(self, act: Act, on_way: Callable[[float], object], aspect: float) -> None:
        gui = self._gui
        gui.main_panel.dock_right()
        self._dressing.add()
        self._heading(texts.PICTURE_TITLE)
        blank = np.full((round(480 / aspect), 480, 3), 40, np.uint8)
        self.picture = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)
        self.card = gui.add_html("")
        self._rows = [ButtonRow(gui, texts.STEPS, STEP_ROW, act, texts.STEPS_HINT)]
        self.way: Any = gui.add_slider(texts.WAY, 0, 100, 1, 100, marks=MARKS, hint=texts.WAY_HINT)
        self._share = 100

        def moved(event: Any) -> None:
            if event.client is not None:
                on_way(event.target.value / 100)

        self.way.on_update(moved)
        rows = (
            (texts.LOOK, LOOK_ROW, texts.LOOK_HINT),
            (texts.SHOW, SHOW_ROW, texts.SHOW_HINT),
        )
        self._rows += [ButtonRow(gui, label, row, act, hint) for label, row, hint in rows]
        self._heading(texts.SHEET_TITLE)
        self.sheet = gui.add_image(blank, format="jpeg", jpeg_quality=_JPEG_QUALITY)

    def _make_saving(self, act: Act, kinds: tuple[str, ...]) -> None:
        labels = {texts.SAVE_LABELS[kind]: kind for kind in kinds}
        group: Any = self._gui.add_button_group(texts.SAVE, tuple(labels), hint=texts.SAVE_HINT)

        def clicked(event: Any) -> None:
            act(f"save {labels[event.target.value]}", event.client)

        group.on_click(clicked)

    def _heading(self, text: str) -> None:
        self._gui.add_html(f"<div class='v-progress'><div class='v-head2'>{text}</div></div>")


def _widths(height: int) -> tuple[int, int]:
    """Of the left and of the right panel in a window of this height, pixels."""
    return next((left, right) for low, left, right in _WIDTHS if height >= low)

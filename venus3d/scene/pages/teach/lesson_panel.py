"""The left column of a teaching page: lesson, question, and the pose's six numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import viser

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.lessons.lesson import Lesson
from venus3d.render.palette import ground
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import Answer, OpenLesson, PageAction, SetPose
from venus3d.scene.pages.teach.controls import PAGE_ROW, Act, StateButtons
from venus3d.scene.pages.teach.learner import TabView
from venus3d.scene.pages.teach.lesson_html import (
    acceptance_html,
    class_html,
    focal_uncertainty_html,
    lens_picture,
    lesson_html,
    question_html,
    untold_comparison_html,
)
from venus3d.scene.pages.teach.notations_panel import NotationsPanel
from venus3d.scene.pages.teach.state import FREE_VECTOR, TeachState, Vector
from venus3d.scene.web.buttons import ChoiceList
from venus3d.scene.web.pose_panel import PosePanel
from venus3d.scene.web.tabs import Ask
from venus3d.scene.web.theme import Theme

_ANSWERS = 5
_FREE = -1  # in the list of lessons


class LessonPanel:
    """Created in the current panel. Callbacks come on viser's threads."""

    def __init__(
        self,
        gui: viser.GuiApi,
        act: Act,
        ask: Ask,
        lessons: tuple[Lesson, ...],
    ) -> None:
        """Create everything; `ask` gets what the list and the sliders ask for."""
        self._titles = {number: lesson.title for number, lesson in enumerate(lessons)}
        self._titles[_FREE] = texts.FREE

        def chosen(number: int) -> None:
            ask(OpenLesson(None if number == _FREE else number))

        self._class = gui.add_html("", visible=False)
        self._lead = StateButtons(gui, texts.CLASS, (PageAction.LEAD,), act, texts.CLASS_HINT)
        self._choice = ChoiceList(
            gui,
            texts.LESSON,
            self._titles,
            chosen,
            chosen=_FREE,
            hint=texts.LESSON_HINT,
        )
        self._text = gui.add_html("")
        self._question = gui.add_html("", visible=False)
        self._answers = [self._answer_button(gui, act, n) for n in range(1, _ANSWERS + 1)]
        self._pages = StateButtons(gui, texts.PAGES, PAGE_ROW, act, texts.PAGES_HINT)
        self._sigma = gui.add_html("", visible=False)
        blank = np.zeros((9, 16, 3), np.uint8)
        self._lens = gui.add_image(blank, format="jpeg", jpeg_quality=85, visible=False)
        self._lens_legend = gui.add_html("", visible=False)
        gui.add_html(f"<div class='v-progress'><h3>{texts.POSE_TITLE}</h3></div>")
        self.pose = PosePanel(gui, lambda vector: ask(SetPose(_vector(vector))), FREE_VECTOR)
        self._notations = NotationsPanel(gui)
        self._fit = gui.add_html("")
        self._why = gui.add_html("", visible=False)
        self._shown: dict[str, object] = {}

    def show(self, view: TabView, theme: Theme) -> None:
        """Show one view; unchanged parts are not touched."""
        taught, state, follows = view.taught, view.state, view.role == "follows"
        self._put(self._class, class_html(view))
        self._lead.show(state, visible=view.may_lead, leads=view.role == "leads")
        self._show_lesson(state)
        self._choice.visible = not follows
        self._pages.show(state, visible=not follows)
        if self._changed("free", not follows):
            self.pose.enable([not follows] * 6)
        self._put(self._question, question_html(state))
        self._show_answers(state, theme)
        page = state.current_page
        self._put(self._why, untold_comparison_html(taught, state))
        extras = () if page is None else page.show
        self._put(self._sigma, focal_uncertainty_html(taught) if "sigma" in extras else "")
        self._show_lens(taught.camera, theme.dark, "distortion" in extras)
        self._notations.show(taught, state)
        self._put(self._fit, acceptance_html(taught, live=not follows))
        if self._changed("pose", state.pose_version):
            self.pose.show(state.vector)

    def _answer_button(self, gui: viser.GuiApi, act: Act, number: int) -> Any:
        button = gui.add_button(str(number), visible=False, hint=texts.ANSWER_HINT)
        button.on_click(lambda _: act(Answer(number)))
        return button

    def _show_lesson(self, state: TeachState) -> None:
        if not self._changed("page", (state.lesson, state.page)):
            return
        lesson, page = state.current_lesson, state.current_page
        self._choice.show(self._titles, _FREE if state.lesson is None else state.lesson)
        if lesson is None or page is None:
            self._text.content = lesson_html(texts.FREE_TITLE, "", texts.FREE_TEXT)
        else:
            where = texts.PAGE_OF.format(page=state.page + 1, pages=len(lesson.pages))
            self._text.content = lesson_html(page.title, where, page.text)

    def _show_answers(self, state: TeachState, theme: Theme) -> None:
        if not self._changed("answers", (state.lesson, state.page, state.answer, theme)):
            return
        page = state.current_page
        question = None if page is None else page.question
        for number, button in enumerate(self._answers, start=1):
            button.visible = question is not None and number <= len(question.answers)
            if question is None or not button.visible:
                continue
            text, colour = texts.ANSWER, None
            if state.answer is not None and number == question.right:
                text, colour = texts.ANSWER_RIGHT, ground(theme.dark).reached
            elif state.answer == number:
                text, colour = texts.ANSWER_WRONG, theme.wrong
            button.color = colour
            button.label = text.format(number=number, answer=question.answers[number - 1])

    def _show_lens(self, camera: Camera, dark: bool, shown: bool) -> None:
        self._lens.visible = self._lens_legend.visible = shown
        if shown and self._changed("lens", (camera, dark)):
            self._lens.image, legend = lens_picture(camera, dark)
            self._lens_legend.content = legend

    def _put(self, handle: Any, content: str) -> None:
        if handle.content != content:
            handle.content = content
        handle.visible = bool(content)

    def _changed(self, name: str, value: object) -> bool:
        if name in self._shown and self._shown[name] == value:
            return False
        self._shown[name] = value
        return True


def _vector(values: Array) -> Vector:
    a, b, c, x, y, z = (float(value) for value in values)
    return (a, b, c, x, y, z)

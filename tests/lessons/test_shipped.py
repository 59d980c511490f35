"""The lessons that come with the program: readable, complete, and poses that can be held."""

from __future__ import annotations

import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.planning.limits import Limits, refusals
from venus3d.lessons.lesson import EXTRAS, VIEWPOINTS, Lesson
from venus3d.lessons.reading import shipped_lessons
from venus3d.scene.web.pose_panel import RANGES

LESSONS = shipped_lessons()


def test_there_are_enough_of_them_and_they_use_all_that_a_lesson_can() -> None:
    assert len(LESSONS) >= 8
    pages = [page for lesson in LESSONS for page in lesson.pages]
    assert {page.arrangement for page in pages} >= {"place", "axes", "order"}
    assert {page.viewpoint for page in pages} >= {"outside", "camera", "holder"} <= set(VIEWPOINTS)
    assert {extra for page in pages for extra in page.show} == set(EXTRAS)


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_a_lesson_is_short_asks_something_and_says_why(lesson: Lesson) -> None:
    assert 2 <= len(lesson.pages) <= 5
    assert any(page.question for page in lesson.pages)
    for page in lesson.pages:
        assert len(page.title) <= 40
        assert 60 < len(page.text) < 700  # fits beside the scene on a small screen
        if page.question is not None:
            assert len(set(page.question.answers)) == len(page.question.answers)
            assert len(page.question.why) > 20


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_every_pose_can_be_held_or_the_page_says_why_not(
    lesson: Lesson, default_board: Board, paper_camera: Camera
) -> None:
    limits = Limits.for_board(default_board, paper_camera)
    for page in lesson.pages:
        refused = refusals(limits, paper_camera, default_board, page.target.vector())
        assert not refused or "beyond the limits" in page.text, f"{page.title}: {refused}"
        for value, (low, high, _) in zip(page.pose, RANGES, strict=True):
            assert low <= value <= high  # the page's sliders can show it


def test_the_two_poses_of_the_gimbal_lock_lesson_are_one() -> None:
    pages = {page.pose[:3]: page.target for lesson in LESSONS for page in lesson.pages}
    np.testing.assert_allclose(pages[30, 90, 0].R, pages[0, 90, -30].R, atol=1e-12)

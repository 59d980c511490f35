"""Every figure that a lesson's words state, against its page's own pose, the limits, or the engine.

Seen before: a page that spoke of 600 mm beside a step of 100 mm, and one that compared figures at
450 mm with one at 500 mm. Lesson 10 has a test of its own, with other notations.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import HOME_DISTANCE
from venus3d.engine.guidance.prompts import step_prompt
from venus3d.engine.planning.limits import Limits
from venus3d.lessons.lesson import LessonPage
from venus3d.lessons.reading import shipped_lessons
from venus3d.scene.pages.teach.view_model import PoseAnalysis

LESSONS = {
    int(lesson.name.split("-")[0]): lesson
    for lesson in shipped_lessons()
    if not lesson.name.startswith("10-")
}
# "80", "−40", "+25", "0.5", but not the 1 of k1 or of "step 1".
_FIGURE = re.compile(r"(?<![\w.])(?<!\w−)[+−]?\d+(?:\.\d+)?")
_STEP = re.compile(r"[Ss]teps? \d(?:(?:,| and) \d)*")


def words_of(page: LessonPage) -> str:
    question = page.question
    asked = () if question is None else (question.text, *question.answers, question.why)
    return " ".join((page.title, page.text, *asked))


def figures(text: str) -> list[float]:
    """All figures of a text, in its order."""
    found = _FIGURE.findall(_STEP.sub("", text))
    return [float(figure.replace("−", "-").replace("+", "")) for figure in found]


def limits_of() -> tuple[float, float]:
    camera = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
    limits = Limits.for_board(Board(), camera)
    return limits.max_angle_deg, limits.max_tilt_deg


ANGLE, TILT = limits_of()
HOME = 1000 * HOME_DISTANCE
Stated = Callable[[float, float, float, float, float, float], Sequence[float]]
# By lesson and page: what its words state, from its pose (a, b, c, x, y, z).
STATED: dict[tuple[int, int], Stated] = {
    (1, 1): lambda a, b, c, x, y, z: [a],
    (1, 2): lambda a, b, c, x, y, z: [x, -y, z, x, y, z, round(np.hypot(x, y)), y, -y],
    (1, 3): lambda a, b, c, x, y, z: [a],
    (2, 2): lambda a, b, c, x, y, z: [0, -y, y],
    (2, 3): lambda a, b, c, x, y, z: [z, HOME - z],
    (2, 4): lambda a, b, c, x, y, z: [z, z - HOME, *(400, 600, 800, 150, 600 * 400 / 800, 450)],
    (3, 4): lambda a, b, c, x, y, z: [20],
    (3, 5): lambda a, b, c, x, y, z: [b],
    (5, 1): lambda a, b, c, x, y, z: [x, -y, round(np.hypot(x, y))],
    (5, 2): lambda a, b, c, x, y, z: [a, b, 20, 10, 20 + 10],
    (5, 3): lambda a, b, c, x, y, z: [a, LESSONS[5].pages[1].pose[0]],
    (5, 4): lambda a, b, c, x, y, z: [c, a],
    (6, 1): lambda a, b, c, x, y, z: [b],
    (6, 2): lambda a, b, c, x, y, z: [b, b, TILT],
    (6, 3): lambda a, b, c, x, y, z: [a, a, b],
    (6, 4): lambda a, b, c, x, y, z: [
        *(c, b, c, b),
        *(20, 20, 0, 20 - 20, 40, 0, 0, 40),
        *(20, 20, 20 - 20),
    ],
    (6, 5): lambda a, b, c, x, y, z: [90, ANGLE, TILT, 0, 90],
    (7, 2): lambda a, b, c, x, y, z: [a],
    (7, 3): lambda a, b, c, x, y, z: [a],
    (7, 4): lambda a, b, c, x, y, z: [45, TILT, 20, 45],
    (7, 5): lambda a, b, c, x, y, z: [40, 20, 45],
    (9, 3): lambda a, b, c, x, y, z: [0],
    (9, 4): lambda a, b, c, x, y, z: [c],
    (9, 5): lambda a, b, c, x, y, z: [10],
}
PAGES = [
    pytest.param(page, STATED.get((lesson, number)), id=f"{lesson}.{number}")
    for lesson, content in LESSONS.items()
    for number, page in enumerate(content.pages, start=1)
]


@pytest.mark.parametrize(("page", "stated"), PAGES)
def test_every_figure_is_the_pose_s_or_the_engine_s(
    page: LessonPage, stated: Stated | None
) -> None:
    wanted = [] if stated is None else list(stated(*page.pose))
    assert figures(words_of(page)) == pytest.approx(wanted), page.title


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("a tilt of +30°, −20 and 0.5 mm", [30, -20, 0.5]),
        ("step 1 on the right, steps 2 and 3, k1 and p2", []),
        ("20° − 20° = 0°", [20, 20, 0]),
        ("20° to 45°: 300 px", [20, 45, 300]),
    ],
)
def test_a_figure_is_found(text: str, found: list[float]) -> None:
    assert figures(text) == found


@pytest.fixture(scope="module")
def analyse(paper_camera: Camera, default_board: Board) -> PoseAnalysis:
    return PoseAnalysis(paper_camera, default_board)


def test_the_first_step_says_what_the_words_say(analyse: PoseAnalysis) -> None:
    """Where the words speak of millimetres, step 1 and its label speak of the same ones."""
    seen = 0
    for content in LESSONS.values():
        for page in content.pages:
            if " mm" in page.text:
                told = {abs(figure) for figure in figures(words_of(page))}
                move = analyse(page.pose, "zyx").steps[0]
                label = round(1000 * float(np.linalg.norm(move.translation)))
                assert {*figures(step_prompt(move).camera), label} <= told, page.title
                seen += 1
    assert seen >= 5


def test_what_is_compared_is_told_at_one_distance(analyse: PoseAnalysis) -> None:
    flat, little, good, more, _ = LESSONS[7].pages
    assert len({page.pose[3:] for page in (flat, little, good, more)}) == 1
    sigma = [analyse(page.pose).sigma_px for page in (flat, little, good, more)]
    assert not np.isfinite(sigma[0])
    assert sigma[1] > 4 * sigma[2], "many times better"
    at_45 = analyse((45.0, *more.pose[1:])).sigma_px
    assert 0.9 < sigma[3] / at_45 <= 1, "little left to gain"
    at_20, at_8 = (analyse((tilt, *more.pose[1:])).sigma_px for tilt in (20.0, 8.0))
    assert at_20 < at_8 / 3 and at_20 < 2 * at_45


def test_how_large_the_board_looks(analyse: PoseAnalysis) -> None:
    """More than half of the width and most of the height; then half of both."""

    def size(page: LessonPage) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        taught = analyse(page.pose)
        pixels = taught.camera.project(taught.pose.apply(taught.board.outline))
        return np.ptp(pixels, axis=0)

    near, far = LESSONS[2].pages[2:]
    width, height = size(near) / [1280, 720]
    assert 0.5 < width < 0.75 and 0.6 < height < 1
    assert far.pose[5] == 2 * near.pose[5]
    np.testing.assert_allclose(size(far) / size(near), 0.5, atol=0.01)


def test_small_turns_nearly_swap(analyse: PoseAnalysis) -> None:
    page = LESSONS[5].pages[2]
    order = page.order or ""

    def apart(angle: float) -> float:
        return analyse((angle, angle, *page.pose[2:]), order).apart_deg("order")

    assert apart(page.pose[0]) < 1.5 < 20 < apart(LESSONS[5].pages[1].pose[0])
    assert apart(2 * page.pose[0]) / apart(page.pose[0]) == pytest.approx(4, rel=0.02)

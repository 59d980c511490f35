"""Lesson 10: every figure in its text, by scipy and by axes written down here again."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.lessons.lesson import LessonPage
from venus3d.lessons.reading import shipped_lessons

(LESSON,) = (lesson for lesson in shipped_lessons() if lesson.name.startswith("10-"))


def turn_of(page: LessonPage) -> Rotation:
    return Rotation.from_euler("xyz", page.pose[:3], degrees=True)


def figures(*values: float) -> str:
    """As a text says them: four decimals, a real minus, and 0 alone."""
    texts = ["0" if abs(v) < 5e-5 else f"{v:.4f}".replace("-", "−") for v in values]
    return f"({', '.join(texts)})"


def names(page: LessonPage) -> list[str]:
    """Everything in the page's text that looks like a figure with decimals."""
    return re.findall(r"−?\d+\.\d+", page.text)


def test_the_rotation_vectors() -> None:
    one, two = LESSON.pages[:2]
    assert figures(*turn_of(one).as_rotvec()) in one.text
    assert one.question is not None
    quarter = Rotation.from_euler("z", 90, degrees=True).as_rotvec()
    assert one.question.answers[one.question.right - 1] == figures(*quarter)
    assert set(names(one)) == {f"{np.pi:.4f}", f"{np.radians(30):.4f}"}
    turn = turn_of(two)
    assert figures(*turn.as_rotvec()) in two.text
    assert f"a turn of {np.degrees(turn.magnitude()):.1f}°, not of 60°" in two.text
    assert figures(*np.radians(two.pose[:3])) in two.text
    assert len(set(names(two))) == 4, "no other figure"


def test_the_quaternion() -> None:
    page = LESSON.pages[2]
    w, x, y, z = (
        f"{v:.4f}".replace("-", "−") for v in turn_of(page).as_quat(canonical=True)[[3, 0, 1, 2]]
    )
    assert f"w = {w}, x = {x}, y = {y}, z = {z}" in page.text.replace("\n", " ")
    assert f"{np.degrees(turn_of(page).magnitude()):.1f}°" in page.text
    assert page.question is not None
    tilt = Rotation.from_euler("x", 30, degrees=True).as_quat(canonical=True)  # x y z w
    assert figures(*tilt)[1:-1] in page.question.text
    assert page.question.answers[page.question.right - 1] == "Last"
    assert f"The cosine of 15° is {np.cos(np.radians(15)):.4f}" in page.question.why


@pytest.mark.parametrize(
    "row, right, down, ahead",
    [
        ("OpenCV", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ("OpenGL", (1, 0, 0), (0, -1, 0), (0, 0, -1)),
        ("ROS body", (0, -1, 0), (0, 0, -1), (1, 0, 0)),
    ],
)
def test_the_axes(
    row: str, right: tuple[int, ...], down: tuple[int, ...], ahead: tuple[int, ...]
) -> None:
    page = LESSON.pages[3]
    rename = np.stack([right, down, ahead], axis=1)
    arrow = rename @ np.degrees(turn_of(page).as_rotvec())
    axis = int(np.argmax(np.abs(arrow)))
    swing = f"{arrow[axis]:+.0f}° about {'xyz'[axis]}".replace("-", "−")
    place = ", ".join(f"{v:.0f}".replace("-", "−") for v in rename @ np.array(page.pose[3:]))
    assert f"| {row} | {swing} | {place} |" in page.text.replace("\N{NO-BREAK SPACE}", " ")


def test_the_last_pose_is_one_turn() -> None:
    page = LESSON.pages[4]
    assert f"a single turn of {np.degrees(turn_of(page).magnitude()):.1f}°" in page.text

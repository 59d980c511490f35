"""A lesson as one file, opened from the disk in a browser without a network.

Holds down: a player that fetches something, or a recording that the player does not take, leaves
an empty frame in the very classroom that has no network. On a phone the scene was cut at its sides,
and the player's notice about slow graphics covered the board.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.lesson import Lesson, LessonPage, Question
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach.export.files import export_files
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.scene_recording import ASPECT

pytestmark = pytest.mark.browser

_LESSON = Lesson(
    "two",
    "Two pages </script>",
    "What is <b>marked</b> stays text",
    (
        LessonPage("First", "Some **bold** words.", (25, -30, 20, 40, -20, 520)),
        LessonPage(
            "Second",
            "Less.",
            (0, 35, 0, 0, 0, 500),
            question=Question("Which?", ("this", "that"), 2, "Because of it."),
        ),
    ),
)
_TIME = "() => document.querySelector('[role=slider]')?.ariaValueNow ?? null"


@pytest.fixture(scope="module")
def file(
    tmp_path_factory: pytest.TempPathFactory, paper_camera: Camera, default_board: Board
) -> Path:
    file = tmp_path_factory.mktemp("export") / "lesson.html"
    with Offscreen("painter") as offscreen:
        study = PoseAnalysis(paper_camera, default_board)
        (content,) = export_files(_LESSON, "html", study, offscreen)
    file.write_bytes(content)
    return file


@pytest.fixture
def page(chromium: Any, file: Path) -> Iterator[tuple[Any, list[str]]]:
    """The exported file in a tab that has no network, and what went wrong in it."""
    context = chromium.new_context(viewport={"width": 1280, "height": 720}, offline=True)
    tab, wrong = context.new_page(), list[str]()
    tab.on("pageerror", lambda error: wrong.append(str(error)))
    tab.on("requestfailed", lambda request: wrong.append(f"failed: {request.url[:80]}"))
    tab.on(
        "request",
        lambda request: (
            None
            if request.url.startswith((file.as_uri(), "data:", "blob:"))
            else wrong.append(f"asked for: {request.url[:80]}")
        ),
    )
    tab.set_default_timeout(60_000)
    tab.goto(file.as_uri())
    yield tab, wrong
    context.close()


def _plays(tab: Any) -> float:
    """Wait until the scene's time has gone on twice; the recording's length in seconds."""
    frame = tab.query_selector("#scene").content_frame()
    frame.wait_for_selector("[role=slider]", state="attached")
    for _ in range(2):
        now = frame.evaluate(_TIME)
        frame.wait_for_function(f"now => ({_TIME})() !== now", arg=now)
    return float(frame.evaluate("() => document.querySelector('[role=slider]').ariaValueMax"))


def test_all_of_the_scene_is_seen_in_every_window(page: tuple[Any, list[str]]) -> None:
    tab, _ = page
    frame = tab.query_selector("#scene").content_frame()
    frame.wait_for_selector("canvas")
    for width, height in ((1920, 1080), (420, 860), (1000, 1600), (1280, 720)):
        tab.set_viewport_size({"width": width, "height": height})
        # The view was made for a window of this shape or a wider one.
        frame.wait_for_function(
            "least => { const box = document.querySelector('canvas').getBoundingClientRect();"
            " return box.height > 150 && box.width / box.height > least; }",
            arg=ASPECT,
        )
        assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth"), (width, height)
    notice = frame.wait_for_selector("text=Software WebGL", state="attached")
    assert not notice.is_visible()


def test_an_exported_lesson_opens_and_plays_without_a_network(page: tuple[Any, list[str]]) -> None:
    tab, wrong = page
    assert tab.inner_text("h1") == "Two pages </script>"
    assert "<b>marked</b>" in tab.inner_text("header p")
    assert tab.inner_text("article:not([hidden]) strong >> nth=0") == "bold"
    sizes = (
        "() => [...document.querySelectorAll('article:not([hidden]) img')].map(i => i.naturalWidth)"
    )
    assert [width > 300 for width in tab.evaluate(sizes)] == [True] * 4
    four_steps = _plays(tab)

    tab.click("article:not([hidden]) button[data-go='1']")
    assert tab.inner_text("article:not([hidden]) h2") == "Second"
    assert tab.is_disabled("article:not([hidden]) button[data-go='1']")
    assert [width > 300 for width in tab.evaluate(sizes)] == [True] * 4
    assert _plays(tab) < four_steps  # one step only: another recording, not the first one again
    tab.click("text=this")
    assert "✕" in tab.inner_text(".question:visible [data-verdict]:not([hidden])")
    tab.click("text=that")
    assert "✓" in tab.inner_text(".question:visible [data-verdict]:not([hidden])")
    # viser also prepares for splats, which no scene of ours has; its way to do so is refused.
    assert [what for what in wrong if "Evaluating a string" not in what] == []

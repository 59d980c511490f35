"""The teaching page in a real browser: keys, sliders, play, lessons."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from tests.browser.keyboard import pressed
from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.reading import shipped_lessons
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import Answer, FileKind, PageAction, after_action
from venus3d.scene.pages.teach.controls import HOTKEYS
from venus3d.scene.pages.teach.state import FREE_VECTOR, TeachState
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.pages.teach.viewer import TeachViewer

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def teaching(paper_camera: Camera, default_board: Board) -> Iterator[TeachViewer]:
    saved: list[str] = []

    def save(state: TeachState, kind: FileKind) -> tuple[str, bytes]:
        saved.append(kind)
        if kind == "gif":
            raise StorageError("No film today; come again tomorrow.")
        return f"pose.{kind}", b"content"

    with Offscreen("painter") as offscreen:
        viewer = TeachViewer(
            PoseAnalysis(paper_camera, default_board),
            offscreen,
            paper_camera,
            port=free_port(),
            lessons=shipped_lessons(),
            save=save,
            kinds=("html", "gif"),
        )
        yield viewer
        viewer.close()


@pytest.fixture(scope="module")
def page(chromium: Any, teaching: TeachViewer) -> Iterator[Any]:
    tab = chromium.new_page(viewport={"width": 1280, "height": 720})
    tab.set_default_timeout(60_000)
    tab.goto(teaching.url)
    tab.wait_for_selector(".v-now")
    yield tab
    tab.close()


def sources(page: Any) -> list[str]:
    """Where the pictures come from; another picture is another address."""
    return [str(image.get_attribute("src")) for image in page.locator("img").all()]


def changed(page: Any, before: list[str]) -> int:
    """How many pictures are others now."""
    return sum(source not in before for source in sources(page))


def test_every_hotkey_does_what_its_action_does(teaching: TeachViewer, page: Any) -> None:
    """The state's own tests say what an action does; here, that each key asks for its own."""
    lessons = teaching.state.lessons
    asking = next(
        (lesson, number)
        for lesson in range(len(lessons))
        for number, shown in enumerate(lessons[lesson].pages)
        if shown.question is not None and len(shown.question.answers) >= 3
    )
    for action, key in HOTKEYS.items():
        before = teaching.change(lambda state: state.opened(*asking).carried_to(0.3))
        if key is None or action in (Answer(4), Answer(5)):
            continue  # by name only; no question has so many
        wanted = after_action(before, action)
        page.keyboard.press(pressed(key))
        if action in (PageAction.PLAY, PageAction.NEXT_STEP):
            wait_until(lambda: teaching.state.playing, str(action))
        else:
            wait_until(lambda wanted=wanted: teaching.state == wanted, str(action))
    # Neither loop nor speed is left on for the next test.
    teaching.change(lambda state: TeachState(lessons=lessons).opened(None))


def test_a_slider_moves_scene_words_and_both_pictures(teaching: TeachViewer, page: Any) -> None:
    teaching.change(lambda state: state.opened(None))
    page.wait_for_selector(f"text={texts.THERE_HEADLINE}")
    before = sources(page)
    # Y is the second of the six number fields.
    field = page.locator("input[type=text], input[inputmode]").filter(visible=True)
    fields = [f for f in field.all() if f.input_value() == f"{FREE_VECTOR[1]:g}"]
    fields[0].fill("-80")
    fields[0].press("Enter")
    wait_until(lambda: teaching.state.vector[1] == -80, "the number arrives")
    page.wait_for_selector(".v-now:has-text('Step 3 of 4: Swing about Y')")
    page.wait_for_selector(".v-now i:has-text('−80°')")
    page.wait_for_selector(f".v-refused:has-text('{texts.REFUSED}')")
    wait_until(lambda: "/target/refused" in teaching.scene_names, "the board is tinted")
    wait_until(lambda: changed(page, before) >= 2, "both pictures change")
    page.evaluate("document.activeElement.blur()")


def test_play_counts_up_and_ends_at_the_pose(teaching: TeachViewer, page: Any) -> None:
    teaching.change(lambda state: state.opened(None))
    page.wait_for_selector(f"text={texts.THERE_HEADLINE}")
    page.keyboard.press("Space")
    page.wait_for_selector(".v-now:has-text('Step 2 of 4')")
    page.wait_for_selector(".v-now small:has-text('of +25°')")
    page.wait_for_selector(".v-now:has-text('Step 4 of 4')")
    page.wait_for_selector(f"text={texts.THERE_HEADLINE}")
    assert teaching.state.at_rest and not teaching.state.playing


def test_lessons_switch_and_answers_are_judged(teaching: TeachViewer, page: Any) -> None:
    lessons = teaching.state.lessons
    teaching.change(lambda state: state.opened(None))
    page.keyboard.press("Shift+PageDown")
    page.wait_for_selector(f"h2:has-text('{lessons[0].pages[0].title}')")
    number = next(i for i, shown in enumerate(lessons[0].pages) if shown.question is not None)
    for _ in range(number):
        page.keyboard.press("PageDown")
    page.wait_for_selector(f"h2:has-text('{lessons[0].pages[number].title}')")
    question = lessons[0].pages[number].question
    assert question is not None
    wrong = 1 if question.right != 1 else 2
    page.keyboard.press(str(wrong))
    page.wait_for_selector(f".v-refused:has-text('{texts.WRONG}')")
    page.locator("button", has_text=question.answers[question.right - 1]).click()
    page.wait_for_selector(f".v-refused:has-text('{texts.RIGHT}')")


def test_a_file_goes_to_the_tab_that_asked(page: Any) -> None:
    with page.expect_download() as download:
        page.locator("button", has_text=texts.SAVE_LABELS["html"]).click()
    assert download.value.suggested_filename == "pose.html"


def test_a_file_that_cannot_be_made_is_told_and_nothing_seems_to_go_on(page: Any) -> None:
    page.locator("button", has_text=texts.SAVE_LABELS["gif"]).click()
    page.wait_for_selector("text=No film today; come again tomorrow.")
    page.wait_for_selector("text=the file is being made", state="detached")

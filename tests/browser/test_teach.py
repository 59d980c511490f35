"""The teaching page in a real browser: keys, sliders, play, lessons."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from tests.browser.keyboard import pressed
from tests.scene.teach_server import ServedTeaching, served_teaching
from tests.waiting import wait_until
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.lessons.reading import shipped_lessons
from venus3d.render.offscreen import Offscreen
from venus3d.scene.pages.teach import texts
from venus3d.scene.pages.teach.actions import Answer, Arrange, FileKind, PageAction, after_action
from venus3d.scene.pages.teach.controls import HOTKEYS
from venus3d.scene.pages.teach.state import FREE_VECTOR, TeachState
from venus3d.scene.pages.teach.view_model import PoseAnalysis
from venus3d.scene.web.keys import KEYS

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture(scope="module")
def teaching(paper_camera: Camera, default_board: Board) -> Iterator[ServedTeaching]:
    def save(state: TeachState, kind: FileKind) -> tuple[str, bytes]:
        if kind == "gif":
            raise StorageError("No film today; come again tomorrow.")
        return f"pose.{kind}", b"content"

    with (
        Offscreen("painter") as offscreen,
        served_teaching(
            PoseAnalysis(paper_camera, default_board),
            offscreen,
            lessons=shipped_lessons(),
            save=save,
            kinds=("html", "gif"),
            follow_me=True,
        ) as served,
    ):
        yield served


def opened(chromium: Any, teaching: ServedTeaching) -> Any:
    tab = chromium.new_page(viewport={"width": 1280, "height": 720})
    tab.set_default_timeout(60_000)
    tab.goto(teaching.url)
    tab.wait_for_selector(".v-now")
    return tab


@pytest.fixture(scope="module")
def page(chromium: Any, teaching: ServedTeaching) -> Iterator[Any]:
    tab = opened(chromium, teaching)
    yield tab
    tab.close()


def sources(page: Any) -> list[str]:
    """Where the pictures come from; another picture is another address. The cards' pictures are
    those that a style sheet puts behind them."""
    return list(
        page.evaluate(
            "[...document.querySelectorAll('img')].map((image) => image.src).concat("
            "[...document.querySelectorAll('.v-shot')].map("
            "(place) => getComputedStyle(place).backgroundImage))"
        )
    )


def changed(page: Any, before: list[str]) -> int:
    """How many pictures are others now."""
    return sum(source not in before for source in sources(page))


def test_every_hotkey_does_what_its_action_does(teaching: ServedTeaching, page: Any) -> None:
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
        if key is None or action in (Answer(4), Answer(5), PageAction.MENU):
            continue  # by name only; no question has so many; the menu has a test of its own
        wanted = after_action(before, action)
        page.keyboard.press(pressed(key))
        if action in (PageAction.PLAY, PageAction.NEXT_STEP):
            wait_until(lambda: teaching.state.playing, str(action))
        else:
            wait_until(lambda wanted=wanted: teaching.state == wanted, str(action))
    # Neither loop nor speed is left on for the next test.
    teaching.change(lambda state: TeachState(lessons=lessons).opened(None))


def test_a_slider_moves_scene_words_and_both_pictures(teaching: ServedTeaching, page: Any) -> None:
    teaching.change(lambda state: state.opened(None))
    page.wait_for_selector(f"text={texts.THERE_HEADLINE}")
    before = sources(page)
    # Y is the second of the six number fields.
    field = page.locator("input[type=text], input[inputmode]").filter(visible=True)

    def fields() -> list[Any]:
        return [f for f in field.all() if f.input_value() == f"{FREE_VECTOR[1]:g}"]

    wait_until(fields, "the number's field is there")
    field_of_y = fields()[0]
    field_of_y.fill("-80")
    field_of_y.press("Enter")
    wait_until(lambda: teaching.state.vector[1] == -80, "the number arrives")
    page.wait_for_selector(".v-now:has-text('Step 3 of 4: Swing about Y')")
    page.wait_for_selector(".v-now i:has-text('−80°')")
    page.wait_for_selector(f".v-refused:has-text('{texts.REFUSED}')")
    wait_until(lambda: "/target/refused" in teaching.page().scene_names, "the board is tinted")
    wait_until(lambda: changed(page, before) >= 2, "both pictures change")
    page.evaluate("document.activeElement.blur()")


def test_play_counts_up_and_ends_at_the_pose(teaching: ServedTeaching, page: Any) -> None:
    teaching.change(lambda state: state.opened(None))
    page.wait_for_selector(f"text={texts.THERE_HEADLINE}")
    # In a loop: a browser that stands still for a moment sees the step in the next round.
    teaching.change(lambda state: replace(state, loop=True))
    page.keyboard.press("Space")
    page.wait_for_selector(".v-now:has-text('Step 2 of 4')")
    page.wait_for_selector(".v-now small:has-text('of +25°')")
    page.wait_for_selector(".v-now:has-text('Step 4 of 4')")
    teaching.change(lambda state: replace(state, loop=False))
    page.wait_for_selector(f"text={texts.THERE_HEADLINE}")
    assert teaching.state.at_rest and not teaching.state.playing


def test_lessons_switch_and_answers_are_judged(teaching: ServedTeaching, page: Any) -> None:
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


def choose(page: Any, text: str) -> None:
    """Choose from the menu."""
    page.locator("button", has_text=texts.LABELS[PageAction.MENU].split()[1]).first.click()
    page.locator(".mantine-Modal-content button", has_text=text).click()
    page.wait_for_selector(".mantine-Modal-content", state="detached")


def test_a_file_goes_to_the_tab_that_asked(page: Any) -> None:
    with page.expect_download() as download:
        choose(page, texts.SAVE_LABELS["html"])
    assert download.value.suggested_filename == "pose.html"


def test_a_file_that_cannot_be_made_is_told_and_nothing_seems_to_go_on(page: Any) -> None:
    choose(page, texts.SAVE_LABELS["gif"])
    page.wait_for_selector("text=No film today; come again tomorrow.")
    page.wait_for_selector("text=the file is being made", state="detached")


def test_the_menu_opens_and_closes_by_key_and_compares(teaching: ServedTeaching, page: Any) -> None:
    for closing in (pressed(KEYS["menu"]), "Escape"):
        page.keyboard.press(pressed(KEYS["menu"]))
        page.wait_for_selector(".mantine-Modal-content")
        page.keyboard.press(closing)
        page.wait_for_selector(".mantine-Modal-content", state="detached")
    teaching.change(lambda state: state.opened(None))
    choose(page, texts.LABELS[Arrange("axes")])
    wait_until(lambda: teaching.state.arrangement == "axes", "the boards side by side")
    teaching.change(lambda state: state.opened(None))


def test_a_second_tab_follows_reads_only_and_is_let_go(
    chromium: Any, teaching: ServedTeaching, page: Any
) -> None:
    """Once one click or answer appeared for everybody."""
    lessons = teaching.state.lessons
    pupil = opened(chromium, teaching)
    try:
        pupil.wait_for_selector(f"text={texts.FOLLOWS}")
        page.wait_for_selector(f"text={texts.LEADS_ONE}")
        page.keyboard.press(pressed(KEYS["next_lesson"]))
        pupil.wait_for_selector(f"h2:has-text('{lessons[0].pages[0].title}')")
        pupil.keyboard.press(pressed(KEYS["next_page"]))
        assert pupil.locator("[role=slider][aria-disabled=true], input:disabled").count() >= 7
        teaching.change(lambda state: state.carried_to(0.3))
        pupil.wait_for_selector(".v-now:has-text('Step 2 of 4')")
        first = teaching.server.tabs[0].client.camera
        first.position, first.look_at = (0.3, -0.9, -0.6), (0.0, 0.0, 0.5)
        theirs = teaching.server.tabs[1].client.camera
        wait_until(lambda: abs(theirs.position - first.position).max() < 0.01, "the same view")
        page.locator("button", has_text=texts.LET_GO).click()
        pupil.wait_for_selector(f"text={texts.FOLLOWS}", state="detached")
        pupil.keyboard.press(pressed(KEYS["next_page"]))
        wait_until(lambda: teaching.learner(1).state.page == 1, "it goes its own way")
        assert teaching.state.page == 0
    finally:
        pupil.close()

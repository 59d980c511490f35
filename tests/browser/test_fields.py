"""Keys work after a field was used, and while one has them the page says so.

A browser sends keys to the element with the focus, and a list, a number field or a tick keeps it
after it was used: K or space then did nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.scene.web.texts import TYPING

pytestmark = [pytest.mark.browser, pytest.mark.slow]

NOTHING = "nothing"
NUMBERS = "input.mantine-NumberInput-input"


@pytest.fixture
def page(start: Callable[..., Any], chromium: Any, tmp_path: Any) -> Any:
    """A practice page on level 6, on which everything may be changed."""
    program = start("practice", "--output", str(tmp_path), "--port", str(free_port()))
    tab = chromium.new_page(viewport={"width": 1366, "height": 900})
    tab.set_default_timeout(30_000)
    tab.goto(program.url)
    tab.wait_for_selector(".v-do")
    tab.keyboard.press("6")
    tab.wait_for_selector(".v-do:has-text('everything has to change')")
    yield tab
    tab.close()


def move_right(page: Any, after: str) -> None:
    """The key L reaches the page."""
    if after != NOTHING:  # a browser's own listeners take a moment on a busy machine
        page.wait_for_function("document.activeElement === document.body")
    right = page.locator(NUMBERS).nth(3)
    before = float(right.input_value())
    page.keyboard.press("l")
    wait_until(lambda: float(right.input_value()) > before, f"L moves the board after {after}")


def test_keys_are_the_pages_again_when_a_field_is_done_with(page: Any) -> None:
    note = page.locator(".v-typing:not([hidden])")
    move_right(page, NOTHING)
    assert note.count() == 0
    # A choice from a list.
    page.locator("input.mantine-Select-input").nth(1).click()
    page.locator("[role=option]:visible").nth(1).click()
    move_right(page, "a choice")
    # A tick.
    page.locator("input[type=checkbox]").first.click()
    move_right(page, "a tick")
    # A number: a key that it cannot contain, Enter, Esc.
    turn = page.locator(NUMBERS).first
    for end in (NOTHING, "Enter", "Escape"):
        turn.click()
        turn.fill("12")
        assert note.inner_text() == TYPING
        if end != NOTHING:
            page.keyboard.press(end)
        move_right(page, end)
        assert note.count() == 0
    # A name takes letters, until Enter.
    name = page.locator("input.mantine-TextInput-input").first
    name.click()
    page.keyboard.type("Lil")
    assert name.input_value() == "Lil" and note.inner_text() == TYPING
    page.keyboard.press("Enter")
    move_right(page, "a name")
    assert name.input_value() == "Lil" and note.count() == 0


def test_a_number_may_have_a_comma(page: Any) -> None:
    """12,5 was read as 125 where it came at once: pasted, dictated, filled in."""
    turn = page.locator(NUMBERS).first
    turn.click()
    turn.fill("")
    page.keyboard.insert_text("12,5")
    page.keyboard.press("Enter")
    wait_until(lambda: turn.input_value() == "12.5", "a comma is a point")


def test_a_folder_is_unfolded_by_keys_too(page: Any) -> None:
    """Some of what a page has was out of reach without a mouse."""
    folder = page.locator("[role=button]", has_text="Move the board with sliders")
    slider = page.locator("[role=slider]").first
    slider.wait_for(state="visible")
    before = page.inner_text(".v-do")
    for _ in range(60):
        page.keyboard.press("Tab")
        if "sliders" in page.evaluate("document.activeElement.innerText").split("\n")[0]:
            break
    assert folder.evaluate("e => e === document.activeElement")
    for key, state in (("Enter", "hidden"), ("Space", "visible")):
        page.keyboard.press(key)
        slider.wait_for(state=state)
    assert page.inner_text(".v-do") == before, "the page's own key is not meant"

"""Every dialog of every page, gone through with the mouse: nothing lies over its buttons.

The scene covered the fourth page of the tour: it was raised to be marked, and took the clicks. Here
the mouse presses where a button is seen, whatever lies there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.browser.conftest import Program
from tests.browser.keyboard import press_until
from tests.browser.test_uncertainty import on_screen
from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import texts as guide_texts
from venus3d.scene.pages.guide.uncertainty import texts as known_texts
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web import texts

pytestmark = pytest.mark.browser

DIALOG = ".mantine-Modal-content"
COVERED = """() => [...document.querySelectorAll('.mantine-Modal-content button')].filter(b => {
    const r = b.getBoundingClientRect(), x = r.x + r.width / 2, y = r.y + r.height / 2;
    const seen = r.width > 0 && y < innerHeight && x < innerWidth;
    return seen && !b.contains(document.elementFromPoint(x, y));
}).map(b => b.innerText)"""


def press(page: Any, name: str) -> None:
    """Move the mouse to this button of the dialog and press it; no other one is covered either."""
    button = page.locator(DIALOG).get_by_role("button", name=name, exact=True)
    button.scroll_into_view_if_needed()
    page.wait_for_timeout(250)  # the dialog slides in
    assert page.evaluate(COVERED) == []
    box = button.bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)


def closed(page: Any) -> None:
    page.wait_for_selector(DIALOG, state="detached")


def test_the_tour_is_walked_there_and_back_with_the_mouse(chromium: Any) -> None:
    """To its end on a large screen; back, and away from the page about the scene, on a phone."""
    viewer = Viewer(port=free_port(), tour=True)
    count, pages = len(guide_texts.TOUR), [chromium.new_page() for _ in range(2)]

    def at(page: Any, number: int) -> None:
        page.wait_for_selector(f".v-tour[data-step='{number}']")

    try:
        for page, (width, height) in zip(pages, ((1920, 1080), (420, 860)), strict=True):
            page.set_viewport_size({"width": width, "height": height})
            page.goto(viewer.url)
            at(page, 1)
            # Nothing is before the first step.
            assert page.get_by_role("button", name=texts.TOUR_BACK, exact=True).count() == 0
            for number in range(1, count):
                at(page, number)
                press(page, texts.TOUR_NEXT)
            at(page, count)
        large, phone = pages
        press(large, texts.TOUR_END)
        closed(large)
        press(phone, texts.TOUR_BACK)
        at(phone, count - 1)
        press(phone, texts.TOUR_SKIP)
        closed(phone)
    finally:
        for page in pages:
            page.close()
        viewer.close()


def test_the_guides_help_and_the_card_of_a_view(
    viewer: Viewer, open_page: Callable[[], Any], guided: Snapshot
) -> None:
    viewer.show(replace(guided, target=None, match=None, remaining=None, pose=None))
    page = open_page()
    page.keyboard.press("Shift+V")
    wait_until(lambda: "/views/2/sheet" in viewer.scene_names, "the views stand in the scene")
    page.wait_for_timeout(1000)  # viser's picture follows its messages by a frame or two
    page.keyboard.press("h")
    page.wait_for_selector(f"{DIALOG} .v-keys")
    press(page, texts.HELP_CLOSE)
    closed(page)
    at = guided.views[1].pose.t
    for name in (known_texts.CLOSE_VIEW, known_texts.LEAVE_OUT):
        page.mouse.click(*on_screen(viewer, page, at))
        page.wait_for_selector(f"{DIALOG} .v-view")
        press(page, name)
        closed(page)
    wait_until(lambda: bool(viewer.drain_intents()), "the view is left out")


@pytest.mark.parametrize(
    "command",
    ["teach", "practice --output {folder}", "trial sim --camera-size 640x360 --output {folder}"],
)
def test_the_help_of_the_other_pages(
    chromium: Any, start: Callable[..., Program], command: str, tmp_path: Path
) -> None:
    program = start(*command.format(folder=tmp_path).split(), "--port", str(free_port()))
    page = chromium.new_page(viewport={"width": 1366, "height": 768})
    try:
        page.goto(program.url)
        page.wait_for_selector("canvas")
        press_until(page, "h", f"{DIALOG} .v-keys")
        press(page, texts.HELP_CLOSE)
        closed(page)
    finally:
        page.close()

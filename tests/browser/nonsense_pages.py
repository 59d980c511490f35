"""The pages with all texts replaced by the same nonsense: each control still does what it is for.

`test_nonsense.py` runs this file in a process of its own, in which `nonsense` comes before all
pages. Buttons and entries are therefore found by their places; what they do is seen in the state.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.waiting import wait_until
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import intents, texts
from venus3d.scene.pages.guide.control_panel import CONTROLS
from venus3d.scene.pages.guide.uncertainty.maps import MAP_KINDS
from venus3d.scene.pages.guide.viewer import Viewer

pytestmark = [pytest.mark.browser, pytest.mark.slow]

Press = Callable[[], object]
ROW = ".mantine-Flex-root:has(> .mantine-Button-root)"
KEYS = {"space": "Space", "escape": "Escape"}


def test_the_texts_are_nonsense() -> None:
    assert texts.CAPTURE == texts.METHOD == "Blah"


def button(page: Any, row: int, place: int, within: str = "") -> Press:
    """Press a button by the place of its row, and its own in the row."""
    buttons = page.locator(f"{within} {ROW}:visible").nth(row).locator(".mantine-Button-root")
    return buttons.nth(place).click


def key(page: Any, hotkey: str) -> Press:
    return lambda: page.keyboard.press(KEYS.get(hotkey, hotkey.lower()))


def command(page: Any, place: int) -> Press:
    """Choose from the palette, by the place in its list."""

    def press() -> None:
        page.locator("button:has(.tabler-icon-list-search)").click()
        page.locator(".mantine-Spotlight-action").nth(place).click()
        page.wait_for_selector(".mantine-Spotlight-action", state="detached")

    return press


def entry(page: Any, choice: int, place: int, within: str = "") -> Press:
    """Choose from a list, by the list's place and the entry's."""

    def press() -> None:
        page.locator(f"{within} input.mantine-Select-input:visible").nth(choice).click()
        page.locator("[role=option]:visible").nth(place).click()

    return press


def hotkeys(server: Any) -> list[Any]:
    """Of all commands of a page, in the palette's order; None: it has no key."""
    return [command.hotkey for command in server.gui._command_handle_from_uuid.values()]


def does(viewer: Viewer, press: Press, wanted: intents.Intent) -> None:
    """Pressing does this, and asks the session for nothing else."""
    viewer.drain_intents()
    before = viewer.state
    press()
    asked: list[intents.Intent] = []

    def done() -> bool:
        asked.extend(viewer.drain_intents())
        if isinstance(wanted, intents.TurnStep):
            return viewer.state.step == min(max(before.step + wanted.by, 1), 4)
        if isinstance(wanted, intents.Toggle):
            return getattr(viewer.state, wanted.option) != getattr(before, wanted.option)
        return wanted in asked

    wait_until(done, f"{wanted}; asked for {asked}")
    assert set(asked) <= {wanted}, asked


def becomes(shown: Any, name: str, value: object) -> None:
    """What is shown, a page or a panel, comes to have this in its state."""
    wait_until(lambda: getattr(shown.state, name) == value, f"{name} is {value}: {shown.state}")


GUIDE_ROWS = (
    ("skip", "undo", "finish"),
    ("previous", "play", "next"),
    ("follow", "strip", "theme"),
    ("pause", "autopilot"),
)


def test_guide(viewer: Viewer, open_page: Callable[[], Any], guiding: Snapshot) -> None:
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector("[data-marked='3']", state="attached")
    does(viewer, page.locator("button:has(.icon-tabler-camera)").click, intents.Capture())
    for row, names in enumerate(GUIDE_ROWS):
        for place, name in enumerate(names):
            does(viewer, button(page, row, place), CONTROLS[name][0])
    for intent, hotkey in CONTROLS.values():
        if hotkey is not None:
            does(viewer, key(page, hotkey), intent)
    known = hotkeys(viewer.server)
    for intent, hotkey in CONTROLS.values():
        if hotkey is not None:
            does(viewer, command(page, known.index(hotkey)), intent)


def test_help_and_tour(viewer: Viewer, open_page: Callable[[], Any], guiding: Snapshot) -> None:
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector(".v-chip")
    row = len(GUIDE_ROWS)
    button(page, row, 0)()
    page.wait_for_selector(".v-keys")
    page.locator(".mantine-Modal-body .mantine-Button-root").click()
    page.wait_for_selector(".v-keys", state="detached")
    button(page, row, 1)()
    page.wait_for_selector(".v-tour[data-step='1']")
    forth = page.locator(".mantine-Modal-body .mantine-Button-root").first
    for number in (2, 3):
        forth.click()
        page.wait_for_selector(f".v-tour[data-step='{number}']")
    button(page, 0, 0, ".mantine-Modal-body")()
    page.wait_for_selector(".v-tour[data-step='2']")
    button(page, 0, 1, ".mantine-Modal-body")()
    page.wait_for_selector(".v-tour", state="detached")


def test_method_lists(viewer: Viewer, open_page: Callable[[], Any], guiding: Snapshot) -> None:
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector(".v-chip")
    page.locator(".tabler-icon-chevron-down:visible").last.click()
    for place, method in enumerate(texts.METHOD_WORDS):
        if method != guiding.method:
            does(viewer, entry(page, 0, place), intents.ChangeMethod(method, None))
    does(viewer, entry(page, 1, 2), intents.ChangeMethod(method, list(texts.COST_WORDS)[2]))


def test_uncertainty(viewer: Viewer, open_page: Callable[[], Any], guiding: Snapshot) -> None:
    viewer.show(guiding)
    page = open_page()
    page.locator("[role=tab]:has(.icon-tabler-map-2)").click()
    panel: Any = viewer.layers[0]
    tab = "[data-dock-leaf]:has([data-panel=uncertainty])"
    page.wait_for_selector(f"{tab} {ROW}")
    for place in (1, 2, 3, 4, 0):
        button(page, 0, place, tab)()
        becomes(panel, "map", MAP_KINDS[place])
    for place, name in enumerate(("views", "search")):
        before = getattr(panel.state, name)
        button(page, 1, place, tab)()
        becomes(panel, name, not before)
    numbers = [None, *(view.number for view in guiding.views)]
    for place in (1, 0):
        entry(page, 0, place, tab)()
        becomes(panel, "view", numbers[place])

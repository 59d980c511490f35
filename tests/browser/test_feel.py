"""The page for those who do not know it yet: everything is explained, readable, and on a key.

Contrast is read from what the browser has computed, viser's own widgets included.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.browser.keyboard import hotkeys, pressed
from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide import intents
from venus3d.scene.pages.guide import texts as say
from venus3d.scene.pages.guide.control_panel import useful_in
from venus3d.scene.pages.guide.method_panel import OFFERED
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.board_keys import BOARD_KEYS

pytestmark = [pytest.mark.browser, pytest.mark.slow]

Open = Callable[[], Any]
SEEN = Path(__file__).with_name("seen.js").read_text(encoding="utf-8")
TABS = (say.PROGRESS_TAB, say.PARAMETERS_TAB)


def inputs_of(viewer: Viewer) -> Iterator[Any]:
    """Every control that a person can change or press; viser tells of them nowhere else."""
    gui: Any = viewer.server.gui
    for handle in gui._gui_input_handle_from_uuid.values():
        if hasattr(handle, "hint"):
            yield handle


def test_every_control_explains_itself(viewer: Viewer) -> None:
    """What has no tooltip must be guessed at."""
    controls = list(inputs_of(viewer))
    assert len(controls) > 8, "the walk finds the page's controls"
    # The field into which the page writes its window's height is not seen; the film strip's hint is
    # in its frame, since viser's would stand in the middle of the scene.
    seen = [c for c in controls if c.label and c.label != say.FILM_ROW[0]]
    assert say.FILM_ROW[1] in viewer.view._film._frame.content  # pyright: ignore
    silent = [c.label for c in seen if not c.hint or len(c.hint) < 15]
    assert not silent, f"without a tooltip: {silent}"


def test_every_button_is_a_command_too(viewer: Viewer) -> None:
    """Whoever works by keyboard finds each action in the list of commands, explained."""
    gui: Any = viewer.server.gui
    commands = {c.label: c for c in gui._command_handle_from_uuid.values()}
    assert all(c.description for c in commands.values())
    for action in say.BUTTONS.keys() - {"help", "tour", "fit"}:
        assert say.COMMANDS[action][0] in commands, action
    for words in (say.METHOD_WORDS[method] for method in OFFERED):
        assert any(words in label for label in commands), words
    assert {say.OTHER_COMMANDS[0], say.OTHER_COMMANDS[2]} <= commands.keys()
    keys = [key for key in hotkeys(gui) if key not in (None, "escape")]
    assert len(keys) == len(set(keys)), "two commands on one key"
    assert not set("WASDQE") & set(keys), "these fly the browser's camera"


def test_every_key_does_what_the_help_says(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """Each key of the page once, each by an effect that can be seen from outside."""
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector(".v-title:has-text('Step 3 of 4')")
    asked: list[intents.Intent] = []

    def asks(wanted: type) -> Callable[[], bool]:
        def came() -> bool:
            asked.extend(viewer.drain_intents())
            return any(isinstance(intent, wanted) for intent in asked)

        return came

    def asks_for(action: intents.PageAction) -> Callable[[], bool]:
        return lambda: asks(intents.PageAction)() and action in asked

    def asks_to_switch(option: intents.Option) -> Callable[[], bool]:
        return lambda: asks(intents.Toggle)() and intents.Toggle(option) in asked

    def shows(selector: str, count: int = 1) -> Callable[[], bool]:
        return lambda: page.locator(selector).count() == count

    knowledge: Any = viewer.layers[0]
    before, state = knowledge.state, viewer.state

    def asks_to_move(number: int, sign: int) -> Callable[[], bool]:
        move = intents.NudgeBoard(number, sign)
        return lambda: asks(intents.NudgeBoard)() and move in asked

    effects: dict[str, Callable[[], bool]] = {
        "N": shows(".v-title:has-text('Step 4 of 4')"),
        "P": shows(".v-title:has-text('Step 3 of 4')"),
        "F": lambda: viewer.state.follow,
        "shift+space": lambda: viewer.state.playing,
        "T": lambda: any(name.startswith("/strip/") for name in viewer.scene_names),
        "B": shows("[data-mantine-color-scheme='light']"),
        "C": asks_for(intents.PageAction.CAPTURE),
        "G": asks_for(intents.PageAction.SKIP_TARGET),
        "backspace": asks_for(intents.PageAction.UNDO_VIEW),
        **{number: asks(intents.ChooseAlternative) for number in "123"},
        "shift+P": asks_to_switch("autopilot"),
        "M": lambda: knowledge.state.map != before.map,
        "shift+V": lambda: knowledge.state.views != before.views,
        "shift+N": lambda: knowledge.state.view is not None,
        "shift+G": lambda: knowledge.state.search != before.search,
        "X": lambda: viewer.state.camera_words,
        "shift+R": lambda: viewer.state.all_steps,
        "shift+B": lambda: viewer.state.surroundings != state.surroundings,
        "shift+F": lambda: viewer.state.straight,
        "9": lambda: viewer.state.explain,
        "space": asks_to_switch("paused"),
        **{key: asks_to_move(*move) for key, move in BOARD_KEYS.items()},
        "end": asks_for(intents.PageAction.FINISH),
        "shift+end": asks_for(intents.PageAction.GO_ON),
        "H": shows(".v-keys"),
        "escape": shows(".v-keys", 0),
    }
    gui: Any = viewer.server.gui
    keys = set(hotkeys(gui)) - {None, "home"}  # Home fits the view: test_framing
    assert keys == effects.keys(), "a key without a test, or a test without a key"
    for key, effect in effects.items():
        page.keyboard.press(pressed(key))
        wait_until(effect, f"the effect of {key}")


@pytest.mark.parametrize("dark", [True, False], ids=["dark", "light"])
def test_every_text_is_readable(
    chromium: Any, projections: Projections, guiding: Snapshot, dark: bool
) -> None:
    """WCAG AA: 4.5, or 3 for large letters; none is smaller than 12 px."""
    viewer = Viewer(
        port=free_port(), projections=projections, draggable_board=True, dark=dark, tour=True
    )
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.set_default_timeout(60_000)

    def judge(where: str) -> None:
        seen = page.evaluate(SEEN)
        assert len(seen) > 20, where
        faint = [t for t in seen if t["ratio"] < (3.0 if t["large"] else 4.5)]
        assert not faint, f"{where}: {faint}"
        small = [t for t in seen if t["size"] < 12]
        assert not small, f"{where}: {small}"

    try:
        viewer.show(guiding)
        page.goto(viewer.url)
        page.wait_for_selector(".v-tour")
        page.wait_for_selector(".v-chip")
        judge("the tour")
        page.keyboard.press("Escape")
        page.wait_for_selector(".v-tour", state="detached")
        for tab in TABS:
            page.get_by_role("tab", name=tab).click()
            page.wait_for_selector(f"[role=tab][aria-selected=true]:has-text('{tab}')")
            judge(tab)
        page.keyboard.press("h")
        page.wait_for_selector(".v-keys")
        judge("the help")
        page.keyboard.press("h")
        viewer.show(replace(guiding, phase="converged", target=None, match=None))
        page.wait_for_selector(".v-title:has-text('Done')")
        judge("the end")
    finally:
        context.close()
        viewer.close()


def test_the_large_text_is_large_docked_and_whole(
    chromium: Any, viewer: Viewer, guiding: Snapshot
) -> None:
    """At two metres: the headline has 40 px on a full screen. Nothing of it is cut off or scrolled
    away in a small window, and it lies over nothing: the scene begins beside it."""
    viewer.show(guiding)
    for width, height, least in ((1920, 1080, 40), (1280, 720, 34)):
        page = chromium.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(60_000)
        page.goto(viewer.url)
        page.wait_for_selector(".v-chip")
        letters = "e => parseFloat(getComputedStyle(e).fontSize)"
        assert page.eval_on_selector(".v-title", letters) >= least
        chips = page.locator(".v-chips").bounding_box()
        panel = page.locator("[data-dock-leaf]:has(.v-guide)").bounding_box()
        scene = page.locator("canvas").first.bounding_box()
        assert chips["y"] + chips["height"] <= panel["y"] + panel["height"], height
        assert panel["x"] + panel["width"] <= scene["x"] + 1, height
        capture = page.get_by_role("button", name="Capture this view")

        def whole(height: int = height, capture: Any = capture) -> bool:
            box = capture.bounding_box()  # the right panel's width comes from the server
            return bool(box["y"] + box["height"] <= height)

        wait_until(whole, f"Capture is seen in a window {height} px high")
        page.close()


@pytest.mark.parametrize("phase", ["converged", "finished"])
def test_at_the_end_only_what_makes_sense_is_offered(phase: Any) -> None:
    """Beside "Done" stood "Capture this view" in the colour of what to do next, and "Finish"; more
    views are asked for by "Go on". What the person has ended stays ended."""
    useful = useful_in(phase)
    assert useful.isdisjoint(("skip", "play", "next", "previous", "strip", "follow"))
    assert useful.isdisjoint(("capture", "finish")) and useful.issuperset(("go_on", "theme"))
    assert ("undo" in useful) == (phase == "converged")

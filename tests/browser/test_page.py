"""The page in a real browser: what is seen, what keys do, what survives a reload."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.forecast import Forecast
from venus3d.languages import Language
from venus3d.render.projections import Projections
from venus3d.scene.pages.guide import intents
from venus3d.scene.pages.guide.texts import METHOD_WORDS, PARAMETERS_TAB
from venus3d.scene.pages.guide.viewer import Viewer

pytestmark = [pytest.mark.browser, pytest.mark.slow]

Open = Callable[[], Any]


def canvas_pixels(page: Any) -> np.ndarray:
    """(H, W, 3) what the tab shows of the scene, above the guidance text."""
    box = page.locator("canvas").first.bounding_box()
    clip = {"x": box["x"], "y": box["y"] + 160, "width": box["width"], "height": 320}
    shot = np.frombuffer(page.screenshot(clip=clip), np.uint8)
    return np.asarray(cv2.imdecode(shot, cv2.IMREAD_COLOR))


def press(page: Any, key: str) -> None:
    """A key on the page, not in a text box."""
    page.keyboard.press(key)


def marked_tile(page: Any) -> str:
    """Number of the projection that is marked."""
    return str(page.locator("[data-marked]").get_attribute("data-marked"))


def test_page_shows_state_scene_projections_and_progress(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """Everything that a trainee needs is on the page, as text or as picture."""
    picture = np.full((720, 1280, 3), (90, 30, 30), np.uint8)
    viewer.show(guiding)
    viewer.show_picture(picture)
    page = open_page()
    page.wait_for_selector(".v-title:has-text('Step 3 of 4')")
    assert guiding.remaining is not None and guiding.target is not None
    step = guiding.remaining.step(3)
    assert page.locator(".v-sentence").inner_text() == step.prompt.holder
    assert f"{step.step.angle_deg:+.0f}".replace("-", "−") in page.inner_text(".v-amount")
    assert step.prompt.holder in page.locator(".v-tile").nth(2).text_content()
    page.wait_for_function("document.querySelectorAll('.v-tile .v-shot').length === 4")
    assert marked_tile(page) == "3"
    assert guiding.target.reason in page.inner_text(".v-reason")
    page.get_by_role("tab", name=PARAMETERS_TAB).click()
    page.wait_for_selector(".v-row")
    assert page.locator(".v-row").count() == 9
    assert {"/camera/frustum", "/board/live", "/target/board", "/steps/3/arrow"} <= set(
        viewer.scene_names
    )
    page.wait_for_function("!!document.querySelector('canvas')")
    wait_until(lambda: canvas_pixels(page).std() > 5, "the scene is drawn")

    # A note, however long, once pushed the steps out of a window that is 720 px high.
    viewer.say("The board does not look as it was told. " * 4, 600)
    page.wait_for_selector(".v-note")
    leaves = [leaf.bounding_box() for leaf in page.locator("[data-dock-leaf]").all()]
    lefts = sorted((box for box in leaves if box["x"] < 100), key=lambda box: box["y"])
    chips = page.locator(".v-chips").bounding_box()
    assert chips["y"] + chips["height"] <= lefts[0]["y"] + lefts[0]["height"]
    assert lefts[-1]["y"] + lefts[-1]["height"] == pytest.approx(720, abs=1), "down to the bottom"
    title, amount = page.evaluate(
        """() => {
            const title = document.createRange();
            title.selectNodeContents(document.querySelector(".v-title").lastChild);
            const amount = document.querySelector(".v-amount");
            return [title.getBoundingClientRect().right, amount.getBoundingClientRect().left];
        }"""
    )
    assert title < amount, "the amount was over the title"


def test_the_newest_of_many_views_is_in_the_strip_until_somebody_scrolls(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """The row was as wide as all its pictures, and cut off from the ninth view on."""
    place = """() => {
        const all = [...document.querySelectorAll("div:has(> .v-film) + div button")];
        const last = all.at(-1).getBoundingClientRect();
        const scene = document.querySelector(".v-film").getBoundingClientRect();
        return [all.length, scene.left <= last.left && last.right <= scene.right + 1];
    }"""
    viewer.show(replace(guiding, captured=tuple(range(1, 21))))
    page = open_page()
    wait_until(lambda: page.evaluate(place) == [20, True], "the twentieth is seen")
    viewer.show(replace(guiding, captured=tuple(range(1, 22))))
    wait_until(lambda: page.evaluate(place) == [21, True], "the next one too")
    page.evaluate(
        """() => { window.rightmost = 0; setInterval(() => {
            const { right } = document.querySelector(".v-film").getBoundingClientRect();
            rightmost = Math.max(rightmost, right / innerWidth);
        }, 10); }"""
    )
    page.set_viewport_size({"width": 1100, "height": 720})
    page.wait_for_timeout(500)
    assert page.evaluate(place) == [21, True], "and in a narrower strip"
    assert page.evaluate("() => rightmost") <= 1, "it flew out of the window with its column"
    strip = page.locator(".v-film").bounding_box()
    page.mouse.move(strip["x"] + strip["width"] / 2, strip["y"] + strip["height"] / 2)
    page.mouse.wheel(0, -9000)
    wait_until(lambda: page.evaluate(place) == [21, False], "the first ones are seen")
    viewer.show(replace(guiding, captured=tuple(range(1, 23))))
    wait_until(lambda: page.evaluate(place)[0] == 22, "another one")
    page.wait_for_timeout(300)
    assert page.evaluate(place) == [22, False], "who looks at the first ones keeps them"


def test_the_strip_has_a_scrollbar_and_above_it_the_mouse_is_the_scene_s(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """Nothing told that there are more views to the left. (A browser without a window draws no
    scrollbar, so it is not dragged here.)"""
    row = "document.querySelector('div:has(> .v-film) + div button').parentElement"
    viewer.show(replace(guiding, captured=tuple(range(1, 31))))
    page = open_page()
    wait_until(lambda: page.evaluate(f"() => {row}.scrollWidth > {row}.clientWidth"))
    bar = page.evaluate(f"() => getComputedStyle({row}, '::-webkit-scrollbar').height")
    assert float(bar.removesuffix("px")) >= 5
    strip = page.locator(".v-film").bounding_box()
    x, bottom = strip["x"] + 40, strip["y"] + strip["height"]
    over = "([x, y]) => document.elementFromPoint(x, y)"
    page.mouse.move(x, bottom - 3)
    wait_until(lambda: page.evaluate(f"(at) => {row}.contains(({over})(at))", [x, bottom - 3]))
    for _ in range(2):
        assert page.evaluate(f"(at) => ({over})(at).tagName", [x, strip["y"] - 20]) == "CANVAS"
        page.mouse.move(x, strip["y"] - 20)


def test_keys_turn_the_steps_over(viewer: Viewer, open_page: Open, guiding: Snapshot) -> None:
    """N, P and F change scene, text and marked projection together; no picture is sent again."""
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector(".v-title:has-text('Step 3 of 4')")
    assert "/steps/3/arrow" in viewer.scene_names
    page.wait_for_function("document.querySelectorAll('.v-tile .v-shot').length === 4")
    styles = "[...document.querySelectorAll('style')]"
    sheet = f"{styles}.find(e => e.textContent.includes('[data-shot=steps-4]{{'))"
    page.evaluate(f"{sheet}.kept = true")
    press(page, "n")
    page.wait_for_selector(".v-title:has-text('Step 4 of 4')")
    page.wait_for_selector("[data-marked='4']", state="attached")
    assert page.evaluate(f"{sheet}.kept")
    borders = page.evaluate(
        "[...document.querySelectorAll('.v-tile')].map(e => getComputedStyle(e).borderTopColor)"
    )
    assert borders[3] not in borders[:3] and len(set(borders[:3])) == 1, "one is marked"
    assert "/steps/3/arrow" not in viewer.scene_names
    assert "/steps/4/after" in viewer.scene_names
    press(page, "p")
    press(page, "p")
    page.wait_for_selector(".v-title:has-text('Step 2 of 4')")
    assert not viewer.state.follow
    press(page, "f")
    page.wait_for_selector(".v-title:has-text('Step 3 of 4')")
    press(page, "t")
    wait_until(lambda: any(n.startswith("/strip/4/") for n in viewer.scene_names), "the strip")
    press(page, "Shift+Space")
    wait_until(lambda: viewer.state.playing, "playing")


def test_keys_queue_what_was_asked_for(viewer: Viewer, open_page: Open, guiding: Snapshot) -> None:
    """Keys and buttons only queue intents; nothing is done on the browser's behalf."""
    viewer.show(guiding)
    page = open_page()
    asked: list[intents.Intent] = []

    def has(count: int) -> bool:
        asked.extend(viewer.drain_intents())
        return len(asked) >= count

    for key in ("c", "g", "Backspace", " ", "Shift+P"):
        count = len(asked)
        press(page, key)
        wait_until(lambda count=count: has(count + 1), f"key {key!r}")
    assert asked == [
        intents.PageAction.CAPTURE,
        intents.PageAction.SKIP_TARGET,
        intents.PageAction.UNDO_VIEW,
        intents.Toggle("paused"),
        intents.Toggle("autopilot"),
    ]
    page.wait_for_selector(".v-title:has-text('Paused')")
    assert viewer.state.paused and viewer.state.autopilot
    page.get_by_text("Capture this view (C)").click()
    wait_until(lambda: has(6), "the button")
    assert asked[5] == intents.PageAction.CAPTURE


def test_reload_and_second_tab_see_the_same(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """A reload is a new client for the server; the state is the viewer's, so nothing is lost."""
    viewer.show(guiding)
    first = open_page()
    press(first, "b")
    first.wait_for_selector(".v-title:has-text('Step 3 of 4')")
    press(first, "n")
    first.wait_for_selector("[data-marked='4']")
    wait_until(lambda: not viewer.state.dark, "the light page")
    first.reload()
    second = open_page()
    for page in (first, second):
        page.wait_for_selector(".v-title:has-text('Step 4 of 4')")
        page.wait_for_selector("[data-marked='4']")
        page.wait_for_function("document.querySelectorAll('.v-tile .v-shot').length === 4")
        page.wait_for_selector("[data-mantine-color-scheme='light']", state="attached")
    assert first.inner_text(".v-sentence") == second.inner_text(".v-sentence")


def test_the_line_of_the_loop_pushes_no_button_out_of_the_window(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """The last rows of buttons were beyond the right panel's end."""
    viewer.show_picture(np.full((720, 1280, 3), (90, 30, 30), np.uint8))
    viewer.show(guiding)
    page = open_page()
    page.wait_for_function("document.querySelectorAll('.v-tile .v-shot').length === 4")
    panel = "[...document.querySelectorAll('.mantine-ScrollArea-viewport')].find(e => "
    panel += "e.querySelector('.v-grid'))"
    for width, height in ((1280, 720), (1366, 768), (1920, 1080)):
        page.set_viewport_size({"width": width, "height": height})
        for line in (False, True):
            if line:
                press(page, "9")
                page.wait_for_selector(".v-loop")
            wait_until(
                lambda: page.evaluate(f"{panel}.scrollHeight <= {panel}.clientHeight + 1"),
                f"all buttons are seen at {width} x {height}, with the line: {line}",
            )
        press(page, "9")
        page.wait_for_selector(".v-loop", state="hidden")


@pytest.mark.parametrize("language", ["en", "de"])
def test_all_of_the_progress_is_seen_in_a_low_window(
    chromium: Any, projections: Projections, guided: Snapshot, language: Language
) -> None:
    """What the next pose is for and the poses nearly as good were reached only by scrolling."""
    target = guided.target
    assert target is not None and target.alternatives
    three = target.alternatives * 3
    viewer = Viewer(port=free_port(), projections=projections, language=language)
    page = chromium.new_page(viewport={"width": 1366, "height": 768})
    try:
        page.goto(viewer.url)
        panel = "[...document.querySelectorAll('.mantine-ScrollArea-viewport')].find(e => "
        panel += "e.querySelector('.v-big'))"
        for width, height, count in ((1366, 768, 3), (1280, 720, 2)):
            others = three[:count]
            viewer.show(replace(guided, target=replace(target, alternatives=others)))
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_function(f"{panel}?.querySelectorAll('button').length === {count}")
            wait_until(
                lambda: page.evaluate(f"{panel}.scrollHeight <= {panel}.clientHeight + 1"),
                f"all of it is seen at {width} x {height}",
            )
    finally:
        page.close()
        viewer.close()


def with_alternatives(snapshot: Snapshot, errors: tuple[float, ...]) -> Snapshot:
    """The snapshot with as many other targets, each held in its own way."""
    target = snapshot.target
    assert target is not None
    others = tuple(
        replace(
            target,
            held=f"on the left, {i} cm away",
            uncertainty_px=0.6,
            predicted_uncertainty_px=error,
        )
        for i, error in enumerate(errors)
    )
    return replace(snapshot, target=replace(target, alternatives=others))


def test_another_pose_is_chosen_by_button_or_key(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """Each nearly equal pose is one button with words and figures; none, no button."""
    viewer.show(replace(guiding, target=replace(guiding.target, alternatives=())))
    page = open_page()
    page.wait_for_selector(".v-title:has-text('Step 3 of 4')")
    assert not page.get_by_text("nearly as good").is_visible()
    viewer.show(with_alternatives(guiding, (0.411, 0.43)))
    page.get_by_text("nearly as good").wait_for()
    number = guiding.target.number
    button = page.get_by_role("button", name="on the left, 1 cm away: 0.43 px")
    assert page.get_by_role("button", name="on the left").count() == 2
    # All of its text is within it.
    inside = "e => e.scrollHeight <= e.clientHeight + 1 && e.scrollWidth <= e.clientWidth + 1"
    assert button.evaluate(inside)
    press(page, "n")
    wait_until(lambda: not viewer.state.follow, "a step picked by hand")
    button.click()
    asked: list[intents.Intent] = []

    def has(count: int) -> bool:
        asked.extend(i for i in viewer.drain_intents() if i != intents.TurnStep(1))
        return len(asked) >= count

    wait_until(lambda: has(1), "the button")
    assert viewer.state.follow, "another pose is followed from its first step"
    press(page, "1")
    wait_until(lambda: has(2), "the key")
    assert asked == [intents.ChooseAlternative(1, number), intents.ChooseAlternative(0, number)]


def test_the_method_is_chosen_from_a_list_that_tells_the_truth(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """A choice that the session refuses must not stay on the page as if it had been taken."""
    viewer.show(guiding)
    page = open_page()
    page.get_by_text("How the next pose is found").click()
    method = page.get_by_role("combobox", name="Method")
    method.wait_for()
    assert method.input_value() == METHOD_WORDS["global"]

    def pick(box: Any, words: str) -> None:
        box.scroll_into_view_if_needed()
        box.click()
        page.get_by_role("option", name=words, exact=True).click()

    pick(method, METHOD_WORDS["venus"])
    asked: list[intents.Intent] = []

    def has(count: int) -> bool:
        asked.extend(viewer.drain_intents())
        return len(asked) >= count

    wait_until(lambda: has(1), "the method")
    assert asked == [intents.ChangeMethod("venus")]

    def shows(words: str, shown: Snapshot) -> Callable[[], bool]:
        def came() -> bool:
            viewer.show(shown)
            return bool(method.input_value() == words)

        return came

    venus = replace(guiding, method="venus", cost="sum-iod")
    wait_until(shows(METHOD_WORDS["venus"], venus), "the method that was taken")
    pick(method, METHOD_WORDS["global"])
    wait_until(lambda: has(2), "the other method")
    assert asked[1] == intents.ChangeMethod("global")
    wait_until(shows(METHOD_WORDS["venus"], venus), "a method that was not taken goes back")
    assert not has(3), "what the page puts back is nobody's wish"


def test_promise_outcome_and_forecast_are_on_the_page(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """What a view should bring, what the last one brought, how many more it takes."""
    assert guiding.target is not None
    last = replace(guiding.history[-1], uncertainty_px=0.43, predicted_uncertainty_px=0.41)
    shown = replace(
        guiding,
        history=(replace(last, views=1, uncertainty_px=0.62), replace(last, views=2)),
        target=replace(guiding.target, uncertainty_px=0.43, predicted_uncertainty_px=0.365),
        forecast=Forecast(0.3, 3, 2, 4, 6),
    )
    viewer.show(shown)
    page = open_page()
    page.wait_for_selector(".v-line")
    lines = page.locator(".v-line").all_inner_texts()
    assert lines == [
        "The last view: 0.62 → 0.43 px (promised 0.41).",
        "About 3 more views until 0.3 px (2 to 4).",
    ]
    assert "It should bring the uncertainty from 0.43 to 0.36 px." in page.inner_text(".v-reason")

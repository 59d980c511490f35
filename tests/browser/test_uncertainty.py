"""What is known, in a real browser: maps, a view that is clicked and left out, the search."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from tests.waiting import wait_until
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide import intents
from venus3d.scene.pages.guide import texts as guide_texts
from venus3d.scene.pages.guide.uncertainty import texts
from venus3d.scene.pages.guide.viewer import Viewer

pytestmark = [pytest.mark.browser, pytest.mark.slow]

Open = Callable[[], Any]


def decoded(source: str) -> np.ndarray:
    """The picture behind an HTML image's source."""
    raw = np.frombuffer(base64.b64decode(source.split(",", 1)[1]), np.uint8)
    return np.asarray(cv2.imdecode(raw, cv2.IMREAD_COLOR))


def on_screen(viewer: Viewer, page: Any, point: np.ndarray) -> tuple[float, float]:
    """Where a point (3,), camera frame, is on the page of the only tab, CSS pixels."""
    (client,) = viewer.server.get_clients().values()
    seen = client.camera
    w, x, y, z = seen.wxyz
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    ahead = R.T @ (point - np.asarray(seen.position))
    box = page.locator("canvas").first.bounding_box()
    f = box["height"] / 2 / np.tan(seen.fov / 2)
    middle = np.array([box["x"] + box["width"] / 2, box["y"] + box["height"] / 2])
    u, v = middle + f * ahead[:2] / ahead[2]
    return float(u), float(v)


def test_maps_views_and_leaving_one_out(viewer: Viewer, open_page: Open, guided: Snapshot) -> None:
    """M turns the maps over; a captured view is clicked in the scene, is put away by Esc, says what
    if, and goes."""
    # Nothing else stands in the way of the click.
    alone = replace(guided, target=None, match=None, pose=None)
    viewer.keep_view(2, np.full((720, 1280, 3), (40, 90, 160), np.uint8))
    viewer.show(alone)
    page = open_page()
    page.get_by_role("tab", name=texts.TAB).click()
    known = guided.uncertainty
    assert known is not None
    title = "[data-panel=uncertainty]:has(.v-map) h3"
    page.wait_for_selector(f"{title}:has-text('{texts.NOW_TITLE}')")
    picture = decoded(page.locator(".v-map img").get_attribute("src"))
    assert picture.shape == (360, 640, 3) and picture.std() > 20
    for wanted in (texts.CORNERS_TITLE, texts.LENS_TITLE, texts.MISFIT_TITLE, texts.NOW_TITLE):
        while page.locator(title).count() == 0 or wanted not in page.locator(title).inner_text():
            before = page.locator("[data-panel=uncertainty] h3").all_inner_texts()
            page.keyboard.press("M")
            page.wait_for_function(
                "old => [...document.querySelectorAll('[data-panel=uncertainty] h3')]"
                ".map(e => e.innerText).join() !== old",
                arg=",".join(before),
            )
    page.keyboard.press("Shift+V")
    wait_until(lambda: "/views/2/sheet" in viewer.scene_names, "the views stand in the scene")
    page.wait_for_timeout(1000)  # viser's picture follows its messages by a frame or two
    view = guided.views[1]
    for again in (True, False):
        page.mouse.click(*on_screen(viewer, page, view.pose.t))
        page.wait_for_selector(".mantine-Modal-content .v-view")
        if again:
            page.keyboard.press("Escape")
            page.wait_for_selector(".mantine-Modal-content", state="detached")
    card = page.locator(".mantine-Modal-content .v-view")
    number = int(card.get_attribute("data-view"))
    left = known.without(number)
    assert left is not None
    rows = card.locator("tr").all_inner_texts()
    shown = [float(re.findall(r"([\d.]+) px", row)[1]) for row in rows[1:]]
    expected = [left.uncertainty_px, left.sigma[0], left.sigma[1], left.rms_px]
    np.testing.assert_allclose(shown, expected, rtol=0.06)
    assert card.locator(".v-verdict").inner_text()
    # What the page says afterwards, the open card says too: it told of the moment of the click.
    assert alone.calibration is not None
    viewer.show(replace(alone, calibration=replace(alone.calibration, rms_px=9.9)))
    page.wait_for_selector(".mantine-Modal-content .v-without tr:last-child:has-text('9.9 px')")
    page.locator(".mantine-Modal-content").get_by_text(texts.LEAVE_OUT).click()
    asked: list[intents.Intent] = []
    wait_until(lambda: bool(asked.extend(viewer.drain_intents()) or asked), "it is left out")
    assert asked == [intents.DropView(number)]
    page.wait_for_selector(".mantine-Modal-content", state="detached")
    page.mouse.click(*on_screen(viewer, page, view.pose.t))
    page.wait_for_selector(".mantine-Modal-content .v-view")
    others = tuple(one for one in alone.views if one.number != number)
    viewer.show(replace(alone, calibration=replace(alone.calibration, views=others)))
    page.wait_for_selector(".mantine-Modal-content", state="detached")


def test_views_by_keyboard_and_the_search_replayed(
    viewer: Viewer, open_page: Open, guided: Snapshot
) -> None:
    """Shift+N goes from view to view; Shift+G shows the search, then the steps come back."""
    viewer.keep_view(2, np.full((720, 1280, 3), (40, 90, 160), np.uint8))
    viewer.show(guided)
    page = open_page()
    page.get_by_role("tab", name=texts.TAB).click()
    page.wait_for_selector(".v-map img")
    for number in (1, 2):
        page.keyboard.press("Shift+N")
        page.wait_for_selector(f".v-view[data-view='{number}']")
    kept = decoded(page.locator(".v-view img").get_attribute("src"))
    assert kept.shape == (180, 320, 3) and np.abs(kept.mean(axis=(0, 1)) - (40, 90, 160)).max() < 4
    assert "/views/2/sheet" in viewer.scene_names
    page.keyboard.press("Shift+G")
    wait_until(lambda: "/search/places" in viewer.scene_names, "the search is shown")
    wait_until(lambda: "/target/board" not in viewer.scene_names, "the steps make room")
    target = guided.target
    assert target is not None
    page.wait_for_function(
        "t => document.querySelector('.v-guide').innerText.includes(t)",
        arg=texts.SEARCH_TITLE,
    )
    # Guidance goes on meanwhile.
    assert page.locator(".v-sentence").inner_text()
    page.keyboard.press("Shift+G")
    wait_until(lambda: "/search/places" not in viewer.scene_names, "the replay ends")
    assert "/target/board" in viewer.scene_names
    # A parameter says what it does: Enter opens its row.
    page.get_by_role("tab", name=guide_texts.PARAMETERS_TAB).click()
    page.locator("summary").nth(4).focus()
    page.keyboard.press("Enter")
    page.get_by_text(texts.PARAMETER_SENTENCES["k1"], exact=True).wait_for(state="visible")

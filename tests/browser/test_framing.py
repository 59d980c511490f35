"""What the browser shows of the scene: where it was computed to be, whole, beside or above the
panels; and a view that a person has turned stays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest

from tests.waiting import wait_until
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.snapshot import Snapshot, pose_snapshot
from venus3d.scene.pages.guide.viewer import Viewer

pytestmark = [pytest.mark.browser, pytest.mark.slow]

BOX = "() => document.querySelector('[data-engine]').getBoundingClientRect().toJSON()"
HANDLE = ".mantine-ScrollArea-content > div > div:has(+ [aria-hidden])"
"""Of the sheet into which viser lays all panels on a phone."""
PINK = (255, 0, 255)


@pytest.fixture
def page(sharp_chromium: Any, viewer: Viewer, guiding: Snapshot) -> Iterator[Any]:
    """A large window with a moment of the guidance."""
    viewer.show(guiding)
    page = sharp_chromium.new_page(viewport={"width": 1366, "height": 768})
    page.set_default_timeout(60_000)
    page.goto(viewer.url)
    page.wait_for_selector(".v-guide")
    yield page
    page.close()


def settled(viewer: Viewer) -> Any:
    """The tab's camera once it has stood still for a while."""
    wait_until(lambda: viewer.server.get_clients())
    camera = next(iter(viewer.server.get_clients().values())).camera
    before: list[Array] = []

    def is_still() -> bool:
        before.append(np.append(camera.position, camera.image_width))
        last = before[-150:]
        return len(last) == 150 and np.allclose(last[0], last[-1], atol=1e-4)

    wait_until(is_still)
    return camera


def seen_at(camera: Any, points: Array, box: dict[str, float]) -> Array:
    """(N, 2) pixels of the page where OpenCV projects points for the camera that viser tells of."""
    ahead = (camera.look_at - camera.position) / np.linalg.norm(camera.look_at - camera.position)
    right = np.cross([0.0, 1.0, 0.0], ahead)
    right = right / np.linalg.norm(right)
    R = np.stack([right, np.cross(ahead, right), ahead])
    f = box["height"] / 2 / np.tan(camera.fov / 2)
    K = np.array([[f, 0, box["width"] / 2], [0, f, box["height"] / 2], [0, 0, 1.0]])
    pixels, _ = cv2.projectPoints(points, cv2.Rodrigues(R)[0], -R @ camera.position, K, None)
    return pixels.reshape(-1, 2) + np.array([box["left"], box["top"]])


def picture_of(page: Any) -> Array:
    """The page as RGB."""
    raw = np.frombuffer(page.screenshot(), np.uint8)
    return cv2.cvtColor(cv2.imdecode(raw, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB).astype(np.float64)


def test_the_scene_is_where_it_was_computed_and_fills_its_window(
    viewer: Viewer, page: Any, guiding: Snapshot
) -> None:
    assert guiding.target is not None
    corners = guiding.target.pose.apply(1.1 * guiding.board.outline)
    for number, corner in enumerate(corners):
        handle = viewer.server.scene.add_icosphere(f"/marks/{number}", 0.004, PINK)
        handle.position = tuple(corner)
    camera, box = settled(viewer), page.evaluate(BOX)
    for close in page.locator(".mantine-Notification-closeButton").all():
        close.click()  # viser's word on software rendering lies over the scene

    def marks_are_there() -> bool:
        """Whether three corners are seen, since another board may hide one, and nowhere else."""
        pink = np.abs(picture_of(page) - PINK).max(axis=2) < 90
        pink[:, : round(box["left"])], pink[:, round(box["right"]) :] = False, False
        count, _, sizes, found = cv2.connectedComponentsWithStats(pink.astype(np.uint8))
        seen = [found[i] for i in range(1, count) if sizes[i, cv2.CC_STAT_AREA] > 12]
        expected = seen_at(camera, corners, box)
        return len(seen) >= 3 and all(
            np.linalg.norm(expected - place, axis=1).min() < 4 for place in seen
        )

    wait_until(marks_are_there)
    expected = seen_at(camera, corners, box)
    lens = seen_at(camera, np.zeros((1, 3)), box)
    everything = np.vstack([expected, lens])
    inside = (everything - [box["left"], box["top"]]) / [box["width"], box["height"]]
    assert inside.min() > 0.05 and inside.max() < 0.95
    assert np.ptp(inside, axis=0).max() > 0.5


def test_a_view_that_a_person_has_turned_stays(
    viewer: Viewer, page: Any, guiding: Snapshot
) -> None:
    camera, box = settled(viewer), page.evaluate(BOX)
    x, y = box["left"] + 0.9 * box["width"], box["top"] + 0.9 * box["height"]
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 60, y - 40, steps=8)
    page.mouse.up()
    page.get_by_text("The view stays as you turned it").wait_for()
    turned = settled(viewer).position.copy()
    far = Pose.from_vector([20, -20, 0, 0.1, 0.05, 0.9])
    viewer.show(pose_snapshot(guiding.board, guiding.camera, guiding.pose, far, guiding))
    page.wait_for_timeout(900)
    np.testing.assert_allclose(settled(viewer).position, turned, atol=1e-6)
    page.keyboard.press("Home")
    wait_until(lambda: np.linalg.norm(camera.position - turned) > 0.1)
    place = seen_at(settled(viewer), far.apply(guiding.board.outline), box)
    inside = (place - [box["left"], box["top"]]) / [box["width"], box["height"]]
    assert inside.min() > 0.05 and inside.max() < 0.95


def test_on_a_phone_the_scene_keeps_above_the_sheet(
    chromium: Any, viewer: Viewer, guiding: Snapshot
) -> None:
    viewer.show(guiding)
    page = chromium.new_page(viewport={"width": 420, "height": 860})
    page.set_default_timeout(60_000)
    page.goto(viewer.url)
    page.wait_for_selector("[data-engine]")
    page.wait_for_selector(".v-title")
    page.wait_for_function(f"() => Math.abs(({BOX})().height - 344) < 2")
    handle = page.locator(HANDLE)
    handle.click(position={"x": 200, "y": 22})
    page.wait_for_function(f"() => ({BOX})().height > 800")
    # The scene grows at once, the sheet slides down: where its handle will be is still something
    # else that can be clicked.
    at_the_bottom = "e => innerHeight - e.getBoundingClientRect().bottom < 1"
    wait_until(lambda: handle.evaluate(at_the_bottom), "the sheet is down")
    handle.click(position={"x": 200, "y": 22})
    page.wait_for_function(f"() => Math.abs(({BOX})().height - 344) < 2")
    page.close()

"""Taking back, ending and going on through the real page, with the real simulation behind it."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.browser.keyboard import pressed
from tests.ports import free_port
from tests.waiting import wait_until
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.startup import Startup
from venus3d.scene.pages.guide.live import LiveGuide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.keys import KEYS
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.sim import Simulation

pytestmark = [pytest.mark.browser, pytest.mark.slow]

_PATIENCE_MS = 60_000
_VIEWS = r"n => Number(/(\d+)\s+views? captured/.exec(document.body.innerText)?.[1]) === n"


@pytest.fixture
def guided(chromium: Any, start: Callable[..., Any], two_views: Path, tmp_path: Path) -> Any:
    """A tab on a session that goes on from two views, its hand on the way to the third; its result
    goes to `tmp_path`."""
    program = start(
        *("guide", "sim", "--speed", "2.5", "--port", str(free_port()), "--no-tour"),
        *("--camera-size", "640x360", "--from", str(two_views), "--output", str(tmp_path)),
    )
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    context.grant_permissions(["clipboard-read", "clipboard-write"], origin=program.url)
    page = context.new_page()
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(program.url)
    page.wait_for_selector(".v-chip")
    page.keyboard.press(pressed(KEYS["autopilot"]))
    yield page
    context.close()


def wait_for_views(page: Any, count: int) -> None:
    page.wait_for_function(_VIEWS, arg=count)


@pytest.fixture
def standing(viewer: Viewer) -> Iterator[tuple[Session, Simulation]]:
    """A session on the viewer whose simulated board stands still at the first target."""
    camera, board = PAPER_CAMERA.scaled((640, 360)), Board()
    session = Session(board, camera.image_size)
    source = Simulation(
        camera,
        board,
        realtime=True,
        autopilot=False,
        start=Startup(board, camera.image_size).target,
    )
    tracker = BoardTracker(Detector(board, find_layout=False))
    live = LiveGuide(session, source, tracker, viewer, lambda _: None, lambda: source)
    thread = threading.Thread(target=live.run)
    thread.start()
    yield session, source
    live.stop()
    thread.join()


def test_what_is_taken_back_stays_so_while_the_board_stands_there(
    standing: tuple[Session, Simulation], open_page: Callable[[], Any]
) -> None:
    """The board stands where the first view is asked for: it used to be taken again at once."""
    session, source = standing
    page = open_page()
    wait_for_views(page, 1)
    page.keyboard.press(pressed(KEYS["undo"]))
    page.wait_for_selector(".v-title:has-text('Taken back')")
    seen = session.snapshot().number
    wait_until(lambda: session.snapshot().number > seen + 20)  # three still frames are enough
    wait_for_views(page, 0)
    page.keyboard.press(pressed(KEYS["capture"]))
    wait_for_views(page, 1)

    page.keyboard.press(pressed(KEYS["undo"]))
    page.wait_for_selector(".v-title:has-text('Taken back')")
    before = source.board_pose.t
    for _ in range(12):  # 2 mm each, and faster while the key repeats
        page.keyboard.press("l")
    wait_until(lambda: not session.snapshot().taken_back, "the board has left the pose")
    assert source.board_pose.t[0] > before[0] + 0.02 and source.board_pose.t[1] == before[1]


def test_an_end_is_asked_about_told_and_taken_back(guided: Any, tmp_path: Path) -> None:
    wait_for_views(guided, 3)
    guided.keyboard.press(pressed(KEYS["autopilot"]))
    guided.get_by_role("button", name="Finish").click()
    guided.wait_for_selector(".v-title:has-text('End now?')")
    text = guided.inner_text(".v-guide")
    assert "fx" in text and "±" in text and "Not settled" in text
    guided.get_by_role("button", name="Go on").click()
    guided.wait_for_selector(".v-title:has-text('End now?')", state="detached")

    guided.keyboard.press(pressed(KEYS["finish"]))
    guided.wait_for_selector(".v-title:has-text('End now?')")
    guided.get_by_role("button", name="End now").click()
    guided.wait_for_selector(".v-title:has-text('Ended before it settled')")
    assert "✓" not in guided.inner_text(".v-guide")
    kept = json.loads((tmp_path / "result.json").read_text())

    # Its figures: all of them in the window, and each is copied in full.
    assert guided.locator(".v-parameter").count() == 9
    # In one look, but for what may be said against so few views: all is written anew as soon as it
    # is known where the result is.
    guided.wait_for_function(
        "() => { const box = document.querySelector('.v-copies')?.getBoundingClientRect();"
        " const against = document.querySelector('[data-panel=diagnoses]');"
        " return box?.height > 0 && box.bottom - (against?.offsetHeight ?? 0) <= 720 }"
    )
    guided.locator(".v-figures .v-copy").first.click()
    guided.wait_for_selector(".v-copy[data-done]")
    copied = guided.evaluate("navigator.clipboard.readText()")
    assert float(copied) == pytest.approx(kept["intrinsics"]["fx"], rel=1e-8)

    # One measures with it in another tab, in the picture that goes on coming.
    with guided.context.expect_page() as opened:
        guided.click(".v-copies a")
    opened.value.wait_for_selector(".v-measure:has-text('first point')", timeout=_PATIENCE_MS)
    opened.value.close()

    guided.keyboard.press(pressed(KEYS["resume"]))
    guided.wait_for_selector(".v-title:has-text('Ended')", state="detached")
    guided.wait_for_selector(".v-chip")
    wait_for_views(guided, kept["views"])

    for _ in range(2):  # by the key alone; then a new one
        guided.keyboard.press(pressed(KEYS["finish"]))
        guided.wait_for_timeout(300)
    guided.get_by_role("button", name="New session").click()
    guided.wait_for_selector(".v-title:has-text('Ended')", state="detached")
    stays = json.loads((tmp_path / "result.json").read_text())
    assert stays["intrinsics"] == kept["intrinsics"], "the result stays"

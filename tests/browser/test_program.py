"""The whole program in a real browser: simulated camera, autopilot, session, page.

`test_page.py` holds the page down by itself; here a key must go all the way to the calibration
and its result all the way back to every tab.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import cv2
import pytest
from playwright.sync_api import TimeoutError as PlaywrightTimeout

from tests.browser.keyboard import press_until
from tests.ports import free_port
from venus3d.scene.pages.guide.texts import METHOD_WORDS, TOUR
from venus3d.scene.web.step_texts import PICTURE_LEGEND

pytestmark = [pytest.mark.browser, pytest.mark.slow]

_PATIENCE_MS = 180_000
_CONNECTED = ".tabler-icon-cloud-check"
"""viser's mark beside the page's title."""
SMALL = ("sim", "--camera-size", "640x360")

Start = Callable[..., Any]


def views_on(page: Any) -> int:
    """The number before "views captured"."""
    found = re.search(r"(\d+)\s+views? captured", page.inner_text("body"))
    assert found is not None
    return int(found.group(1))


MORE_VIEWS_THAN = r"n => Number(/(\d+)\s+views? captured/.exec(document.body.innerText)?.[1]) > n"


def wait_for_views(page: Any, count: int) -> None:
    page.wait_for_function(
        r"n => Number(/(\d+)\s+views? captured/.exec(document.body.innerText)?.[1]) === n",
        arg=count,
        timeout=_PATIENCE_MS,
    )


def capture_by_key(page: Any) -> int:
    """The number of views once C has taken one. A frame without the board takes none, and says so:
    a person presses again."""
    before = views_on(page)
    for _ in range(6):
        page.keyboard.press("c")
        with suppress(PlaywrightTimeout):
            page.wait_for_function(MORE_VIEWS_THAN, arg=before, timeout=_PATIENCE_MS / 6)
            return views_on(page)
    raise AssertionError(f"no view after {before}: {page.inner_text('body')}")


def test_keys_reach_the_calibration_and_every_tab_sees_it(
    chromium: Any, start: Start, two_views: Path, tmp_path: Path
) -> None:
    """C takes a view and U takes it back; a reload and a second tab show the same. A tab stays open
    while the program is gone, and shows the session when it is resumed."""
    port = str(free_port())
    simulated = start(
        *("guide", *SMALL, "--autopilot", "--speed", "3", "--port", port, "--no-tour"),
        *("--from", str(two_views), "--output", str(tmp_path)),
    )
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.goto(simulated.url)
    # The autopilot has walked the steps by itself; fewer views would be no result.
    page.wait_for_function(MORE_VIEWS_THAN, arg=2, timeout=_PATIENCE_MS)
    page.keyboard.press("Shift+P")  # takes its hand off the board, which stays in sight
    page.wait_for_timeout(1500)  # it may have had the board in its place just then
    page.wait_for_selector(".v-title:has-text('Step')", timeout=_PATIENCE_MS)
    taken = capture_by_key(page)

    page.reload()
    wait_for_views(page, taken)
    second = chromium.new_page(viewport={"width": 1280, "height": 720})
    second.goto(simulated.url)
    wait_for_views(second, taken)

    second.keyboard.press("Backspace")
    wait_for_views(page, taken - 1)
    second.close()

    out, err = simulated.end()
    page.wait_for_selector(_CONNECTED, state="detached", timeout=_PATIENCE_MS)
    assert simulated.process.returncode in (0, 130) and "Traceback" not in err, err
    result = json.loads((tmp_path / "result.json").read_text())
    assert result["views"] == taken - 1 and f" in {taken - 1} view" in out
    saved = cv2.FileStorage(str(tmp_path / "camera.yaml"), cv2.FILE_STORAGE_READ)
    matrix = saved.getNode("camera_matrix").mat()
    assert matrix[0, 0] == pytest.approx(result["intrinsics"]["fx"])

    start("guide", "--resume", str(tmp_path), "--speed", "0.1", "--port", port)
    page.wait_for_selector(_CONNECTED, timeout=_PATIENCE_MS)
    wait_for_views(page, taken - 1)
    page.keyboard.press("Backspace")
    wait_for_views(page, taken - 2)
    page.close()


def test_a_real_video_is_guided_and_captured_on_the_key(
    chromium: Any, shared_data: Path, start: Start, tmp_path: Path
) -> None:
    """Nobody moves the camera of a recording: board, target and steps are shown all the same."""
    board = "--board.columns 12 --board.rows 8 --board.square-mm 18.0086 --board.marker-mm 13.9954"
    program = start(
        *("guide", str(shared_data / "wpilib-charuco-12x8.mp4"), *board.split()),
        *("--board.dictionary", "DICT_5X5_1000", "--no-auto-capture", "--port", str(free_port())),
        *("--no-tour", "--output", str(tmp_path)),
    )
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.goto(program.url)
    page.wait_for_selector(".v-title:has-text('Step')", timeout=_PATIENCE_MS)
    page.wait_for_function(
        "document.querySelectorAll('.v-tile .v-shot').length === 4", timeout=_PATIENCE_MS
    )
    assert views_on(page) == 0
    page.keyboard.press("c")
    wait_for_views(page, 1)
    page.close()
    _, err = program.end()
    assert "Traceback" not in err, err


def test_another_pose_and_another_method_are_chosen_while_running(
    chromium: Any, start: Start, tmp_path: Path
) -> None:
    """From the page to the session and back: another target; a refusal is said in a sentence."""
    # No hand moves the board, so the target stands while we choose.
    program = start(
        *("guide", *SMALL, "--no-auto-capture", "--port", str(free_port())),
        *("--no-tour", "--output", str(tmp_path)),
    )
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(program.url)
    page.wait_for_selector(".v-title:has-text('Step')")
    press_until(page, "c", "text=nearly as good")
    # The pictures tell one pose from another; the reasons of two may be the same words.
    first = "getComputedStyle(document.querySelector('.v-shot')).backgroundImage"
    page.wait_for_selector(".v-shot")
    before = page.evaluate(first)
    page.keyboard.press("1")
    page.wait_for_function(f"old => {first} && {first} !== old", arg=before)
    # Also where a low window leaves it out.
    assert "poses were evaluated" in page.text_content(".v-reason")

    def pick(box: str, words: str) -> None:
        page.get_by_role("combobox", name=box).click()
        page.get_by_role("option", name=words, exact=True).click()

    page.get_by_text("How the next pose is found").click()
    before = page.text_content(".v-reason")
    pick("Method", METHOD_WORDS["venus"])
    page.wait_for_function(
        "old => document.querySelector('.v-reason').textContent !== old", arg=before
    )
    page.close()
    _, err = program.end()
    assert "Traceback" not in err, err


def test_whoever_has_only_a_keyboard_calibrates(
    chromium: Any, start: Start, tmp_path: Path
) -> None:
    """From the tour to the end without touching the mouse: the tour, help, the hand that moves the
    board, the four steps until the view is captured, and Finish from the list of commands. After
    the end nothing is offered that does nothing."""
    program = start(
        *("guide", *SMALL, "--speed", "3", "--port", str(free_port()), "--output", str(tmp_path)),
    )
    context = chromium.new_context(viewport={"width": 1280, "height": 720})
    page = context.new_page()
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(program.url)
    for number in range(1, len(TOUR) + 1):
        page.wait_for_selector(f".v-tour[data-step='{number}']")
        page.keyboard.press("Enter")
    page.wait_for_selector(".v-tour", state="detached")
    page.wait_for_selector(".v-title:has-text('Step')")
    page.keyboard.press("h")
    page.wait_for_selector(".v-keys:has-text('Capture this view')")
    page.keyboard.press("Escape")
    page.wait_for_selector(".v-keys", state="detached")
    page.keyboard.press("Shift+P")
    wait_for_views(page, 1)

    page.reload()
    page.wait_for_function(MORE_VIEWS_THAN, arg=2)  # fewer are no result
    assert page.locator(".v-tour").count() == 0, "who has seen the tour is not shown it again"
    page.keyboard.press("Control+k")
    # Until the box has the focus, what is typed are keys of the page.
    page.wait_for_selector("input[placeholder^='Search']:focus")
    page.keyboard.type("Finish")
    page.wait_for_selector(".mantine-Spotlight-action[data-selected]:has-text('Finish')")
    page.keyboard.press("Enter")
    page.wait_for_selector(".v-title:has-text('End now?')")
    # Until the list is gone, its box takes the key.
    page.wait_for_selector("input[placeholder^='Search']", state="detached")
    page.keyboard.press("End")
    page.wait_for_selector(".v-title:has-text('Ended'), .v-title:has-text('Done')")
    page.get_by_role("button", name="Capture this view").wait_for(state="detached")
    for gone in ("Skip G", "Play ⇧␣", "Finish"):
        assert page.get_by_role("button", name=gone, exact=True).count() == 0, gone
    assert not page.get_by_text(PICTURE_LEGEND[0][1]).is_visible()
    context.close()
    _, err = program.end()
    assert "Traceback" not in err and (tmp_path / "result.json").exists(), err


def test_the_operator_is_told_of_what_cannot_be_saved(
    chromium: Any, start: Start, two_views: Path, tmp_path: Path
) -> None:
    """Guidance goes on meanwhile, and at the end the page says where the result is."""
    folder = tmp_path / "out"
    program = start(
        *("guide", *SMALL, "--autopilot", "--speed", "3", "--port", str(free_port()), "--no-tour"),
        *("--from", str(two_views), "--max-views", "4", "--output", str(folder), "--no-record"),
    )
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.set_default_timeout(_PATIENCE_MS)
    page.goto(program.url)
    folder.rename(tmp_path / "gone")
    folder.write_text("in the way")
    page.get_by_text("Not saved: camera.yaml and result.json cannot be written").wait_for()
    folder.unlink()
    page.get_by_text(f"Saved: camera.yaml and result.json in {folder}.").wait_for()
    assert json.loads((folder / "result.json").read_text())["views"] == 4
    page.close()
    _, err = program.end()
    assert "Traceback" not in err and err.count("Not saved: ") >= 1, err

"""The whole program in a real browser: simulated camera, autopilot, session, page.

`test_page.py` holds the page down by itself; here a key must go all the way to the calibration
and its result all the way back to every tab.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import pytest

from venus3d.scene.texts.guide import COST_WORDS, METHOD_WORDS

pytestmark = [pytest.mark.browser, pytest.mark.slow]

_PATIENCE_MS = 120_000


class Program:
    """`venus3d guide` with its page's address."""

    def __init__(self, output: Path, *arguments: str) -> None:
        self.output = output
        self.process = subprocess.Popen(
            [sys.executable, "-m", "venus3d", "guide", *arguments, "--output", str(output)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if found := re.search(r"http://\S+", line):
                self.url = found.group()
                return
        raise AssertionError(self.process.communicate()[1])

    def end(self) -> tuple[str, str]:
        self.process.send_signal(signal.SIGINT)
        return self.process.communicate(timeout=60)


@pytest.fixture
def simulated(tmp_path: Path) -> Iterator[Program]:
    program = Program(tmp_path, "sim", "--autopilot", "--speed", "2", "--port", "8270")
    yield program
    program.process.kill()


def views_on(page: Any) -> int:
    """The number above "views captured"."""
    found = re.search(r"(\d+)\s+views captured", page.inner_text("body"))
    assert found is not None
    return int(found.group(1))


def wait_for_views(page: Any, count: int) -> None:
    page.wait_for_function(
        r"n => Number(/(\d+)\s+views captured/.exec(document.body.innerText)?.[1]) === n",
        arg=count,
        timeout=_PATIENCE_MS,
    )


def test_keys_reach_the_calibration_and_every_tab_sees_it(
    chromium: Any, simulated: Program
) -> None:
    """C takes a view and U takes it back; a reload and a second tab show the same."""
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    page.goto(simulated.url)
    wait_for_views(page, 1)  # the autopilot has walked the first four steps by itself
    page.keyboard.press("o")  # takes its hand off the board, which stays in sight
    page.wait_for_timeout(1500)
    before = views_on(page)
    page.keyboard.press("c")
    wait_for_views(page, before + 1)

    page.reload()
    wait_for_views(page, before + 1)
    second = chromium.new_page(viewport={"width": 1280, "height": 720})
    second.goto(simulated.url)
    wait_for_views(second, before + 1)

    second.keyboard.press("u")
    wait_for_views(page, before)
    second.close()
    page.close()

    out, err = simulated.end()
    assert simulated.process.returncode in (0, 130) and "Traceback" not in err, err
    result = json.loads((simulated.output / "result.json").read_text())
    assert result["views"] == before and f" in {before} view" in out
    saved = cv2.FileStorage(str(simulated.output / "camera.yaml"), cv2.FILE_STORAGE_READ)
    matrix = saved.getNode("camera_matrix").mat()
    assert matrix[0, 0] == pytest.approx(result["intrinsics"]["fx"])


def test_a_real_video_is_guided_and_captured_on_the_key(
    chromium: Any, shared_data: Path, tmp_path: Path
) -> None:
    """Nobody moves the camera of a recording: board, target and steps are shown all the same."""
    board = "--board.columns 12 --board.rows 8 --board.square-mm 18.0086 --board.marker-mm 13.9954"
    program = Program(
        tmp_path,
        str(shared_data / "wpilib-charuco-12x8.mp4"),
        *board.split(),
        *("--board.dictionary", "DICT_5X5_1000", "--no-auto-capture", "--port", "8280"),
    )
    try:
        page = chromium.new_page(viewport={"width": 1280, "height": 720})
        page.goto(program.url)
        page.wait_for_selector(".v-title:has-text('Step')", timeout=_PATIENCE_MS)
        page.wait_for_function(
            "document.querySelectorAll('.v-tile img').length === 4", timeout=_PATIENCE_MS
        )
        assert views_on(page) == 0
        page.keyboard.press("c")
        wait_for_views(page, 1)
        page.close()
        _, err = program.end()
        assert "Traceback" not in err, err
    finally:
        program.process.kill()


def test_another_pose_and_another_method_are_chosen_while_running(
    chromium: Any, tmp_path: Path
) -> None:
    """From the page to the session and back: another target; a refusal is said in a sentence."""
    # A slow hand, so that the target stands while we choose.
    program = Program(
        tmp_path, "sim", "--autopilot", "--speed", "0.3", "--seed", "1", "--port", "8272"
    )
    try:
        page = chromium.new_page(viewport={"width": 1280, "height": 720})
        page.set_default_timeout(_PATIENCE_MS)
        page.goto(program.url)
        page.get_by_text("nearly as good").wait_for()
        before = page.inner_text(".v-reason")
        page.keyboard.press("j")
        page.wait_for_function(
            "old => document.querySelector('.v-reason').innerText !== old", arg=before
        )
        assert "poses were looked at" in page.inner_text(".v-reason")

        def pick(box: str, words: str) -> None:
            page.get_by_role("combobox", name=box).click()
            page.get_by_role("option", name=words, exact=True).click()

        page.get_by_text("How the next pose is found").click()
        pick("Method", METHOD_WORDS["random"])
        page.wait_for_function(
            "!document.querySelector('.v-reason').innerText.includes('looked at')"
        )
        pick("Makes small", COST_WORDS["sum-iod"])
        page.wait_for_selector(".v-note:has-text('The method random does not search')")
        page.close()
        _, err = program.end()
        assert "Traceback" not in err, err
    finally:
        program.process.kill()

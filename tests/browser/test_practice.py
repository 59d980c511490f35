"""Practice in a real browser: two tabs that do not disturb each other; the board is dragged."""

from __future__ import annotations

import csv
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.ports import free_port

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture
def practice(tmp_path: Path) -> Iterator[str]:
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "venus3d", "practice"),
            *("--output", str(tmp_path), "--port", str(free_port())),
        ],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    assert process.stdout is not None
    try:
        yield next(f.group() for line in process.stdout if (f := re.search(r"http://\S+", line)))
        process.send_signal(signal.SIGTERM)
        assert process.wait(timeout=30) == 0
    finally:
        process.kill()


def opened(chromium: Any, url: str) -> Any:
    tab = chromium.new_page(viewport={"width": 1280, "height": 720})
    tab.set_default_timeout(60_000)
    tab.goto(url)
    tab.wait_for_selector(".v-do")
    return tab


def until(tab: Any, text: str) -> None:
    tab.wait_for_function("t => document.body.innerText.includes(t)", arg=text)


def test_two_trainees_each_move_their_own_board(
    chromium: Any, practice: str, tmp_path: Path
) -> None:
    """Keys, a level and a drag in the camera's view of one tab leave the other one as it was."""
    one, other = opened(chromium, practice), opened(chromium, practice)
    before = other.inner_text(".v-do")
    one.keyboard.press("6")
    until(one, "everything has to change")
    one.keyboard.press("l")
    until(one, "2 mm")
    one.keyboard.press("v")
    one.wait_for_function("() => document.body.innerText.includes('✓ Camera')")
    distance = one.locator("input.mantine-NumberInput-input").nth(3)
    # Flying into the camera takes a moment; dragging beside the board would only turn the view.
    for _ in range(20):
        one.mouse.move(600, 340)
        one.mouse.down()
        one.mouse.move(620, 340, steps=3)
        one.mouse.move(660, 340, steps=6)
        one.mouse.up()
        if float(distance.input_value()) > 10:
            break
        one.wait_for_timeout(300)
    assert float(distance.input_value()) > 10, "dragged to the right in the projection"
    assert other.inner_text(".v-do") == before
    one.keyboard.press("g")
    until(one, "given up")
    with (tmp_path / "practice.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert (row["level"], row["outcome"], row["moved_by"]) == ("6", "given up", "keys picture")
    one.close()
    other.close()

"""A trial in a real browser: each help shows itself and nothing of the others."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.ports import free_port

pytestmark = [pytest.mark.browser, pytest.mark.slow]

_PATIENCE_MS = 90_000


class Trial:
    """`venus3d trial sim` with the simulated hand, two poses a help."""

    def __init__(self, start: Callable[..., Any], folder: Path) -> None:
        self.path = folder / "trial.csv"
        self.program = start(
            *("trial", "sim", "--participant", "Anna <A>", "--poses", "2"),
            *("--camera-size", "640x360", "--speed", "4"),
            *("--output", str(folder), "--port", str(free_port())),
        )

    @property
    def rows(self) -> list[dict[str, str]]:
        with self.path.open(newline="") as file:
            return list(csv.DictReader(file))


@pytest.fixture
def trial(start: Callable[..., Any], tmp_path: Path) -> Trial:
    return Trial(start, tmp_path)


@pytest.fixture
def page(chromium: Any, trial: Trial) -> Iterator[Any]:
    tab = chromium.new_page(viewport={"width": 1280, "height": 720})
    tab.set_default_timeout(_PATIENCE_MS)
    tab.goto(trial.program.url)
    wait_for_next(tab, "the four steps")
    yield tab
    tab.close()


def wait_for_next(tab: Any, name: str) -> None:
    tab.wait_for_selector(f".v-card b:has-text('Next: {name}. Press Start when ready.')")


def shown(tab: Any, selector: str) -> bool:
    return bool(tab.locator(selector).first.is_visible())


def test_each_help_shows_itself_and_nothing_of_the_others(page: Any, trial: Trial) -> None:
    """Nobody moves the board here, so every pose is given up; the page stops between helps."""
    assert "Anna <A>" in page.inner_text(".v-participant")
    for help_, name in (("steps", "the axes"), ("axes", "the filled outline"), ("outline", "")):
        assert not shown(page, ".v-chips") and not shown(page, ".v-count")
        page.keyboard.press("Space")
        page.wait_for_selector(".v-count:has-text('1 of 2')")
        if help_ == "steps":
            page.wait_for_selector(".v-title:has-text('Step 1 of 4')")
            page.wait_for_selector(".v-tile")
            assert not shown(page, ".v-card")
        else:
            word = {"axes": "dashed X' Y' Z'", "outline": "covered"}[help_]
            page.wait_for_selector(f'.v-key-line:has-text("{word}")')
            assert not shown(page, ".v-tile") and not shown(page, ".v-chips")
            assert not shown(page, ".v-title"), "the text of the steps"
            assert "Target" not in page.inner_text("body"), "the target's label in the scene"
        page.keyboard.press("g")
        page.wait_for_selector(".v-count:has-text('2 of 2')")
        page.keyboard.press("g")
        if name:
            wait_for_next(page, name)
    page.wait_for_selector(".v-times")
    assert str(trial.path) in page.inner_text(".v-path")
    assert not shown(page, "button:has-text('Start')")
    out, err = trial.program.end()
    assert trial.program.process.returncode == 0 and "Traceback" not in err, err
    assert [(row["help"], row["pose"], row["outcome"]) for row in trial.rows] == [
        (help_, pose, "given up") for help_ in ("steps", "axes", "outline") for pose in "12"
    ]
    assert {row["moved_by"] for row in trial.rows} == {"person"}
    assert "Anna <A>" in out and str(trial.path) in out


def test_a_trial_that_is_broken_off_goes_on_and_the_times_stay(
    page: Any, chromium: Any, start: Callable[..., Any], trial: Trial, tmp_path: Path
) -> None:
    """A pose stands in the file as soon as it is done with; reload and restart lose nothing."""
    page.keyboard.press("Shift+P")  # the simulated hand takes the board
    page.keyboard.press("Space")
    page.wait_for_selector(".v-count:has-text('2 of 2')")
    # The hand may have reached the second one by now.
    assert (trial.rows[0]["pose"], trial.rows[0]["outcome"]) == ("1", "reached")
    assert trial.rows[0]["moved_by"] == "autopilot" and float(trial.rows[0]["overlap"]) > 0.85
    page.reload()
    wait_for_next(page, "the axes")
    trial.program.kill()
    again = Trial(start, tmp_path)
    tab = chromium.new_page(viewport={"width": 1280, "height": 720})
    tab.set_default_timeout(_PATIENCE_MS)
    tab.goto(again.program.url)
    wait_for_next(tab, "the axes")
    assert "Help 2 of 3" in tab.inner_text(".v-what")
    tab.close()
    assert "Not finished" in again.program.end()[0]

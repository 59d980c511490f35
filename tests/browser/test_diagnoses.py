"""What makes the numbers doubtful, in a real browser: seen when there is something, else absent."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.guidance.convergence import Convergence
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.scene.pages.guide.texts import DIAGNOSIS_TITLES
from venus3d.scene.pages.guide.viewer import Viewer

pytestmark = [pytest.mark.browser, pytest.mark.slow]

Open = Callable[[], Any]
PARALLEL = Diagnosis("parallel-views", "The views differ by only 7° in <tilt>.", "Tilt it more.")
UNSEEN = Diagnosis("unseen-side", "No corner in the left 31 %.", "Go to the left.")
DEPTH = Diagnosis("same-depth", "Always about 45 cm away.", "Come nearer.")
MARKERS = Diagnosis("wrong-dictionary", "Markers of DICT_4X4_1000.", "Start with another one.")
LAYOUT = Diagnosis("wrong-layout", "The layout used before OpenCV 4.6.", "Start with --legacy.")


def test_diagnoses_come_with_cause_and_cure_and_go(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """At most two are told; the rest is counted. Nothing is left when there is nothing to say."""
    viewer.show(guiding)
    page = open_page()
    page.wait_for_selector(".v-big")
    assert page.locator("[data-panel=diagnoses]").count() == 0
    viewer.show(replace(guiding, diagnoses=(PARALLEL, UNSEEN, DEPTH)))
    page.wait_for_selector("[data-kind='parallel-views']")
    assert page.locator(".v-diagnosis").count() == 2
    told = page.inner_text("[data-panel=diagnoses]")
    for diagnosis in (PARALLEL, UNSEEN):
        assert diagnosis.cause in told and diagnosis.cure in told
        assert DIAGNOSIS_TITLES[diagnosis.kind] in told
    assert "and 1 more" in told and DEPTH.cause not in told
    box = page.locator("[data-panel=diagnoses]").bounding_box()
    assert box["x"] >= 0 and box["y"] + box["height"] <= 720, "within the smallest screen"
    assert page.evaluate(
        "[...document.querySelectorAll('.v-diagnosis')].every(e => e.scrollWidth <= e.clientWidth)"
    ), "nothing is cut off"
    viewer.show(guiding)
    page.wait_for_selector("[data-panel=diagnoses]", state="detached")


def test_how_bad_it_is_can_be_read_without_colours(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    """A sign and a word."""
    viewer.show(replace(guiding, diagnoses=(PARALLEL, LAYOUT)))
    page = open_page()
    for kind, word, sign in (("parallel-views", "Weak:", "!"), ("wrong-layout", "Note:", "i")):
        named = page.wait_for_selector(f"[data-kind='{kind}'] .v-named").inner_text()
        assert word in named and sign in named.split(word)[0]
    lost = replace(
        guiding,
        phase="startup",
        calibration=None,
        pose=None,
        match=None,
        target=None,
        remaining=None,
    )
    viewer.show(replace(lost, diagnoses=(MARKERS,)))
    named = page.wait_for_selector("[data-kind='wrong-dictionary'] .v-named").inner_text()
    assert "Wrong:" in named and "✕" in named
    # Nobody is asked to go on showing a board that cannot be read.
    page.wait_for_selector(".v-title:has-text('another board')")
    assert page.inner_text(".v-sentence") == MARKERS.cure


def test_a_doubtful_result_is_not_called_calibrated(
    viewer: Viewer, open_page: Open, guiding: Snapshot
) -> None:
    settled = replace(
        guiding,
        phase="converged",
        target=None,
        match=None,
        remaining=None,
        convergence=Convergence(np.full(9, 0.99), (True,) * 9, "repaired"),
    )
    viewer.show(replace(settled, diagnoses=(LAYOUT,)))
    page = open_page()
    page.wait_for_selector(".v-title:has-text('Done')")
    viewer.show(replace(settled, diagnoses=(PARALLEL, LAYOUT)))
    page.wait_for_selector(".v-title:has-text('do not trust it yet')")
    assert page.inner_text(".v-sentence") == PARALLEL.cure

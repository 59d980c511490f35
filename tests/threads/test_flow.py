"""How many pictures a second, how old, and how many were left out."""

from __future__ import annotations

import pytest

from venus3d.threads.flow import Flow


def test_rates_ages_and_what_was_left_out():
    now_s = [0.0]
    flow = Flow(lambda: now_s[0])
    for frame in range(300):
        now_s[0] = frame / 30
        flow.note("came")
        if frame % 3 == 0:
            flow.note("searched")
        if frame % 2 == 0:
            flow.note_sent(now_s[0] - 0.04)
    figures = flow.figures(damaged=2)
    assert figures.per_second == pytest.approx({"came": 30, "searched": 10, "sent": 15}, abs=0.3)
    assert figures.age_s == pytest.approx(0.04)
    assert (figures.came, figures.skipped, figures.damaged) == (300, 200, 2)
    now_s[0] += 10
    assert flow.figures().per_second["came"] == 0

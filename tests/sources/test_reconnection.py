"""When a source that is gone is opened again, by a clock of the test's own."""

from __future__ import annotations

import pytest

from venus3d.sources.reconnection import Reconnection


class Clock:
    now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def run(connection: Reconnection, clock: Clock, until_s: float, **seen: bool) -> list[float]:
    """Observe ten times a second; the moments at which the source was to be opened."""
    opened: list[float] = []
    while clock.now_s < until_s:
        if connection.observe(picture=False, alive=seen.get("alive", False), reason="unplugged"):
            opened.append(round(clock.now_s, 1))
        clock.now_s = round(clock.now_s + 0.1, 1)
    return opened


def test_a_source_that_is_gone_is_tried_for_ever_and_ever_more_seldom():
    clock = Clock()
    connection = Reconnection(5.0, 13.0, clock)
    opened = run(connection, clock, 200.0)
    # Each try fails at once, which is seen a tenth of a second later.
    waits = [round(b - a, 1) for a, b in zip([100.0, *opened], opened, strict=False)]
    assert waits[:5] == pytest.approx([0.5, 1.1, 2.1, 4.1, 10.1], abs=0.11)
    assert set(waits[5:]) == {10.1}
    outage = connection.outage
    assert outage is not None and outage.silent_s == pytest.approx(100)
    assert outage.tries == len(opened) and outage.reason == "unplugged"
    assert 0 <= outage.next_try_s <= 10
    assert not connection.observe(picture=True, alive=True) and connection.outage is None
    again = run(connection, clock, clock.now_s + 0.7)
    assert len(again) == 1, "the next outage begins with the short delays"


def test_a_connection_that_is_silent_is_given_up_but_not_after_a_pause():
    clock = Clock()
    connection = Reconnection(5.0, 13.0, clock)
    assert run(connection, clock, 104.9, alive=True) == [] and connection.outage is None
    clock.now_s = 700.0
    connection.resume()
    assert run(connection, clock, 704.9, alive=True) == [] and connection.outage is None
    assert run(connection, clock, 706.0, alive=True) == pytest.approx([705.5], abs=0.11)


def test_a_try_that_hangs_is_given_up_too():
    clock = Clock()
    connection = Reconnection(5.0, 13.0, clock)
    first, second = run(connection, clock, 120.5, alive=True)
    assert second - first == pytest.approx(13 + 1, abs=0.21)

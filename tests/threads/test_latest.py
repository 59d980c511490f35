"""The one-slot box: the newest value wins, nobody waits for ever."""

from __future__ import annotations

import threading

from venus3d.threads.latest import Latest


def test_a_late_reader_gets_the_newest_value_once():
    box: Latest[int] = Latest()
    for value in range(5):
        box.put(value)
    assert box.take(0) == 4
    assert box.take(0) is None
    assert box.peek() == 4


def test_take_waits_for_a_value_of_another_thread():
    box: Latest[str] = Latest()
    asked = threading.Event()

    def writer() -> None:
        asked.wait()
        box.put("there")

    thread = threading.Thread(target=writer)
    thread.start()
    asked.set()
    assert box.take(timeout=30) == "there"
    thread.join()


def test_closing_wakes_the_reader_and_keeps_the_last_value():
    box: Latest[int] = Latest()
    taken: list[int | None] = []
    thread = threading.Thread(target=lambda: taken.append(box.take()))
    thread.start()
    box.close()
    thread.join(timeout=30)
    assert not thread.is_alive() and taken == [None]

    box = Latest()
    box.put(1)
    box.close()
    box.close()
    box.put(2)
    assert box.closed and box.take() == 1 and box.take() is None


def test_values_never_run_backwards():
    """A reader slower than the writer skips values, but sees them in order, the last included."""
    box: Latest[int] = Latest()

    def write() -> None:
        for value in range(5000):
            box.put(value)
        box.close()

    thread = threading.Thread(target=write)
    thread.start()
    seen: list[int] = []
    while (value := box.take(timeout=30)) is not None:
        seen.append(value)
    thread.join()
    assert seen == sorted(set(seen)) and seen[-1] == 4999

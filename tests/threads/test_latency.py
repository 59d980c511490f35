"""What is asked of Python while a page is served, and given back after it."""

from __future__ import annotations

import gc
import sys
import weakref

from venus3d.threads.latency import low_latency


class Ring:
    """Garbage that only the collector finds."""

    def __init__(self) -> None:
        self.me = self


def test_what_is_there_is_left_out_and_what_comes_is_collected() -> None:
    before, frozen = sys.getswitchinterval(), gc.get_freeze_count()
    early = Ring()
    seen_early = weakref.ref(early)
    with low_latency():
        assert sys.getswitchinterval() < 0.001
        assert gc.get_freeze_count() > frozen + 1000
        late = Ring()
        seen_late = weakref.ref(late)
        del early, late
        gc.collect()
        assert seen_early() is not None, "was there at the start: not looked at"
        assert seen_late() is None
    gc.collect()
    assert seen_early() is None
    assert sys.getswitchinterval() == before

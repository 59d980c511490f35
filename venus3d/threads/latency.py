"""Keeps the latency of waiting threads low while the process computes."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager

_SWITCH_S = 0.0005


def limit_gl_threads() -> None:
    """Keep OpenGL's software renderer from using all cores for one image.

    Each image takes up to half as long again, but motion is smoother. Mesa reads this when the
    first context is opened, so call it before; graphics hardware ignores it.
    """
    ours = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    os.environ.setdefault("LP_NUM_THREADS", str(max(1, (ours or 1) - 1)))


@contextmanager
def low_latency() -> Generator[None, None, None]:
    """Context in which computation does not delay drawing for long.

    By default a thread that computes keeps the interpreter for 5 ms, and a garbage collection over
    all the libraries' objects stops every thread for 100 ms. Here the switch interval is shorter,
    and objects that exist at the start are excluded from collection.
    """
    before = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_S)
    gc.collect()
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()
        sys.setswitchinterval(before)

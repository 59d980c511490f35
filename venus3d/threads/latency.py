"""How soon a waiting thread gets its turn while the same process computes."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Generator
from contextlib import contextmanager

_SWITCH_S = 0.0005


def limit_gl_threads() -> None:
    """Keep OpenGL, where it draws on the processor, from taking all cores for one picture.

    Each picture takes up to half as long again; what moves is the better for it. Mesa reads this
    when the first context is opened, so it is called before; graphics hardware does not heed it.
    """
    ours = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    os.environ.setdefault("LP_NUM_THREADS", str(max(1, (ours or 1) - 1)))


@contextmanager
def low_latency() -> Generator[None, None, None]:
    """While this lasts, nothing that computes holds up what draws for long.

    Half a dozen threads have a few milliseconds of work each; by default one that computes keeps
    the interpreter for 5 ms from the others. And now and then Python looks for garbage among
    everything that the libraries have ever made: 100 ms in which no thread runs. What is there when
    a page begins stays until it ends, so it is left out of that.
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

"""Waiting for what another thread or program does."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE_S = 30.0
"""Long enough for a busy machine; whoever waits goes on as soon as it is there."""


def wait_until(
    condition: Callable[[], object], what: str = "it never came", within_s: float = PATIENCE_S
) -> None:
    """Return once the condition is true; fail if it is not within so many seconds."""
    end = time.monotonic() + within_s
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"not within {within_s:g} s: {what}")
        time.sleep(0.005)

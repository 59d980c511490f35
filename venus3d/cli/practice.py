"""`venus3d practice`."""

from __future__ import annotations

from venus3d.app.practice import run_practice
from venus3d.options import PracticeOptions


def practice(options: PracticeOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for a user's mistake."""
    options.check()
    run_practice(options)

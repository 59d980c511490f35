"""`venus3d practice`."""

from __future__ import annotations

from venus3d.scene.pages.exercise.options import PracticeOptions
from venus3d.scene.pages.exercise.practice_run import run_practice


def practice(options: PracticeOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for a user's mistake."""
    run_practice(options)

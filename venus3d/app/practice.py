"""The practice page."""

from __future__ import annotations

from venus3d.options import PracticeOptions


def run_practice(options: PracticeOptions) -> None:
    """Serve the page until Ctrl-C."""
    raise NotImplementedError(options)

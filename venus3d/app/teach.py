"""The teach page."""

from __future__ import annotations

from venus3d.options import TeachOptions


def run_teach(options: TeachOptions) -> None:
    """Serve the page until Ctrl-C."""
    raise NotImplementedError(options)

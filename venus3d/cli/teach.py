"""`venus3d teach`."""

from __future__ import annotations

from venus3d.app.teach import run_teach
from venus3d.options import TeachOptions


def teach(options: TeachOptions) -> None:
    """Serve the page until Ctrl-C. Raises `VenusError` for a user's mistake."""
    options.check()
    run_teach(options)

"""The whole program, which says on stdout after each calibration how many views it has.

    python -m tests.cli.watched guide sim --headless ...

With BREAK="where:views" in the environment something raises there once there are so many views.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from venus3d.cli import main
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.work import Work
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.sim import Simulation

_PLACES: dict[str, tuple[Any, str]] = {
    "source": (Simulation, "read"),
    "detector": (BoardTracker, "track"),
    "drawing": (Viewer, "show"),
    "search": (Work, "run"),
}
_views = 0


def _after(owner: Any, name: str, act: Callable[[], None]) -> None:
    plain = getattr(owner, name)

    def done(*arguments: Any, **options: Any) -> Any:
        result = plain(*arguments, **options)
        act()
        return result

    setattr(owner, name, done)


def _tell() -> None:
    # To the descriptor: a terminal may be gone, and what is told here is no part of the program.
    with suppress(OSError):
        os.write(1, f"views {_views}\n".encode())


def _watch() -> None:
    apply = Session.apply

    def applied(session: Session, outcome: Any) -> Any:
        global _views
        snapshot = apply(session, outcome)
        _views = len(snapshot.views)
        _tell()
        return snapshot

    Session.apply = applied  # type: ignore[method-assign]


def _break(where: str, views: int) -> None:
    def act() -> None:
        if _views < views:
            return
        if where == "search":
            print("searching", flush=True)
            time.sleep(600)  # until somebody interrupts it
        raise RuntimeError("boom")

    _after(*_PLACES[where], act)


if __name__ == "__main__":
    _watch()
    if "BREAK" in os.environ:
        place, _, count = os.environ["BREAK"].partition(":")
        _break(place, int(count))
    sys.exit(main())

"""The whole program, which says on stdout after each calibration how many views it has.

    python -m tests.cli.watched guide sim --headless ...

With BREAK="where:views" in the environment something raises there once there are so many views, in
whatever process that is; a search never ends with more.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import Any

# Imported only where they are needed: the process that searches reads this module, too.
_PLACES = {
    "source": ("venus3d.sources.sim", "Simulation", "read"),
    "detector": ("venus3d.sources.board_tracker", "BoardTracker", "track"),
    "drawing": ("venus3d.scene.pages.guide.viewer", "Viewer", "show"),
    "search": ("venus3d.engine.guidance.work", "Work", "run"),
}
_REACHED = "BREAK_REACHED"
_views = 0


def _after(where: str, act: Callable[[Any], None]) -> None:
    module, name, method = _PLACES[where]
    owner = getattr(import_module(module), name)
    plain = getattr(owner, method)

    def done(self: Any, *arguments: Any, **options: Any) -> Any:
        result = plain(self, *arguments, **options)
        act(self)
        return result

    setattr(owner, method, done)


def _tell() -> None:
    # To the descriptor: a terminal may be gone, and what is told here is no part of the program.
    with suppress(OSError):
        os.write(1, f"views {_views}\n".encode())


def _watch() -> None:
    from venus3d.engine.guidance.session import Session

    apply = Session.apply

    def applied(session: Session, outcome: Any) -> Any:
        global _views
        snapshot = apply(session, outcome)
        _views = len(snapshot.views)
        _reach(_views)
        _tell()
        return snapshot

    Session.apply = applied  # type: ignore[method-assign]


def _break(where: str, views: int) -> None:
    def search_on(work: Any) -> None:
        if len(work.observations) > views:
            print("searching", flush=True)
            time.sleep(600)  # until somebody interrupts it

    def fail(_: Any) -> None:
        # The process that detects does not know the session's views: a file tells it.
        if _views >= views or Path(os.environ[_REACHED]).exists():
            raise RuntimeError("boom")

    if __name__ == "__main__":
        os.environ[_REACHED] = str(Path(tempfile.mkdtemp()) / "reached")
    _after(where, search_on if where == "search" else fail)


def _reach(views: int) -> None:
    _, _, count = os.environ.get("BREAK", "").partition(":")
    if count and views >= int(count):
        Path(os.environ[_REACHED]).touch()


if __name__ in ("__main__", "__mp_main__") and "BREAK" in os.environ:
    place, _, count = os.environ["BREAK"].partition(":")
    _break(place, int(count))

if __name__ == "__main__":
    from venus3d.cli import main

    _watch()
    sys.exit(main())

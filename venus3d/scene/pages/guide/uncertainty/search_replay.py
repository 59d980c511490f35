"""Chooses the part of a search to replay: each new target's search once, slowly. `search_shapes`
draws it. Used by the drawing thread."""

from __future__ import annotations

import time
from collections.abc import Callable

from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.search_trace import SearchTrace
from venus3d.render.board_mesh import board_outline
from venus3d.render.palette import ground
from venus3d.render.shapes import Shape
from venus3d.scene.pages.guide.uncertainty import texts
from venus3d.scene.pages.guide.uncertainty.search_shapes import (
    REST_SECONDS,
    SECONDS,
    caption,
    search_shapes,
    shown_after,
)

_WHOLE = SECONDS + REST_SECONDS
_KEPT = "/camera/"


class SearchReplay:
    """The replay on one page."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` returns seconds."""
        self._clock = clock
        self._search_trace: SearchTrace | None = None
        self._began = 0.0
        self.caption = ""
        """One line on the search shown in the scene; empty for none."""

    @property
    def is_moving(self) -> bool:
        """Whether a search is being replayed."""
        return self._search_trace is not None and self._clock() - self._began < _WHOLE

    def of(
        self, snapshot: Snapshot, shapes: tuple[Shape, ...], *, on: bool, dark: bool
    ) -> tuple[Shape, ...]:
        """The scene's shapes; a replayed search replaces all but the camera. A new search starts;
        switching off and on restarts it."""
        self.caption = ""
        target, search_trace = snapshot.target, snapshot.search_trace
        if not on or target is None or search_trace is None:
            self._search_trace = None
            if on and target is not None:
                self.caption = texts.SEARCH_NOTHING
            return shapes
        if search_trace is not self._search_trace:
            self._search_trace, self._began = search_trace, self._clock()
        if not self.is_moving:
            return shapes
        shown = shown_after(search_trace, self._clock() - self._began)
        in_px = target.cost == "projection-variance"
        self.caption = caption(search_trace, shown, target.number, in_px=in_px)
        search = search_shapes(search_trace, shown, snapshot.board, dark)
        calm = tuple(shape for shape in shapes if shape.name.startswith(_KEPT))
        if snapshot.pose is None:
            return (*calm, *search)
        # Only its outline: the printed board would hide the dots behind it.
        live = board_outline(snapshot.board, snapshot.pose, "/search/live", ground(dark).text)
        return (*calm, *search, live)

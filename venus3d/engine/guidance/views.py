"""The captured views: permanently numbered, each with the target it was taken at. A view counts
once it is kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import VenusError
from venus3d.engine.planning.target import Target
from venus3d.engine.sentences import Sentence, said_by

_NOT_CAPTURED = Sentence("This view was not captured: {error}")
_RETRY_FRAMES = 50
"""Frames until a view that could not be kept is tried again by itself."""


@dataclass(frozen=True, eq=False)
class CapturedView:
    """One captured view."""

    number: int
    observation: Observation
    target: Target | None
    """The target whose prediction is compared with the view; None if it was not taken at one."""


class Keeping(Protocol):
    """The keeping of one view. A `concurrent.futures.Future` is one."""

    def done(self) -> bool:
        """Whether `result` would return or raise at once."""
        ...

    def result(self) -> None:
        """Wait until the view is kept. Raises `VenusError` if it cannot be kept."""
        ...


class CapturedViews:
    """All views of a session, in order. Used by one thread."""

    def __init__(self, views: Sequence[CapturedView] = (), next_number: int = 1) -> None:
        self.views: list[CapturedView] = list(views)
        self.next_number = next_number
        """Number of the next view."""
        self.not_kept: str = ""
        """Why the last one was not captured; empty if it was."""
        self._new: CapturedView | None = None
        self._keeping: tuple[CapturedView, Keeping] | None = None
        self._retry_at = 0

    @property
    def is_keeping(self) -> bool:
        """Whether a view is being kept."""
        return self._keeping is not None

    def may_keep(self, frame: int) -> bool:
        """Whether a view may be captured by itself in this frame of the session."""
        return self._keeping is None and frame >= self._retry_at

    def keep(self, view: CapturedView, keeping: Keeping) -> None:
        """A view of the next number is being kept."""
        self._keeping = view, keeping

    def add_kept(self, frame: int, *, wait: bool) -> bool:
        """Add the view that is kept by this frame of the session; `wait` for it. Whether there was
        one. Its image is not stored; `take_new` returns it once."""
        if self._keeping is None or not (wait or self._keeping[1].done()):
            return False
        (view, keeping), self._keeping = self._keeping, None
        try:
            keeping.result()
        except VenusError as error:
            self.not_kept = _NOT_CAPTURED.format(error=said_by(error))
            self._retry_at = frame + _RETRY_FRAMES
            return False
        self.not_kept, self._new = "", view
        self.views.append(replace(view, observation=view.observation.without_image()))
        self.next_number = view.number + 1
        return True

    def take_new(self) -> CapturedView | None:
        """The last view added, with its image, returned once; None if it was dropped meanwhile."""
        view, self._new = self._new, None
        return view

    def drop(self, number: int) -> int | None:
        """Remove the view with this number; returns its index, None if there is none."""
        places = [place for place, view in enumerate(self.views) if view.number == number]
        if not places:
            return None
        del self.views[places[0]]
        if self._new is not None and self._new.number == number:
            self._new = None
        # Predictions that included this view are no longer valid.
        self.views[places[0] :] = [replace(view, target=None) for view in self.views[places[0] :]]
        return places[0]

    @property
    def usual_sharpness(self) -> float:
        """Median of the views' sharpness; NaN without any that was measured."""
        known = [seen for view in self.views if (seen := view.observation.sharpness) > 0]
        return float(np.median(known)) if known else float("nan")

    def has(self, observation: Observation) -> bool:
        """Whether the last view is this observation."""
        return bool(self.views) and self.views[-1].observation.corners is observation.corners

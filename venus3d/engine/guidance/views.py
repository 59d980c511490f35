"""The captured views: permanently numbered, each with the target it was taken at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.planning.target import Target


@dataclass(frozen=True, eq=False)
class CapturedView:
    """One captured view."""

    number: int
    observation: Observation
    target: Target | None
    """The target whose prediction is compared with the view; None if it was not taken at one."""


class CapturedViews:
    """All views of a session, in order. Used by one thread."""

    def __init__(self, views: Sequence[CapturedView] = (), next_number: int = 1) -> None:
        self.views: list[CapturedView] = list(views)
        self.next_number = next_number
        """Number of the next view."""
        self._new: CapturedView | None = None

    def add(self, view: CapturedView) -> None:
        """Add a view of the next number. Its image is not stored; `take_new` returns it once."""
        self._new = view
        self.views.append(replace(view, observation=view.observation.without_image()))
        self.next_number = view.number + 1

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

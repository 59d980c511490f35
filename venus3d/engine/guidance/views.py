"""The views captured so far: numbered once and for all, each with the target it was taken at."""

from __future__ import annotations

from dataclasses import dataclass, replace

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.planning.target import Target


@dataclass(frozen=True, eq=False)
class CapturedView:
    """One view that was taken."""

    number: int
    observation: Observation
    target: Target | None
    """Whose promise the view is to be compared with; None if it was not taken at a target."""


class CapturedViews:
    """All views of a session, in order. Used by one thread."""

    def __init__(self) -> None:
        self.views: list[CapturedView] = []
        self._next = 1
        self._new: CapturedView | None = None

    def add(self, observation: Observation, target: Target | None) -> None:
        """Add a view. It is kept without its picture, which `take_new` hands over once."""
        self._new = CapturedView(self._next, observation, target)
        self.views.append(replace(self._new, observation=observation.without_image()))
        self._next += 1

    def take_new(self) -> CapturedView | None:
        """The view added last, with its picture, once; None if it was dropped meanwhile."""
        view, self._new = self._new, None
        return view

    def drop(self, number: int) -> int | None:
        """Take the view of this number back; its place in the order, None if there is none."""
        places = [place for place, view in enumerate(self.views) if view.number == number]
        if not places:
            return None
        del self.views[places[0]]
        if self._new is not None and self._new.number == number:
            self._new = None
        # What was promised with this view among the others does not hold any more.
        self.views[places[0] :] = [replace(view, target=None) for view in self.views[places[0] :]]
        return places[0]

    def has(self, observation: Observation) -> bool:
        """Whether the last view is this very observation."""
        return bool(self.views) and self.views[-1].observation.corners is observation.corners

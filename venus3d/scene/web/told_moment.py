"""The moment that a page tells of, for the overlay of its live picture.

The picture has a loop of its own, and must not wait for the page. But an outline of the step before
beside the words of the next one would be two truths. So the overlay is that of the moment that the
page has drawn last, and when another thing is to be done, page and picture are sent together.
"""

from __future__ import annotations

import threading
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import annotate
from venus3d.scene.web.theme import Theme


class _Moment(NamedTuple):
    snapshot: Snapshot
    step: int

    @property
    def outlines(self) -> tuple[Any, ...]:
        """What the outlines stand for."""
        todo, target = self.snapshot.remaining, self.snapshot.target
        if todo is None:
            return (self.snapshot.phase,)
        return self.step, id(target), todo.from_upright, todo.is_over


class ToldMoment:
    """What a page tells; one thread tells it, two draw by it."""

    def __init__(self) -> None:
        """Nothing is told yet."""
        self._moment: _Moment | None = None
        self.lock = threading.Lock()
        """Held while a picture is drawn and shown, so that no older overlay comes after a newer."""

    @property
    def snapshot(self) -> Snapshot | None:
        """The moment; None at first."""
        return None if self._moment is None else self._moment.snapshot

    def tell(self, snapshot: Snapshot, step: int) -> bool:
        """Tell of this moment, with this step shown; returns whether the outlines on the last
        picture stand for something else."""
        before, self._moment = self._moment, _Moment(snapshot, step)
        return before is None or before.outlines != self._moment.outlines

    def annotate(self, rgb: NDArray[np.uint8], observation: Observation | None) -> None:
        """Draw target, step's end and corners on an RGB picture, in place."""
        if self._moment is not None:
            snapshot, step = self._moment
            annotate(rgb, snapshot, observation, step, Theme(True).step_colours[step - 1])

"""The loop of the method with its figures: detect, calibrate, search, decompose, capture.

Each time is measured where the work is done; nothing here has a clock. Pages that explain the
method read it from the snapshot.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.guidance.convergence import Progress, last_gain
from venus3d.engine.guidance.prompts import Phase
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.planning.target import Target

LoopPart = Literal["detect", "calibrate", "search", "decompose", "capture"]
LOOP: tuple[LoopPart, ...] = ("detect", "calibrate", "search", "decompose", "capture")
"""The parts in their order; after the last the first comes again."""
_NAN = float("nan")
_DETECTIONS = 25
"""Number of pictures over which detection times are summed up: a second of a camera."""


@dataclass(frozen=True)
class Calibrated:
    """What one calibration took and gave."""

    seconds: float
    views: int
    rms_px: float


@dataclass(frozen=True)
class Loop:
    """One moment of the loop; NaN for what was not measured yet."""

    active: LoopPart | None = None
    """The part that goes on now; None when all is over. Detection goes on all the time, and is the
    active part while the board is looked for."""
    detect_s: float = _NAN
    """For one picture: the median of the newest ones, seconds."""
    corners: int = 0
    """Found in the newest picture."""
    calibrate_s: float = _NAN
    """For the last calibration, seconds."""
    views: int = 0
    """In the last calibration."""
    rms_px: float = _NAN
    """Of the last calibration, pixels."""
    search_s: float = _NAN
    """For the last search, seconds."""
    poses: int = 0
    """Evaluated by the last search; 0 if nothing was searched."""
    steps_left: int | None = None
    """Of the four steps to the target; None without one."""
    before_px: float = _NAN
    """Uncertainty in the image before the last view, pixels."""
    after_px: float = _NAN
    """The same after it."""


class LoopFigures:
    """Collects what a session's parts measure. Used by its thread, `note` by any."""

    def __init__(self) -> None:
        """Nothing measured yet."""
        self._detect_s: deque[float] = deque(maxlen=_DETECTIONS)
        self._corners = 0
        self._begun: tuple[object, Calibrated] | None = None
        self._calibrated = Calibrated(_NAN, 0, _NAN)
        self._found: Target | None = None

    def observe(self, observation: Observation) -> None:
        """A picture was looked at."""
        self._corners = observation.count
        if np.isfinite(observation.detect_s):
            self._detect_s.append(observation.detect_s)

    def note(self, work: object, calibrated: Calibrated) -> None:
        """This work has calibrated, and searches until `finish`."""
        self._begun = work, calibrated

    def finish(self, calibrated: Calibrated, found: Target | None) -> None:
        """Work is finished; `found`: the target that it searched, if any."""
        self._calibrated, self._found = calibrated, found or self._found

    def now(
        self,
        phase: Phase,
        remaining: RemainingSteps | None,
        pending: object,
        history: Sequence[Progress],
    ) -> Loop:
        """The loop at one moment; `pending`: the work that is going on, if any."""
        begun, found = self._begun, self._found
        searching = begun is not None and begun[0] is pending
        known = begun[1] if begun is not None and searching else self._calibrated
        searched = found is not None and found.evaluated > 0
        before, after = last_gain(history)
        return Loop(
            active=_active(phase, remaining, searching),
            detect_s=float(np.median(self._detect_s)) if self._detect_s else _NAN,
            corners=self._corners,
            calibrate_s=known.seconds,
            views=known.views,
            rms_px=known.rms_px,
            search_s=found.search_s if found is not None and searched else _NAN,
            poses=found.evaluated if found is not None else 0,
            steps_left=None if remaining is None else remaining.done.count(False),
            before_px=before,
            after_px=after,
        )


def _active(phase: Phase, remaining: RemainingSteps | None, searching: bool) -> LoopPart | None:
    if phase in ("converged", "finished"):
        return None
    if phase == "captured":
        return "search" if searching else "calibrate"
    if remaining is None or remaining.match is None:
        return "detect"
    return "capture" if remaining.is_over else "decompose"

"""From a frame to an observation: the detector, and where it looked last."""

from __future__ import annotations

from venus3d.engine.detection import Detector, search_region
from venus3d.engine.observation import Observation
from venus3d.sources.frame import Frame

# Fewer corners than this share of the last frame's: the board has left the region searched.
_LOST = 0.9


class Eyes:
    """Frames to observations: the detector with its memory of where the board was."""

    def __init__(self, detector: Detector) -> None:
        self.detector = detector
        self._last: Observation | None = None

    def look(self, frame: Frame) -> Observation:
        """The board in this frame; searched near its last place first, then everywhere."""
        region = None
        if self._last is not None and self.detector.settled:
            region = search_region(self._last, frame.image_size)
        seen = self._detect(frame, region)
        if region is not None and seen.count < _LOST * (self._last.count if self._last else 0):
            seen = self._detect(frame, None)
        self._last = seen if seen.count else None
        return seen

    def _detect(self, frame: Frame, region: tuple[int, int, int, int] | None) -> Observation:
        return self.detector.detect(
            frame.image, region=region, time_s=frame.time_s, name=frame.name
        )

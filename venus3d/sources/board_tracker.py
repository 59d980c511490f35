"""Detects the board from frame to frame, searching first where it was last."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Protocol

from venus3d.engine.calibration.board_reader import Region
from venus3d.engine.calibration.detection import Detector, search_region
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation
from venus3d.sources.frame import Frame
from venus3d.sources.second_board_watch import SecondBoardWatch

# Fewer corners than this share of the last frame's: the board has left the search region.
_LOST = 0.9
# A quick search that missed corners had squares too small for it in this light; this limit decays
# with every frame, as it may have been chance.
_LEARNT, _FADING = 1.25, 0.99


class Tracker(Protocol):
    """Finds the board in frame after frame."""

    @property
    def notes(self) -> tuple[str, ...]:
        """As the detector's."""
        ...

    @property
    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """As the detector's."""
        ...

    def track(self, frame: Frame) -> Observation:
        """The board in this frame, with its image and how long it took to find it."""
        ...

    def explain_misses(self) -> tuple[Diagnosis, ...]:
        """As the detector's."""
        ...

    def close(self) -> None:
        """Release all resources."""
        ...


class BoardTracker:
    """Detector with a memory of the board's position. Used by one thread."""

    def __init__(self, detector: Detector, *, look_beside: bool = False) -> None:
        """`look_beside`: look for another board beside the one detected, now and then; close it
        then."""
        self.detector = detector
        self._beside = SecondBoardWatch(detector) if look_beside else None
        self._last: Observation | None = None
        self._quick_from_px = detector.quick_from_px
        self.looked, self.shown = 0, 0
        """Frames looked at, and those of them that show the board."""

    @property
    def notes(self) -> tuple[str, ...]:
        """As the detector's."""
        return self.detector.notes

    @property
    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """As the detector's."""
        return self.detector.diagnoses

    def explain_misses(self) -> tuple[Diagnosis, ...]:
        """As the detector's."""
        return self.detector.explain_misses()

    def close(self) -> None:
        """End the looks beside the board."""
        if self._beside is not None:
            self._beside.close()

    def track(self, frame: Frame) -> Observation:
        """The board in this frame, with its image and how long it took to find it.

        Searched quickly near its last place, fully there if that finds fewer corners than in the
        last frame, and everywhere if it seems to have gone.
        """
        began = time.perf_counter()
        region, before = None, 0
        if self._last is not None and self._last.image_size != frame.image_size:
            self._last = None
        if self._last is not None and self.detector.settled:
            region, before = search_region(self._last, frame.image_size), self._last.count
        self._quick_from_px = max(self.detector.quick_from_px, _FADING * self._quick_from_px)
        # The picture may be searched so many times smaller.
        quick = int(self.detector.square_px // max(self._quick_from_px, 1.0)) if before else 0
        seen = self._detect(frame, region, quick)
        if (quick or region is not None) and seen.count < _LOST * before:
            full = self._detect(frame, None, 0)
        elif quick and seen.count < before:
            full = self._detect(frame, region, 0)
        else:
            full = seen
        # A frame in which the full search finds fewer too (motion blur) says nothing about the
        # quick one.
        if quick and seen.count < before <= full.count:
            learnt_px = _LEARNT * self.detector.square_px / quick
            self._quick_from_px = max(self._quick_from_px, learnt_px)
        self._last = full if full.count else None
        self.looked, self.shown = self.looked + 1, self.shown + (full.count > 0)
        seen = replace(full, image=frame.image, detect_s=time.perf_counter() - began)
        if self._beside is not None:
            self._beside.put(seen)
        return seen

    def _detect(self, frame: Frame, region: Region | None, quick: int) -> Observation:
        return self.detector.detect(
            frame.image, region=region, quick=quick, time_s=frame.time_s, name=frame.name
        )

"""Detects the board in every frame of a recording: a video, image files, arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import SourceError
from venus3d.sources.arrays import Arrays
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Source
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.video import Video

Images = str | Path | Sequence[str | Path] | Sequence[NDArray[np.uint8]] | NDArray[np.uint8]
"""What `open_frame_source` takes, or a list of image files, or one of arrays (H, W[, 3])."""
_COUNTED_EVERY = 100


@dataclass(frozen=True, eq=False)
class Recording:
    """The observations of a recording."""

    observations: tuple[Observation, ...]
    """One for each frame, in order; without corners where the board was not found."""
    notes: tuple[str, ...]
    """The source's notes."""
    is_video: bool


def observe_recording(
    images: Images, detector: Detector, on_count: Callable[[int], None] | None = None
) -> Recording:
    """Detect the board in every frame of a recording.

    Args:
        images: see `Images`.
        detector: learns the board's layout as it goes.
        on_count: called with the number of frames searched, every hundred frames.

    Raises `SourceError` for what cannot be read, and for a live camera, which has no end.
    """
    recording = _observe(images, detector, on_count)
    # Frames read before the layout was determined are read again.
    if any(o.board != detector.board for o in recording.observations):
        recording = _observe(images, detector, on_count)
    return recording


def _observe(
    images: Images, detector: Detector, on_count: Callable[[int], None] | None
) -> Recording:
    observations: list[Observation] = []
    with closing(_opened(images)) as source:
        if source.is_live:
            raise SourceError(
                "A live camera has no end to wait for; use venus3d guide for it, or record a "
                "video first."
            )
        while (frame := source.read()) is not None:
            observations.append(detector.detect(frame.image, time_s=frame.time_s, name=frame.name))
            if on_count is not None and len(observations) % _COUNTED_EVERY == 0:
                on_count(len(observations))
        return Recording(tuple(observations), tuple(source.notes), isinstance(source, Video))


def _opened(images: Images) -> Source:
    if isinstance(images, (str, Path)):
        return open_frame_source(str(images))
    arrays = [image for image in images if isinstance(image, np.ndarray)]
    files = [Path(image) for image in images if isinstance(image, (str, Path))]
    if len(arrays) == len(images):
        return Arrays(arrays)
    if len(files) == len(images):
        return Folder(files)
    raise SourceError("Images are either all files or all arrays (H, W) or (H, W, 3).")

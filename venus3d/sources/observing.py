"""A whole recording, looked at once: what is seen of the board in every frame.

Which of the frames are worth keeping is left to `engine.selection` and to the study.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import Board
from venus3d.sources.opening import open_source
from venus3d.sources.video import Video

_TOLD_EVERY = 100


@dataclass(frozen=True, eq=False)
class Recording:
    """What a recording shows of the board."""

    observations: tuple[Observation, ...]
    """One for each frame, in their order; without corners where the board was not found."""
    notes: tuple[str, ...]
    """The source's: what a person should know of how the frames came."""
    is_video: bool


def observe_recording(
    spec: str, detector: Detector, on_count: Callable[[int], None] | None = None
) -> Recording:
    """Detect the board in every frame of a video, a folder or a pattern of pictures.

    Args:
        spec: what the user typed; see `open_source`.
        detector: learns the board's layout on the way.
        on_count: told of the number of frames looked at, every hundred frames.

    Raises `SourceError` for what cannot be read, and for a live camera, which has no end.
    """
    recording, boards = _observe(spec, detector, on_count)
    # The layout is found out on the way; what was read with another one is read again.
    if any(board != detector.board for board in boards):
        recording, _ = _observe(spec, detector, on_count)
    return recording


def _observe(
    spec: str, detector: Detector, on_count: Callable[[int], None] | None
) -> tuple[Recording, list[Board]]:
    boards: list[Board] = []
    observations: list[Observation] = []
    with closing(open_source(spec)) as source:
        if source.is_live:
            raise SourceError(
                "A live camera has no end to wait for; use venus3d guide for it, or record a "
                "video first."
            )
        while (frame := source.read()) is not None:
            observations.append(detector.detect(frame.image, time_s=frame.time_s, name=frame.name))
            boards.append(detector.board)
            if on_count is not None and len(observations) % _TOLD_EVERY == 0:
                on_count(len(observations))
        notes, is_video = tuple(source.notes), isinstance(source, Video)
    return Recording(tuple(observations), notes, is_video), boards

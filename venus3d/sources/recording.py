"""Detects the board in every frame of a recording: a video, image files, arrays.

Images are read and searched on all cores, a few ahead of the one whose turn it is. What they show
is taken over in their order, so the result is that of one thread.
"""

from __future__ import annotations

import os
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_recognition import some_mirrored
from venus3d.engine.calibration.dark_rim import image_circle
from venus3d.engine.calibration.detection import Beside, Detector
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import SourceError
from venus3d.sources.arrays import Arrays
from venus3d.sources.bag import Bag
from venus3d.sources.folder import Folder
from venus3d.sources.frame import Frame
from venus3d.sources.live import Live
from venus3d.sources.open_frame_source import OpenedSource, open_frame_source
from venus3d.sources.video import Video
from venus3d.sources.watched_folder import WatchedFolder

Images = str | Path | Sequence[str | Path] | Sequence[NDArray[np.uint8]] | NDArray[np.uint8]
"""What `open_frame_source` takes, or a list of image files, or one of arrays (H, W[, 3])."""
OnCount = Callable[[int, int, "int | None"], None]
"""Called with the number of frames searched, of those that show the board, and of all if known."""
_AHEAD = 2
"""Frames in work per core: while one is searched, the next is read."""
_LAG = 16
"""Frames in work at most. Whether a frame is searched quickly first is judged by 16 frames before
the last 16, so that it is the same for any number of threads."""
_MOSTLY = 0.6
"""A quick search takes less than half the time of a full one, and is enough where it finds every
corner of the board: it is tried first if more than this share of those frames shows them all."""


@dataclass(frozen=True, eq=False)
class Recording:
    """The observations of a recording."""

    observations: tuple[Observation, ...]
    """One for each frame, in order; without corners where the board was not found."""
    notes: tuple[str, ...]
    """The source's notes."""
    is_video: bool
    instead: tuple[Diagnosis, ...] = ()
    """What most images show instead of the board, if it is in less than half of them; that some
    are mirrored, however few."""


def observe_recording(
    images: Images,
    detector: Detector,
    on_count: OnCount | None = None,
    *,
    threads: int | None = None,
    flip: bool = False,
) -> Recording:
    """Detect the board in every frame of a recording.

    Args:
        images: see `Images`.
        detector: learns the board's layout as it goes.
        on_count: called after every frame; counts anew where frames have to be read again.
        threads: all cores if None; any number gives the same result.
        flip: exchange left and right in every frame.

    Raises `SourceError` for what cannot be read, and for a live camera, which has no end.
    """
    threads = threads or _cores()
    recording = _observe(images, detector, on_count, threads, flip)
    instead = _shown_instead(recording, detector)  # may make the detector read another board
    # Frames read before the layout was determined are read again.
    if any(o.board != detector.board for o in recording.observations):
        recording = _observe(images, detector, on_count, threads, flip)
        instead = _shown_instead(recording, detector)
    return replace(recording, instead=instead)


def _shown_instead(recording: Recording, detector: Detector) -> tuple[Diagnosis, ...]:
    shown = sum(o.count > 0 for o in recording.observations)
    mirrored = some_mirrored(detector.missed_images) if shown else None
    if mirrored is not None:
        return (mirrored,)
    return detector.explain_misses() if 2 * shown < len(recording.observations) else ()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def _observe(
    images: Images, detector: Detector, on_count: OnCount | None, threads: int, flip: bool
) -> Recording:
    observations: list[Observation] = []
    found = 0
    beside: list[Future[Beside | None]] = []
    with closing(_opened(images)) as source, ThreadPoolExecutor(1) as pool:
        source.flip = flip
        if isinstance(source, WatchedFolder):
            raise SourceError("A folder that is still being filled has no end; leave out watch:.")
        if isinstance(source, Live):
            raise SourceError(
                "A live camera has no end to wait for; use venus3d guide for it, or record a "
                "video first."
            )
        is_video = isinstance(source, (Video, Bag))
        for frame, seen, by in _looked_at(source, detector, threads):
            taken = detector.take_over(seen, frame.image, by)
            observations.append(replace(taken, image_circle=seen.image_circle))
            found += observations[-1].count > 0
            if taken.count and _is_looked_beside(found):
                beside.append(pool.submit(detector.look_beside, frame.image, observations[-1]))
            if on_count is not None:
                # What cannot be read counts no more.
                total = source.announced if isinstance(source, (Video, Bag)) else len(source)
                on_count(len(observations), found, total)
        if isinstance(source, Folder):
            source.check_any()
        detector.note_beside([look.result() for look in beside])
        return Recording(tuple(observations), tuple(source.notes), is_video)


def _is_looked_beside(found: int) -> bool:
    """Whether another board is looked for beside the one found for the so-manieth time: the 1st,
    3rd, 9th, 27th ... time, in a few frames from all over the recording."""
    while found % 3 == 0:
        found //= 3
    return found == 1


_Looked = tuple[Frame, Observation, Detector]
"""A frame, and what a copy of the detector saw in it."""


class _Look:
    """Reads and searches one frame after the other, on any thread."""

    def __init__(self, detector: Detector) -> None:
        self._detector, self._local = detector, threading.local()

    def __call__(self, read: Callable[[], Frame | None], quick: bool) -> _Looked | None:
        """None for a frame that cannot be read; `quick`: searched so first."""
        mine: Detector | None = getattr(self._local, "detector", None)
        if mine is None or not mine.settled:
            mine = self._local.detector = self._detector.copy()
        frame = read()
        if frame is None:
            return None
        seen = self._seen(mine, frame, quick)
        if seen.count:
            seen = replace(seen, image_circle=image_circle(frame.image))
        return frame, seen, mine

    def _seen(self, mine: Detector, frame: Frame, quick: bool) -> Observation:
        if quick and mine.settled:
            seen = mine.detect(frame.image, quick=True, time_s=frame.time_s, name=frame.name)
            if seen.count == mine.board.corner_count:
                return seen
        return mine.detect(frame.image, time_s=frame.time_s, name=frame.name)


def _looked_at(
    source: Folder | Arrays | Video | Bag, detector: Detector, threads: int
) -> Iterator[_Looked]:
    """Each frame in order that can be read."""
    look = _Look(detector)
    pool = ThreadPoolExecutor(threads, thread_name_prefix="look")
    waiting: deque[Future[_Looked | None]] = deque()
    whole: list[bool] = []
    try:
        for number, read in enumerate(_readers(source)):
            before = whole[max(0, number - 2 * _LAG) : max(0, number - _LAG)]
            waiting.append(pool.submit(look, read, sum(before) > _MOSTLY * max(1, len(before))))
            if len(waiting) >= min(_AHEAD * threads, _LAG):
                yield from _next(waiting, whole, detector)
        while waiting:
            yield from _next(waiting, whole, detector)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _next(
    waiting: deque[Future[_Looked | None]], whole: list[bool], detector: Detector
) -> Iterator[_Looked]:
    done = waiting.popleft().result()
    whole.append(done is not None and done[1].count == detector.board.corner_count)
    if done is not None:
        yield done


def _readers(source: Folder | Arrays | Video | Bag) -> Iterator[Callable[[], Frame | None]]:
    """A function for each frame that gives it: files are read by whoever looks at them, a video,
    whose frames come one after the other, is read here."""
    if isinstance(source, Folder):
        yield from source.readers()
        return
    while (frame := source.read()) is not None:
        yield partial(_same, frame)


def _same(frame: Frame) -> Frame:
    return frame


def _opened(images: Images) -> OpenedSource | Arrays:
    if isinstance(images, (str, Path)):
        return open_frame_source(str(images))
    arrays = [image for image in images if isinstance(image, np.ndarray)]
    files = [Path(image) for image in images if isinstance(image, (str, Path))]
    if len(arrays) == len(images):
        return Arrays(arrays)
    if len(files) == len(images):
        return Folder(files)
    raise SourceError("Images are either all files or all arrays (H, W) or (H, W, 3).")

"""A recorded video as a source: at its own rate, or as fast as it can be read."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.sources.frame import Frame, RealSource
from venus3d.sources.images import shown
from venus3d.sources.opencv_log import silence_opencv
from venus3d.sources.served_video import ServedVideo
from venus3d.sources.size_watch import SizeWatch

_MOST_MISSED = 1000
"""Damaged frames in a row after which a video has ended, however many it announces."""


class Video(RealSource):
    """The frames of a video file. `Frame.time_s` is the video's own time. Frames that cannot be
    decoded are left out, and `notes` says so at the end.

    A phone's rotation tag is applied, and `notes` says so: whoever reads the video with OpenCV or
    FFmpeg gets its frames turned as well, and the calibration is for those.
    """

    def __init__(
        self, path: Path | str, *, realtime: bool = False, served: ServedVideo | None = None
    ) -> None:
        """Open the file at `path`, or read what a server gives at this address. With `realtime`,
        frames come when the video's clock says so, and a late reader skips frames. Raises
        `SourceError` if no frame can be read."""
        silence_opencv()
        self._path = shown(path)
        self._realtime = realtime
        self.is_served = served is not None
        """Whether it is read from a server, which may not wait with what was opened early."""
        self._capture = served or _opened(path)
        if not self._capture.isOpened():
            raise SourceError(
                f"{self._path} cannot be played: it is no video, or it was cut off before its end "
                "was written; record or copy it again, or convert it to MP4."
            )
        self._capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 1)
        self._announced = int(max(0, self._capture.get(cv2.CAP_PROP_FRAME_COUNT)))
        self._rate = self._capture.get(cv2.CAP_PROP_FPS) or 25.0
        self._grabbed = 0  # with those left out, so that a frame's name is its place
        self._damaged = 0
        self._time_s = 0.0
        self._started: float | None = None
        self._finished = False
        # What a server sends has each frame's own size.
        self._sizes = None if served is not None else SizeWatch(path)
        self.notes: tuple[str, ...] = ()
        """Remarks for the user: the frames are turned, damaged, the file ended early."""
        self._first = self._next()
        if self._first is None:
            self.close()
            raise SourceError(
                f"No frame of {self._path} can be decoded: the file is damaged; record or copy it "
                "again."
            )
        self._size = (int(self._first.shape[1]), int(self._first.shape[0]))
        if turned_deg := int(self._capture.get(cv2.CAP_PROP_ORIENTATION_META)) % 360:
            self.notes = (
                f"{self._path} has a rotation tag: its frames are turned by {turned_deg} degrees, "
                f"as players show them, and the calibration holds for {self._size[0]} x "
                f"{self._size[1]} px.",
            )

    @property
    def announced(self) -> int | None:
        """Number of frames by the file's own account, roughly; None if it does not say."""
        return self._announced or None

    def read(self) -> Frame | None:
        """The next frame (with `realtime`: the one that is due now); None at the end."""
        if self._first is not None:
            image, self._first = self._first, None
            self._started = time.monotonic()
            return self._frame(image)
        image = self._next()
        if image is None:
            self._finish()
            return None
        self._check_size(image)
        return self._frame(image)

    def resume(self) -> None:
        """Continue from the last frame after a pause, instead of skipping by the clock."""
        self._started = time.monotonic() - self._time_s

    def close(self) -> None:
        """Release the file. May be called twice."""
        self._capture.release()
        if self._sizes is not None:
            self._sizes.close()

    def _check_size(self, image: NDArray[np.uint8]) -> None:
        here = self._grabbed, (int(image.shape[1]), int(image.shape[0]))
        change = None if self._sizes is None else self._sizes.change(self._grabbed)
        if change is None and here[1] == self._size:
            return
        frame, (width, height) = change or here
        raise SourceError(
            f"{self._path} changes its picture size to {width} x {height} px at about frame "
            f"{frame}; cut it into videos of one size each."
        )

    def _frame(self, image: NDArray[np.uint8]) -> Frame:
        return Frame(image, self._time_s, f"frame {self._grabbed}").flipped(self.flip)

    def _next(self) -> NDArray[np.uint8] | None:
        """The next frame (with `realtime`: the one that is due now); None at the end."""
        while self._grab():
            if self._realtime and self._started is not None and not self._wait_or_skip():
                return None
            # Typed loosely, as cv2's stubs do not say that frames have 8 bits.
            answer: tuple[bool, Any] = self._capture.retrieve()
            if answer[0]:
                return answer[1]
            self._damaged += 1
        return None

    def _grab(self) -> bool:
        # A damaged frame is a failure like the end, but others follow it.
        tries = min(max(0, self._announced - self._grabbed), _MOST_MISSED) + 1
        for missed in range(tries):
            if self._capture.isOpened() and self._capture.grab():
                self._damaged += missed
                self._grabbed += missed
                self._take_time()
                return True
        return False

    def _take_time(self) -> None:
        # Containers without times: use the rate. Time never runs backwards.
        told = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000
        counted = self._grabbed / self._rate
        self._grabbed += 1
        self._time_s = told if told > self._time_s else max(counted, self._time_s)

    def _wait_or_skip(self) -> bool:
        """Wait for the grabbed frame's time, or skip to the one that is due. False at the end."""
        assert self._started is not None
        elapsed = time.monotonic() - self._started
        while self._time_s + 1 / self._rate < elapsed:
            if not self._grab():
                return False
        time.sleep(max(0.0, self._time_s - elapsed))
        return True

    def _finish(self) -> None:
        if not self._finished and self._damaged:
            many = "1 frame is" if self._damaged == 1 else f"{self._damaged} frames are"
            self.notes = (*self.notes, f"In {self._path} {many} damaged and left out.")
        # Containers round their frame count, so a frame or two missing are not reported.
        if not self._finished and self._grabbed < 0.98 * self._announced - 1:
            self.notes = (
                *self.notes,
                f"{self._path} breaks off early: {self._grabbed - self._damaged} of "
                f"{self._announced} frames could be read.",
            )
        self._finished = True
        self.close()


def _opened(path: Path | str) -> cv2.VideoCapture:
    name = str(path)
    try:
        name.encode()
    except UnicodeEncodeError:
        # OpenCV ends the process at a name that is not UTF-8: it gets another name for the file.
        with tempfile.TemporaryDirectory() as folder:
            link = Path(folder, f"video{Path(name).suffix if Path(name).suffix.isascii() else ''}")
            link.symlink_to(Path(name).absolute())
            return cv2.VideoCapture(str(link))
    return cv2.VideoCapture(name)

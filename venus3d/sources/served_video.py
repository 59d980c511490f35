"""A video on a server, read once: by FFmpeg through PyAV, in the shape of OpenCV's `VideoCapture`.

PyAV and not OpenCV, which scales pictures of another size to the first one's without a word; a
second look at the file, as `size_watch` has for one on the disk, would fetch all of it twice.
"""

from __future__ import annotations

from collections.abc import Iterator

import av.error
import cv2
import numpy as np
from av.container import InputContainer
from av.video.frame import VideoFrame
from numpy.typing import NDArray


class ServedVideo:
    """The frames of an opened video, in order. Used by one thread."""

    def __init__(self, container: InputContainer) -> None:
        """Of the container's first video; closes it in the end."""
        self._container, self._stream = container, container.streams.video[0]
        self._stream.thread_type = "AUTO"
        self._frames = self._decoded()
        self._frame: VideoFrame | None = None
        self._open = True

    def isOpened(self) -> bool:
        """Until it is released."""
        return self._open

    def set(self, propId: int, value: float) -> bool:
        """Nothing can be set: frames are always turned as their tag says."""
        return False

    def get(self, propId: int) -> float:
        """Of the frame grabbed last, or of the file; 0 for what is not known."""
        rate = float(self._stream.average_rate or 0)
        match propId:
            case cv2.CAP_PROP_FPS:
                return rate
            case cv2.CAP_PROP_FRAME_COUNT:
                lasts_s = (self._container.duration or 0) / 1e6
                return float(self._stream.frames or round(lasts_s * rate))
            case cv2.CAP_PROP_POS_MSEC if self._frame is not None:
                began = (self._stream.start_time or 0) * float(self._stream.time_base or 0)
                return 1000 * ((self._frame.time or began) - began)
            case cv2.CAP_PROP_ORIENTATION_META if self._frame is not None:
                return float(-self._frame.rotation % 360)
            case _:
                return 0.0

    def grab(self) -> bool:
        """Go to the next frame; False at the end, or where the connection breaks off."""
        if not self._open:
            return False
        try:
            self._frame = next(self._frames, None)
        except (av.error.FFmpegError, OSError):
            self._frame = None
        return self._frame is not None

    def retrieve(self) -> tuple[bool, NDArray[np.uint8]]:
        """The grabbed frame (H, W, 3) BGR, turned as its tag says."""
        if self._frame is None:
            return False, np.zeros((0, 0, 3), np.uint8)
        picture = self._frame.to_ndarray(format="bgr24")
        turned = np.rot90(picture, self._frame.rotation // 90)
        return True, np.ascontiguousarray(turned, dtype=np.uint8)

    def release(self) -> None:
        """Disconnect. May be called twice."""
        if self._open:
            self._open = False
            self._container.close()

    def _decoded(self) -> Iterator[VideoFrame]:
        for packet in self._container.demux(self._stream):
            try:
                frames = packet.decode()
            except av.error.InvalidDataError:  # a damaged frame, which OpenCV skips as well
                continue
            yield from frames

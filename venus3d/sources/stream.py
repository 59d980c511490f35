"""A network stream's pictures, by FFmpeg through PyAV.

PyAV and not OpenCV's `VideoCapture`, since that one rescales pictures of another size to the first
one's without a word, and gives no sign of a damaged picture.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterator

import av
import av.error
import numpy as np
from av.container import InputContainer
from av.video.frame import VideoFrame
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError

OPEN_TIMEOUT_S = 8.0
READ_TIMEOUT_S = 5.0
_MOST_HELD = 150
"""Pictures left out at most while a key frame is waited for: a stream that renews its pictures
strip by strip has none, and is whole again by then."""
_OPTIONS = {
    # UDP would lose packets, and with them parts of pictures.
    "rtsp_transport": "tcp",
    "analyzeduration": "1000000",
}


class StreamCapture:
    """An opened stream. Used by one thread."""

    def __init__(self, address: str, container: InputContainer | None = None) -> None:
        """Read what `connected` gave, or connect to `address`. Raises `SourceError` if nothing
        answers in time."""
        self._address, self._container = address, container or connected(address)
        self._stream = self._container.streams.video[0]
        # Threads that each decode a frame of their own would hold some back, and threads that share
        # a frame don't tell of errors in it: of 39 damaged pictures they told none, a single thread
        # the first of each group, and so all.
        self._stream.thread_type = "NONE"
        # A picture that does not arrive whole is refused instead of being painted over.
        self._stream.codec_context.options = {"err_detect": "explode", "flags": "low_delay"}
        self._frames = self._decoded()
        self.damaged = 0
        """Number of pictures that came damaged and were left out."""

    def read(self) -> tuple[bool, NDArray[np.uint8]]:
        """The next whole picture (H, W, 3) BGR. Raises `SourceError` at the end, and if none comes
        for `READ_TIMEOUT_S`."""
        try:
            frame = next(self._frames, None)
        except (av.error.FFmpegError, OSError) as error:
            raise SourceError(f"{self._address} broke off ({_cause(error)}).") from error
        if frame is None:
            raise SourceError(f"{self._address} has ended.")
        return True, frame.to_ndarray(format="bgr24").astype(np.uint8, copy=False)

    def release(self) -> None:
        """Disconnect."""
        self._container.close()

    def _decoded(self) -> Iterator[VideoFrame]:
        """The whole pictures. What comes after a damaged one is predicted from it, and is left out
        as well, up to the next key frame."""
        held = 0
        whole_from = -math.inf
        for packet in self._container.demux(self._stream):
            damaged = packet.is_corrupt
            frames: list[VideoFrame] = []
            try:
                frames = packet.decode()
            except av.error.InvalidDataError:
                self.damaged += 1
                damaged = True
            damaged |= any(frame.is_corrupt for frame in frames)
            if damaged:
                held = _MOST_HELD
            elif held and packet.is_keyframe:
                held = 0
                # Pictures that were decoded before it may still be on their way.
                whole_from = -math.inf if packet.pts is None else packet.pts
            for frame in frames:
                if held or (frame.pts is not None and frame.pts < whole_from):
                    held = max(0, held - 1)
                    self.damaged += 1
                else:
                    yield frame


def connected(address: str) -> InputContainer:
    """What answers at `address`, with its first video; it has a duration if it is a file on a
    server. Raises `SourceError` if nothing answers in time."""
    options = dict(_OPTIONS)
    if not address.startswith("http"):
        # What was read to find out the format is not shown late. Of a file it is the first frames.
        options["fflags"] = "nobuffer"
    # What OpenCV would read: "key;value|key;value".
    for pair in filter(None, os.environ.get("OPENCV_FFMPEG_CAPTURE_OPTIONS", "").split("|")):
        key, _, value = pair.partition(";")
        options[key] = value
    try:
        container = av.open(address, options=options, timeout=(OPEN_TIMEOUT_S, READ_TIMEOUT_S))
        if container.streams.video:
            return container
        container.close()
        cause = None
    except (av.error.FFmpegError, ValueError, OSError) as error:
        cause = error
    raise SourceError(
        f"No stream can be opened at {address}; check the address, and that the sender runs and "
        "can be reached from this machine."
    ) from cause


def _cause(error: BaseException) -> str:
    if isinstance(error, av.error.ExitError):
        return f"nothing came for {READ_TIMEOUT_S:g} s"
    return getattr(error, "strerror", None) or type(error).__name__

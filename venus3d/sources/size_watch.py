"""Looks ahead in a video file for pictures of another size.

OpenCV scales such pictures to the first one's size without a word; for a calibration they are
another camera's. A size changes only at a key picture, so few are decoded.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import av
import av.error

_AHEAD = 32
"""Packets read ahead of the frame that is asked about: they are not in the frames' order, and not
each is looked at."""
_EVERY = 12
"""Packets between two that are looked at, where all are key pictures."""


class SizeWatch:
    """The picture sizes of one file, in its order."""

    def __init__(self, path: Path | str) -> None:
        """Watch the file at `path`; one that FFmpeg does not open has no changes."""
        self._container: Any = None
        self._packets: Iterator[Any] = iter(())
        self._read = 0
        self._looked = -_EVERY
        self._size: tuple[int, int] | None = None
        with suppress(av.error.FFmpegError, IndexError, OSError, ValueError):
            self._container = av.open(str(path))
            stream = self._container.streams.video[0]
            stream.codec_context.thread_count = 1
            self._decoder: Any = stream.codec_context
            self._packets = self._container.demux(stream)

    def change(self, frame: int) -> tuple[int, tuple[int, int]] | None:
        """About which frame comes with which other size (width, height), if one does soon after
        this frame or came before."""
        while self._read < frame + _AHEAD:
            packet = self._next()
            if packet is None:
                return None
            self._read += 1
            if packet.is_keyframe and self._read - self._looked >= _EVERY:
                self._looked = self._read
                size = self._size_of(packet)
                self._size = self._size or size
                if size is not None and size != self._size:
                    return self._read, size
        return None

    def close(self) -> None:
        """Release the file. May be called twice."""
        if self._container is not None:
            self._container.close()
            self._container, self._packets = None, iter(())

    def _next(self) -> Any:
        with suppress(av.error.FFmpegError, OSError, ValueError):
            return next(self._packets, None)
        return None

    def _size_of(self, packet: Any) -> tuple[int, int] | None:
        with suppress(av.error.FFmpegError, ValueError):
            packet.decode()
            return self._decoder.width, self._decoder.height
        return None

"""The pictures of a ROS bag as a recording: ROS 1 and 2, raw and compressed, without ROS.

Read by rosbags, an extra (`pip install "venus3d[ros]"`), since it brings five more packages.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.engine.sentences import listed
from venus3d.sources.frame import Frame, RealSource
from venus3d.sources.images import shown

SUFFIXES = (".bag", ".mcap", ".db3")
_IMAGE, _COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
_CHANNELS = {
    "mono8": (np.uint8, 1, None),
    "8UC1": (np.uint8, 1, None),
    "mono16": (np.uint16, 1, None),
    "16UC1": (np.uint16, 1, None),
    "bgr8": (np.uint8, 3, None),
    "8UC3": (np.uint8, 3, None),
    "rgb8": (np.uint8, 3, cv2.COLOR_RGB2BGR),
    "bgra8": (np.uint8, 4, cv2.COLOR_BGRA2BGR),
    "rgba8": (np.uint8, 4, cv2.COLOR_RGBA2BGR),
    "bayer_rggb8": (np.uint8, 1, cv2.COLOR_BayerRGGB2BGR),
    "bayer_bggr8": (np.uint8, 1, cv2.COLOR_BayerBGGR2BGR),
    "bayer_gbrg8": (np.uint8, 1, cv2.COLOR_BayerGBRG2BGR),
    "bayer_grbg8": (np.uint8, 1, cv2.COLOR_BayerGRBG2BGR),
    "yuv422": (np.uint8, 2, cv2.COLOR_YUV2BGR_UYVY),
    "uyvy": (np.uint8, 2, cv2.COLOR_YUV2BGR_UYVY),
    "yuv422_yuy2": (np.uint8, 2, cv2.COLOR_YUV2BGR_YUY2),
    "yuyv": (np.uint8, 2, cv2.COLOR_YUV2BGR_YUY2),
}
"""Of each encoding: type and number of a pixel's values, and how they become BGR."""


def is_bag(path: Path) -> bool:
    """Whether `path` is a bag: a file of ROS 1, a folder or its file of ROS 2."""
    if path.is_dir():
        return (path / "metadata.yaml").is_file()
    return path.suffix.lower() in SUFFIXES and path.is_file()


class Bag(RealSource):
    """The pictures of one topic of a bag, in order. `Frame.time_s` is the bag's time."""

    def __init__(self, path: Path, topic: str | None = None, *, realtime: bool = False) -> None:
        """Open the bag at `path`; a topic must be named if there is more than one with pictures.
        With `realtime`, pictures come when the bag's clock says so. Raises `SourceError` for what
        cannot be read."""
        self._name, self._realtime = shown(path), realtime
        self.notes: tuple[str, ...] = ()
        """What could not be read, at the end."""
        self._stack = ExitStack()
        try:
            self._reader = self._stack.enter_context(_opened(path))
            connection = _connection(self._reader, topic, self._name)
            self.announced = int(connection.msgcount) or None
            self._messages = self._decoded(connection)
            self._first = next(self._messages, None)
        except SourceError:
            self.close()
            raise
        except Exception as error:  # a damaged bag raises anything
            self.close()
            raise SourceError(
                f"{self._name} cannot be read as a bag ({error}); record or copy it again."
            ) from error
        if self._first is None:
            self.close()
            raise SourceError(f"{self._name} holds no picture of {connection.topic}.")
        self._size, self._began_s = self._first.image_size, time.monotonic()

    def read(self) -> Frame | None:
        """The next picture; None at the end. Raises `SourceError` for one of another size."""
        frame, self._first = self._first or next(self._messages, None), None
        while self._realtime and frame is not None:
            wait_s = frame.time_s - (time.monotonic() - self._began_s)
            if wait_s > -0.1:
                time.sleep(max(0.0, wait_s))
                break
            frame = next(self._messages, None)
        if frame is not None and frame.image_size != self._size:
            raise SourceError(
                f"{self._name} changes its picture size at {frame.name}; name another topic, or "
                "cut the bag."
            )
        return None if frame is None else frame.flipped(self.flip)

    def close(self) -> None:
        """Close the file. May be called twice."""
        self._stack.close()

    def _decoded(self, connection: Any) -> Iterator[Frame]:
        began_ns: int | None = None
        first: SourceError | None = None
        damaged = number = 0
        for number, (time_ns, raw) in enumerate(self._raw(connection), start=1):
            began_ns = time_ns if began_ns is None else began_ns
            try:
                message = self._reader.deserialize(raw, connection.msgtype)
                image = _pixels(message, connection.msgtype, self._name)
            except Exception as error:  # a damaged message raises anything
                told = error if isinstance(error, SourceError) else _damaged(self._name, error)
                first, damaged = first or told, damaged + 1
                continue
            yield Frame(image, (time_ns - began_ns) / 1e9, f"message {number}")
        if first is not None:
            if damaged == number:
                raise first
            many = "1 picture is" if damaged == 1 else f"{damaged} pictures are"
            self.notes = (*self.notes, f"Of {self._name} {many} left out: {first}")

    def _raw(self, connection: Any) -> Iterator[tuple[int, bytes]]:
        """Times and contents of the messages, as many as can be read."""
        number = 0
        try:
            for _, time_ns, raw in self._reader.messages(connections=[connection]):
                number += 1
                yield time_ns, raw
        except Exception as error:  # a damaged bag raises anything
            if not number:
                raise
            many = f"{number} of {self.announced}" if self.announced else str(number)
            self.notes = (
                *self.notes,
                f"{self._name} breaks off early ({error}): {many} pictures could be read.",
            )


def _damaged(name: str, error: Exception) -> SourceError:
    return SourceError(f"{name} holds a damaged message ({error}).")


def _opened(path: Path) -> Any:
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise SourceError(
            'ROS bags need rosbags; install it with: pip install "venus3d[ros]".'
        ) from error
    folder = path.parent if is_bag(path.parent) else path
    # A ROS 2 bag may leave out the definitions of the usual messages.
    return AnyReader([folder], default_typestore=get_typestore(Stores.LATEST))


def _connection(reader: Any, topic: str | None, name: str) -> Any:
    with_pictures = {
        connection.topic: connection
        for connection in reader.connections
        if connection.msgtype in (_IMAGE, _COMPRESSED)
    }
    if not with_pictures:
        raise SourceError(f"{name} has no topic with pictures (sensor_msgs Image).")
    named = list(with_pictures) if topic is None else [topic]
    if len(named) == 1 and named[0] in with_pictures:
        return with_pictures[named[0]]
    raise SourceError(
        f"{name} has pictures in {listed(sorted(with_pictures))}; name the one of your camera: "
        f"{name}:{min(with_pictures)}."
    )


def _pixels(message: Any, kind: str, name: str) -> NDArray[np.uint8]:
    if kind == _COMPRESSED:
        image: Any = cv2.imdecode(
            np.frombuffer(bytes(message.data), np.uint8),
            cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION,
        )
        if image is None:
            raise SourceError(f"{name} holds a compressed picture that cannot be decoded.")
        return image
    if message.encoding not in _CHANNELS:
        raise SourceError(f"{name} holds pictures of encoding {message.encoding}, not read here.")
    dtype, channels, conversion = _CHANNELS[message.encoding]
    values = np.dtype(dtype).newbyteorder(">" if message.is_bigendian else "<")
    rows = np.frombuffer(bytes(message.data), np.uint8).reshape(message.height, message.step)
    used = rows[:, : message.width * channels * values.itemsize]
    pixels: Any = np.ascontiguousarray(used).view(values).astype(dtype)
    shape = (message.height, message.width, channels)
    pixels = pixels.reshape(shape if channels > 1 else shape[:2])
    return pixels if conversion is None else cv2.cvtColor(pixels, conversion)

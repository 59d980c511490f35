"""ROS bags as recordings, written by rosbags as recorders do."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.sources.bag import Bag
from venus3d.sources.open_frame_source import open_frame_source

rosbag2 = pytest.importorskip("rosbags.rosbag2")


def picture(number: int) -> NDArray[np.uint8]:
    """BGR; smooth, so that a JPEG of it is near."""
    blue, green = np.meshgrid(np.arange(64) * 2, np.arange(48) * 3)
    return np.stack([blue, green, np.full_like(blue, 20 * number)], axis=-1).astype(np.uint8)


def write_bag(path: Path, damaged: Sequence[int] = ()) -> Path:
    """Three pictures of each of two topics: raw RGB with padded rows, and JPEG; those `damaged`
    have lost half of it."""
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    types: Any = store.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "camera")
    with Writer(path, version=8) as writer:
        raw, packed = (
            writer.add_connection(topic, f"sensor_msgs/msg/{kind}", typestore=store)
            for topic, kind in (("/left/image", "Image"), ("/right/jpeg", "CompressedImage"))
        )
        for number in range(3):
            rows = np.zeros((48, 64 * 3 + 8), np.uint8)
            rows[:, : 64 * 3] = picture(number)[..., ::-1].reshape(48, -1)
            half = slice(rows.size // 2 if number in damaged else rows.size)
            image = types["sensor_msgs/msg/Image"](
                header, 48, 64, "rgb8", 0, rows.shape[1], rows.ravel()[half]
            )
            time_ns = 10**9 + number * 200_000_000
            writer.write(raw, time_ns, store.serialize_cdr(image, image.__msgtype__))
            jpeg = cv2.imencode(".jpg", picture(number))[1].ravel()
            jpeg = np.zeros(100, np.uint8) if number in damaged else jpeg
            image = types["sensor_msgs/msg/CompressedImage"](header, "jpeg", jpeg)
            writer.write(packed, time_ns, store.serialize_cdr(image, image.__msgtype__))
    return path


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_bag(tmp_path_factory.mktemp("bags") / "drive")


@pytest.mark.parametrize(("topic", "off"), [("/left/image", 0), ("/right/jpeg", 6)])
def test_the_pictures_of_a_topic_with_their_times(bag: Path, topic: str, off: int) -> None:
    source = open_frame_source(f"{bag}:{topic}")
    assert isinstance(source, Bag) and source.image_size == (64, 48) and source.announced == 3
    frames = [frame for _ in range(3) if (frame := source.read()) is not None]
    assert source.read() is None
    assert [frame.time_s for frame in frames] == pytest.approx([0, 0.2, 0.4])
    for number, frame in enumerate(frames):
        assert np.abs(frame.image.astype(int) - picture(number)).max() <= off
    source.close()


def test_a_bag_of_two_cameras_asks_which(bag: Path) -> None:
    for spec in (str(bag), f"{bag}:/nothing"):
        with pytest.raises(SourceError) as caught:
            open_frame_source(spec)
        assert str(caught.value) == (
            f"{bag} has pictures in /left/image and /right/jpeg; name the one of your camera: "
            f"{bag}:/left/image."
        )


@pytest.mark.parametrize("topic", ["/left/image", "/right/jpeg"])
@pytest.mark.parametrize(("damaged", "left"), [([1], [0, 2]), ([0], [1, 2]), ([1, 2], [0])])
def test_damaged_messages_are_left_out(
    tmp_path: Path, topic: str, damaged: list[int], left: list[int]
) -> None:
    """A message shorter than its picture ended in a traceback, a damaged JPEG lost the rest."""
    source = open_frame_source(f"{write_bag(tmp_path / 'drive', damaged)}:{topic}")
    frames = [frame for _ in left if (frame := source.read()) is not None]
    assert source.read() is None
    assert [frame.name for frame in frames] == [f"message {number + 1}" for number in left]
    (note,) = source.notes
    assert ("1 picture is" if len(damaged) == 1 else "2 pictures are") + " left out: " in note
    source.close()


def test_a_topic_of_damaged_messages_alone_is_refused(tmp_path: Path) -> None:
    bag = write_bag(tmp_path / "drive", [0, 1, 2])
    for topic, told in (("/left/image", "a damaged message"), ("/right/jpeg", "be decoded")):
        with pytest.raises(SourceError, match=told):
            open_frame_source(f"{bag}:{topic}")


def test_a_damaged_bag_has_its_sentence(tmp_path: Path) -> None:
    (tmp_path / "broken.bag").write_bytes(b"#ROSBAG V2.0\n" + bytes(50))
    with pytest.raises(SourceError, match="cannot be read as a bag"):
        open_frame_source(str(tmp_path / "broken.bag"))

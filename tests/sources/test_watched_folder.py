"""A folder that is still being filled: whole pictures only, each once, of one size."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.waiting import wait_until
from venus3d.engine.errors import SourceError
from venus3d.sources.frame import Frame
from venus3d.sources.live import OtherSize
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.watched_folder import WatchedFolder


def jpeg(size: tuple[int, int] = (64, 48)) -> bytes:
    ramp = np.linspace(0, 255, size[0] * size[1]).reshape(size[1], size[0])
    return cv2.imencode(".jpg", ramp.astype(np.uint8))[1].tobytes()


@pytest.fixture
def frames() -> list[Frame]:
    return []


@pytest.fixture
def source(tmp_path: Path, frames: list[Frame]) -> Iterator[WatchedFolder]:
    (tmp_path / "IMG_1.jpg").write_bytes(jpeg())
    source = open_frame_source(f"watch:{tmp_path}")
    assert isinstance(source, WatchedFolder)

    def read() -> None:
        while (frame := source.read()) is not None:
            frames.append(frame)

    thread = threading.Thread(target=read, daemon=True)
    thread.start()
    yield source
    source.close()
    thread.join(10)
    assert not thread.is_alive(), "close ends the waiting"


def test_pictures_come_as_they_are_whole(
    source: WatchedFolder, frames: list[Frame], tmp_path: Path
) -> None:
    wait_until(lambda: len(frames) == 1)
    whole = jpeg()
    (tmp_path / "IMG_2.jpg").write_bytes(whole[: len(whole) // 2])  # is being copied
    (tmp_path / "notes.txt").write_text("no picture")
    (tmp_path / "IMG_3.jpg").write_bytes(whole)
    wait_until(lambda: len(frames) == 2)
    (tmp_path / "IMG_2.jpg").write_bytes(whole)
    wait_until(lambda: len(frames) == 3)
    assert [frame.name for frame in frames] == ["IMG_1.jpg", "IMG_3.jpg", "IMG_2.jpg"]
    assert not source.notes


def test_another_size_is_left_out_and_said_until_it_is_accepted(
    source: WatchedFolder, frames: list[Frame], tmp_path: Path
) -> None:
    wait_until(lambda: len(frames) == 1)
    (tmp_path / "small.jpg").write_bytes(jpeg((32, 24)))
    wait_until(lambda: source.trouble == OtherSize((64, 48), (32, 24)))
    assert len(frames) == 1 and source.accept_size() == (32, 24)
    (tmp_path / "small2.jpg").write_bytes(jpeg((32, 24)))
    wait_until(lambda: len(frames) == 2)
    assert source.trouble is None and source.image_size == (32, 24)


def test_an_empty_or_missing_folder(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="holds no picture yet"):
        open_frame_source(f"watch:{tmp_path}")
    with pytest.raises(SourceError, match="There is no folder"):
        open_frame_source(f"watch:{tmp_path / 'none'}")


def test_a_first_file_that_cannot_be_read_does_not_refuse_the_folder(tmp_path: Path) -> None:
    (tmp_path / "IMG_0.jpg").touch()
    with pytest.raises(SourceError, match=r"IMG_0\.jpg is empty"):
        open_frame_source(f"watch:{tmp_path}")
    (tmp_path / "IMG_1.jpg").write_bytes(jpeg())
    source = open_frame_source(f"watch:{tmp_path}")
    frame = source.read()
    assert source.image_size == (64, 48) and frame is not None and frame.name == "IMG_1.jpg"
    source.close()

"""A recording that starts again at its end."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.observation_stream import ObservationStream
from venus3d.sources.video import Video

FRAMES = 45


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "recording.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (160, 120))
    for n in range(FRAMES):
        writer.write(np.full((120, 160, 3), 5 * n, np.uint8))
    writer.release()
    return path


@pytest.mark.parametrize("served", [False, True])
def test_only_a_file_on_the_disk_is_opened_before_the_last_round_ends(
    recording: Path, served: bool
) -> None:
    frames: list[str] = []
    opened_after: list[int] = []

    def opened() -> Video:
        video = Video(recording, realtime=True)
        video.is_served = served
        return video

    def again() -> Video:
        opened_after.append(len(frames))
        return opened()

    def show(frame: Frame) -> None:
        frames.append(frame.name)
        if frames.count("frame 1") == 2:
            stream.stop()

    tracker = BoardTracker(Detector(Board()))
    stream = ObservationStream(opened(), tracker, on_picture=show, reopen=again)

    def step() -> None:
        stream.take(0.01)

    stream.run(step)
    stream.check()
    first_round = frames.index("frame 1", 1)
    assert (opened_after[0] < first_round) is not served

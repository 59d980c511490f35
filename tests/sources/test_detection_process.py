"""The board is found in another process as it is here, whatever its kind; one that dies is
replaced, errors come back, and it ends with the program."""

from __future__ import annotations

import multiprocessing
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import psutil
import pytest

from tests.engine.board_pictures import picture_of
from tests.waiting import wait_until
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.detection_process import DetectionProcess
from venus3d.sources.frame import Frame

CAMERA = Camera(1280, 720, 1000, 1000, 640, 360)
BOARDS = {
    "charuco": Board(6, 5),
    "chessboard": Board(10, 7, 0.025, kind="chessboard"),
    "circles": Board(7, 6, 0.03, kind="circles"),
    "asymmetric-circles": Board(4, 11, 0.02, kind="asymmetric-circles"),
    "aprilgrid": Board(6, 5, 0.03, kind="aprilgrid", dictionary="DICT_APRILTAG_36h11"),
    "aruco-grid": Board(5, 4, 0.03, kind="aruco-grid"),
}
Begin = Callable[..., DetectionProcess]


def frames(board: Board, count: int = 4, *, grey: bool = True) -> list[Frame]:
    """The board, moving a little to the right."""
    poses = [Pose.from_vector([15, -20, 8, 0.01 * i, 0, 0.5]) for i in range(count)]
    pictures = [picture_of(board, CAMERA, pose) for pose in poses]
    if not grey:
        pictures = [np.repeat(one[..., None], 3, axis=2) for one in pictures]
    return [Frame(one, i / 30, f"{i}") for i, one in enumerate(pictures)]


def child() -> psutil.Process:
    (found,) = (one for one in multiprocessing.active_children() if one.name == "detect")
    return psutil.Process(found.pid)


@pytest.fixture
def begin() -> Iterator[Begin]:
    """Begins processes, and ends them."""
    begun: list[DetectionProcess] = []

    def one(detector: Detector, size: tuple[int, int] = (1280, 720), **how: Any) -> Any:
        begun.append(DetectionProcess(detector, size, **how))
        return begun[-1]

    yield one
    for process in begun:
        process.close()


@pytest.mark.parametrize("kind", BOARDS)
def test_every_kind_of_board_is_found_there_as_it_is_here(begin: Begin, kind: str) -> None:
    there, here = begin(Detector(BOARDS[kind])), BoardTracker(Detector(BOARDS[kind]))
    for frame in frames(BOARDS[kind]):
        seen, expected = there.track(frame), here.track(frame)
        assert seen.count == expected.count > 10
        assert np.array_equal(seen.ids, expected.ids)
        assert np.array_equal(seen.corners, expected.corners)
        assert seen.sharpness == expected.sharpness and seen.detect_s > 0
        assert (seen.time_s, seen.name, seen.board) == (frame.time_s, frame.name, BOARDS[kind])
        assert seen.image is frame.image, "not sent to and fro"


def test_what_the_detector_learns_is_told_here(begin: Begin) -> None:
    board = Board()
    printed = replace(board, legacy=True)
    process = begin(Detector(board))
    seen = [process.track(frame) for frame in frames(printed, grey=False)]
    assert [one.kind for one in process.diagnoses] == ["wrong-layout"]
    assert seen[-1].board == printed and seen[-1].board is seen[-2].board
    assert seen[-1].board_diagnoses == process.diagnoses


def test_images_without_the_board_are_explained(begin: Begin) -> None:
    asked = replace(BOARDS["charuco"], dictionary="DICT_6X6_250")
    process, here = begin(Detector(asked)), BoardTracker(Detector(asked))
    for frame in frames(BOARDS["charuco"]):
        assert process.track(frame).count == here.track(frame).count == 0
    assert process.explain_misses() == here.explain_misses() != ()


def test_pictures_may_grow_and_have_other_depths(begin: Begin) -> None:
    board = BOARDS["charuco"]
    (frame,) = frames(board, 1)
    process = begin(Detector(board), (320, 240))
    assert process.track(frame).count == 20
    deep = replace(frame, image=frame.image.astype(np.uint16) * 16)
    assert process.track(deep).count == 20
    assert process.track(replace(frame, image=frame.image[::2, ::2])).image_size == (640, 360)


def test_what_the_detection_raises_is_raised_here_and_it_goes_on(begin: Begin) -> None:
    (frame,) = frames(BOARDS["charuco"], 1)
    process = begin(Detector(BOARDS["charuco"]))
    with pytest.raises(VenusError, match="8 or 16 bits") as raised:
        process.track(replace(frame, image=frame.image.astype(np.float32)))
    assert "in _grey" in str(raised.value.__cause__), "and where it was raised"
    assert process.track(frame).count == 20


def test_one_that_dies_is_replaced_but_not_for_ever(
    begin: Begin, caplog: pytest.LogCaptureFixture
) -> None:
    (frame,) = frames(BOARDS["charuco"], 1)
    process = begin(Detector(BOARDS["charuco"]))
    for _ in range(4):  # it has worked in between
        child().kill()
        assert process.track(frame).count == 20
    assert "finds the board ended with code -9; another one" in caplog.text
    dying = threading.Event()

    def kill() -> None:
        while not dying.is_set():
            try:
                child().kill()
            except (psutil.Error, ValueError):
                time.sleep(0.001)

    killer = threading.Thread(target=kill)
    killer.start()
    try:
        with pytest.raises(RuntimeError, match="3 times"):
            for _ in range(100):
                process.track(frame)
    finally:
        dying.set()
        killer.join()


def test_closing_waits_for_no_answer(begin: Begin) -> None:
    process = begin(Detector(BOARDS["charuco"]))
    (frame,) = frames(BOARDS["charuco"], 1)
    assert process.track(frame).count == 20
    child().suspend()
    seen: list[int] = []
    waits = threading.Thread(target=lambda: seen.append(process.track(frame).count))
    waits.start()
    time.sleep(0.3)
    assert not seen
    process.close()
    wait_until(lambda: seen == [0])
    waits.join()

"""Images are searched on several threads; what comes of it is what one thread finds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of, settle
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.folder import Folder
from venus3d.sources.recording import observe_recording

COUNT = 24


@pytest.fixture(scope="module")
def pictures(default_board: Board) -> list[NDArray[np.uint8]]:
    """Of a board in the old layout, which nobody says, and none in every seventh."""
    camera = Camera(480, 360, 420, 420, 239.5, 179.5)
    printed = replace(default_board, legacy=True)
    rng = np.random.default_rng(1)
    found: list[NDArray[np.uint8]] = []
    for number in range(COUNT):
        angles, place = rng.uniform(-30, 30, 3), rng.uniform(-0.03, 0.03, 2)
        pose = Pose.from_vector([*angles, *place, 0.32])
        shot = picture_of(printed, camera, pose)
        found.append(np.full_like(shot, 90) if number % 7 == 0 else shot)
    return found


def test_any_number_of_threads_finds_the_same(
    pictures: list[NDArray[np.uint8]], default_board: Board
) -> None:
    counted: list[tuple[int, int, int | None]] = []
    detectors = [Detector(default_board) for _ in range(3)]
    one, two, many = (
        observe_recording(
            pictures,
            detector,
            (lambda *c: counted.append(c)) if threads == 1 else None,
            threads=threads,
        ).observations
        for detector, threads in zip(detectors, (1, 2, 7), strict=True)
    )
    assert all(d.board == replace(default_board, legacy=True) for d in detectors)
    assert [d.diagnoses for d in detectors[1:]] == [detectors[0].diagnoses] * 2
    found = sum(n % 7 > 0 for n in range(COUNT))
    assert counted[-1] == (COUNT, found, COUNT)
    for others in (two, many):
        for mine, other in zip(one, others, strict=True):
            assert mine.name == other.name and mine.time_s == other.time_s
            np.testing.assert_array_equal(mine.ids, other.ids)
            np.testing.assert_array_equal(mine.corners, other.corners)
            assert (mine.board, mine.board_diagnoses) == (other.board, other.board_diagnoses)


def test_it_is_what_one_detector_finds_in_turn(
    pictures: list[NDArray[np.uint8]], default_board: Board
) -> None:
    """A quick search may stop at corners a little elsewhere, by far less than their noise."""
    detector = Detector(default_board)
    settle(detector, pictures)
    for mine, other in zip(
        map(detector.detect, pictures),
        observe_recording(pictures, Detector(default_board)).observations,
        strict=True,
    ):
        np.testing.assert_array_equal(mine.ids, other.ids)
        np.testing.assert_allclose(mine.corners, other.corners, atol=0.03)


def test_other_boards_are_recognised_in_what_was_missed(
    pictures: list[NDArray[np.uint8]], default_board: Board
) -> None:
    wrong = replace(default_board, dictionary="DICT_6X6_100", legacy=True)
    alone, shared = Detector(wrong), Detector(wrong)
    seen = [alone.detect(picture) for picture in pictures]
    together = observe_recording(pictures, shared, threads=2).observations
    assert not any(o.count for o in (*seen, *together))
    assert [kinds(o) for o in seen] == [kinds(o) for o in together]


def kinds(observation: Observation) -> list[str]:
    return [diagnosis.kind for diagnosis in observation.board_diagnoses]


def test_damaged_files_are_left_out_and_named(
    tmp_path: Path, pictures: list[NDArray[np.uint8]], default_board: Board
) -> None:
    """One of 300 pictures refused the others. On any number of threads, each named once."""
    for number, picture in enumerate(pictures[:8]):
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture)
    for number in (3, 6):
        path = tmp_path / f"{number}.png"
        path.write_bytes(path.read_bytes()[:2000])
    counted: list[tuple[int, int, int | None]] = []
    for threads in (1, 4):
        recording = observe_recording(
            tmp_path,
            Detector(default_board),
            lambda *counts: counted.append(counts),
            threads=threads,
        )
        names = [observation.name for observation in recording.observations]
        assert names == [f"{number}.png" for number in range(8) if number not in (3, 6)]
        assert recording.notes == (
            "2 files cannot be read and are left out: 3.png (damaged or incomplete) and 6.png "
            "(damaged or incomplete); copy them again or remove them.",
        )
        assert (counted[-1][0], counted[-1][2]) == (6, 6)


def test_the_first_damaged_file_is_named_where_none_can_be_read(
    tmp_path: Path, pictures: list[NDArray[np.uint8]]
) -> None:
    for number in (3, 6):
        path = tmp_path / f"{number}.png"
        cv2.imwrite(str(path), pictures[number])
        path.write_bytes(path.read_bytes()[:2000])
    with pytest.raises(SourceError, match=r"3\.png is damaged or incomplete; replace or remove"):
        observe_recording(tmp_path, Detector(Board()), threads=4)
    with pytest.raises(SourceError, match=r"3\.png is damaged"):
        Folder(sorted(tmp_path.iterdir())).read()

"""Boards whose first id is off by whole rows: a part of them is read as the board asked for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.shifted_rows import shifted_board
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.images_calibration import calibrate_recording
from venus3d.sources.recording import observe_recording

Picture = NDArray[np.uint8]
CAMERA = Camera(960, 540, 750, 750, 480, 270)
POSE = Pose.from_vector([20, -25, 10, 0, 0, 0.48])
APRILGRID = Board(6, 6, 0.039, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid")
GRID = Board(6, 6, 0.04, 0.032, "DICT_4X4_250", kind="aruco-grid")
ODD = Board(9, 6, 0.03, 0.022)
EVEN = Board(8, 6, 0.03, 0.022)
SHIFTED = pytest.mark.parametrize(
    ("printed", "begun", "asked"),
    [
        (APRILGRID, 12, 0),
        (APRILGRID, 0, 6),
        (APRILGRID, 30, 0),
        (GRID, 6, 0),
        (GRID, 0, 24),
        (ODD, 9, 0),
        (ODD, 0, 4),
        (EVEN, 8, 0),
        (EVEN, 0, 4),
        (replace(EVEN, legacy=True), 12, 0),
    ],
    ids=lambda value: value.kind if isinstance(value, Board) else str(value),
)


@SHIFTED
def test_the_board_is_read_with_the_rows_it_has_and_told(
    printed: Board, begun: int, asked: int
) -> None:
    """Only the rows that both have were read, and nothing was said."""
    board = replace(printed, first_id=begun)
    picture = picture_of(board, CAMERA, POSE)
    detector = Detector(replace(printed, first_id=asked))
    seen = detector.detect(picture)
    assert detector.board.first_id == begun and seen.count == board.corner_count
    truth = CAMERA.project(POSE.apply(board.points_of(seen.ids)))
    assert np.abs(seen.corners - truth).max() < 0.5
    assert [one.kind for one in detector.diagnoses] == ["other-first-id"]
    kept = Detector(replace(printed, first_id=asked), find_layout=False)
    assert kept.detect(picture).count < board.corner_count and not kept.diagnoses


@pytest.mark.parametrize(("begun", "asked"), [(18, 0), (0, 18)])
def test_a_board_with_too_few_markers_in_common_is_read_as_it_is_said(
    begun: int, asked: int
) -> None:
    """It was said to be read, and never was: a few corners in a row counted as its layout."""
    board = replace(ODD, first_id=begun)
    detector = Detector(replace(ODD, first_id=asked))
    seen = [detector.detect(picture_of(board, CAMERA, POSE)).count for _ in range(10)]
    assert seen[0] == 0 and seen[-1] == board.corner_count and detector.board == board
    assert [one.kind for one in detector.diagnoses] == ["other-first-id"]


def parts_of(picture: Picture) -> list[Picture]:
    """What is left of a picture of which some is hidden."""
    height, width = picture.shape
    found: list[Picture] = []
    for share in (0.3, 0.4, 0.5):
        y, x = int(share * height), int(share * width)
        for rows, columns in (
            (slice(y), slice(None)),
            (slice(-y, None), slice(None)),
            (slice(None), slice(x)),
            (slice(None), slice(-x, None)),
        ):
            hidden = picture.copy()
            hidden[rows, columns] = 128
            found.append(hidden)
    return found


@pytest.mark.parametrize("board", [APRILGRID, GRID, ODD, EVEN], ids=lambda b: b.kind)
def test_a_part_of_the_board_asked_for_is_no_other_one(board: Board) -> None:
    board = replace(board, first_id=12)
    detector = Detector(board)
    for part in parts_of(picture_of(board, CAMERA, POSE)):
        assert shifted_board(board, part) is None
        detector.detect(part)
    assert detector.board.first_id == 12 and not detector.diagnoses


@pytest.mark.parametrize(
    ("folder", "board"),
    [
        ("aprilgrid", Board(6, 6, 0.04, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid")),
        ("aruco-gridboard", Board(6, 4, 0.04, 0.032, "DICT_6X6_50", kind="aruco-grid")),
        ("ids-from-30", Board(first_id=30)),
    ],
)
def test_nor_is_a_part_of_a_real_one(folder: str, board: Board, shared_data: Path) -> None:
    detector = Detector(board)
    read = 0
    for file in sorted((shared_data / "cases" / folder).glob("*.jpg")):
        picture = np.asarray(cv2.imread(str(file), cv2.IMREAD_GRAYSCALE), np.uint8)
        for part in parts_of(picture):
            assert shifted_board(board, part) is None
            read += detector.detect(part).count > 0
    assert read > 24 and "other-first-id" not in [one.kind for one in detector.diagnoses]


def test_another_board_beside_a_part_of_the_one_asked_for_is_not_taken_for_it() -> None:
    board, other = replace(GRID, rows=4), replace(GRID, rows=4, first_id=24)
    px = 60
    one, beside = (
        cv2.copyMakeBorder(each.texture(px), px, px, px, px, cv2.BORDER_CONSTANT, value=(255,))
        for each in (board, other)
    )
    one[: one.shape[0] // 2] = 128
    picture = np.asarray(np.hstack([one, beside]), np.uint8)
    assert shifted_board(board, picture) is None
    detector = Detector(board)
    assert detector.detect(picture).count > 0 and detector.board == board


def test_what_is_seen_later_is_told() -> None:
    """Views may have been captured by then."""
    board = replace(APRILGRID, first_id=12)
    picture = picture_of(board, CAMERA, POSE)
    hidden = picture.copy()
    hidden[:200] = 128  # the rows of the last ids
    detector = Detector(APRILGRID)
    for _ in range(12):
        assert detector.detect(hidden).count > 0
    assert detector.settled and detector.board == APRILGRID and not detector.diagnoses
    seen = detector.detect(picture)
    detector.note_beside([detector.look_beside(picture, seen)])
    (said,) = detector.diagnoses
    assert said.kind == "other-first-id" and "start at id 12, not at 0" in said.cause
    assert detector.board == APRILGRID


def test_a_recording_is_read_so_by_any_number_of_threads(tmp_path: Path) -> None:
    poses = [[20, -25, 10, 0, 0], [-25, 20, 0, 0, 0.02], [25, 20, -20, 0, 0], [-20, -30, 30, 0, 0]]
    board = replace(APRILGRID, first_id=12)
    for number, vector in enumerate(poses):
        picture = picture_of(board, CAMERA, Pose.from_vector([*vector, 0.5]))
        picture[:, : 420 if number == 0 else 0] = 128
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture)
    for threads in (1, 3):
        detector = Detector(APRILGRID)
        found = observe_recording(str(tmp_path), detector, threads=threads)
        assert {one.board for one in found.observations} == {board}
        assert [one.count for one in found.observations[1:]] == [board.corner_count] * 3
    done = calibrate_recording(str(tmp_path), APRILGRID)
    assert done.calibration.board.first_id == 12
    assert "other-first-id" in [one.kind for one in done.diagnoses]

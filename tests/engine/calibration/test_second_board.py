"""Another board beside the one found: told as what it is, and nothing where there is none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

CAMERA = Camera(1280, 720, 1000, 1000, 640, 360)
POSE = Pose.from_vector([15, -20, 8, 0, 0, 0.42])
FIRST = Board(6, 5)
CHESSBOARD = Board(8, 6, 0.022, kind="chessboard")


def side_by_side(*boards: Board) -> NDArray[np.uint8]:
    """(720, 640 n) boards beside each other, each as it is seen from the side."""
    return np.hstack([picture_of(board, CAMERA, POSE)[:, 320:960] for board in boards])


def told(asked: Board, picture: NDArray[np.uint8], looks: int = 2) -> Diagnosis | None:
    detector = Detector(asked, find_layout=False)
    seen = detector.detect(picture)
    assert seen.count > 0.9 * asked.corner_count, "the board asked for is found all the same"
    detector.note_beside([detector.look_beside(picture, seen)] * looks)
    return next((one for one in detector.diagnoses if one.kind == "second-board"), None)


@pytest.mark.parametrize(
    ("asked", "other", "name", "options"),
    [
        (
            FIRST,
            Board(6, 5, first_id=15),
            "a ChArUco board of 6 x 5 squares, DICT_5X5_50, ids from 15",
            "--board.columns 6 --board.rows 5 --board.dictionary DICT_5X5_50 --board.first-id 15",
        ),
        (
            FIRST,
            Board(5, 7, 0.025, 0.018, "DICT_6X6_250"),
            "a ChArUco board of 5 x 7 squares, DICT_6X6_50, ids from 0",
            "--board.columns 5 --board.rows 7 --board.dictionary DICT_6X6_50",
        ),
        (
            FIRST,
            Board(4, 4, 0.04, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid"),
            "an AprilGrid of 4 x 4 tags, DICT_APRILTAG_36H11, ids from 0",
            "--board.kind aprilgrid --board.columns 4 --board.rows 4",
        ),
        (
            FIRST,
            Board(5, 4, 0.035, 0.028, "DICT_4X4_50", kind="aruco-grid"),
            "a grid of 5 x 4 markers of DICT_4X4_50, ids from 0",
            "--board.kind aruco-grid --board.columns 5 --board.rows 4",
        ),
        (
            FIRST,
            CHESSBOARD,
            "a checkerboard of 8 x 6 squares",
            "--board.kind chessboard --board.columns 8 --board.rows 6",
        ),
        (
            FIRST,
            Board(7, 5, 0.028, 0.018, kind="circles"),
            "a grid of 7 x 5 circles",
            "--board.kind circles --board.columns 7 --board.rows 5",
        ),
        (
            CHESSBOARD,
            FIRST,
            "a ChArUco board of 6 x 5 squares, DICT_5X5_50, ids from 0",
            "--board.kind charuco --board.columns 6 --board.rows 5",
        ),
        (
            CHESSBOARD,
            Board(9, 7, 0.02, kind="chessboard"),
            "a checkerboard of 9 x 7 squares",
            "--board.kind chessboard --board.columns 9 --board.rows 7",
        ),
        (
            Board(4, 4, 0.04, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid"),
            FIRST,
            "a ChArUco board of 6 x 5 squares, DICT_5X5_50, ids from 0",
            "--board.kind charuco --board.columns 6 --board.rows 5",
        ),
        (
            Board(7, 5, 0.028, 0.018, kind="circles"),
            CHESSBOARD,
            "a checkerboard of 8 x 6 squares",
            "--board.kind chessboard --board.columns 8 --board.rows 6",
        ),
    ],
)
def test_each_of_two_boards_is_told(asked: Board, other: Board, name: str, options: str) -> None:
    said = told(asked, side_by_side(asked, other))
    assert said is not None and said.cause == (
        f"Beside the board asked for, another one is in view: {name}."
    )
    assert options in said.cure and "take it away" in said.cure


def test_a_part_of_another_board_is_told_without_a_size() -> None:
    other = picture_of(Board(9, 6, dictionary="DICT_6X6_100"), CAMERA, POSE)[:, 500:1000]
    said = told(FIRST, np.hstack([side_by_side(FIRST), other]))
    assert said is not None and "a part of a ChArUco board with markers of DICT_6X6" in said.cause
    assert "--board" not in said.cure


def test_a_pattern_without_markers_is_told_when_two_pictures_show_it() -> None:
    picture = side_by_side(FIRST, CHESSBOARD)
    assert told(FIRST, picture, looks=1) is None
    assert told(FIRST, side_by_side(FIRST, Board(6, 5, first_id=15)), looks=1) is not None


@pytest.mark.parametrize(
    "board",
    [
        Board(),
        replace(Board(), inverted=True),
        Board(8, 6, dictionary="DICT_4X4_50", legacy=True),
        Board(10, 7, 0.024, kind="chessboard"),
        Board(9, 6, 0.028, 0.021, kind="circles"),
        Board(4, 11, 0.015, 0.018, kind="asymmetric-circles"),
        Board(6, 5, 0.036, 0.028, "DICT_APRILTAG_36H11", kind="aprilgrid"),
        Board(6, 4, 0.04, 0.03, "DICT_6X6_50", kind="aruco-grid"),
    ],
)
def test_a_single_board_is_one(board: Board) -> None:
    for vector in ([15, -20, 8, 0, 0, 0.5], [-35, 20, -40, 0, 0, 0.6], [0, 0, 90, 0, 0, 0.75]):
        assert told(board, picture_of(board, CAMERA, Pose.from_vector(vector))) is None


@pytest.mark.parametrize(
    "printed",
    [
        Board(9, 9),
        Board(6, 8, 0.036, 0.028, "DICT_APRILTAG_36H11", kind="aprilgrid"),
        Board(6, 8, 0.036, 0.028, "DICT_6X6_50", kind="aruco-grid"),
    ],
)
def test_more_rows_than_asked_for_are_no_second_board(printed: Board) -> None:
    """The rows that go on below are numbered as on the same board."""
    pose = Pose.from_vector([15, -20, 8, 0, 0, 0.6])
    assert told(replace(printed, rows=printed.rows - 3), picture_of(printed, CAMERA, pose)) is None


@pytest.mark.parametrize(
    ("folder", "board"),
    [
        ("lifecam-charuco-8x8", Board(8, 8, 0.0254, 0.01905, "DICT_4X4_1000")),
        ("sleap-charuco-8x11-top", Board(8, 11, 0.024, 0.01875, "DICT_4X4_1000")),
        ("checkerboard-9x6", Board(10, 7, kind="chessboard")),
        ("fisheye-checkerboard-15x9", Board(16, 10, 0.026, kind="chessboard")),
        ("cases/glare", Board(9, 7, 0.04, 0.02, "DICT_4X4_100")),
        ("cases/aprilgrid", Board(6, 6, 0.03, 0.023, "DICT_APRILTAG_36H11", kind="aprilgrid")),
        ("cases/aruco-gridboard", Board(6, 4, 0.03, 0.024, "DICT_6X6_1000", kind="aruco-grid")),
        ("cases/fisheye-147deg", Board()),
        ("cases/one-row", Board()),
    ],
)
def test_real_pictures_of_one_board_show_no_other(
    shared_data: Path, folder: str, board: Board
) -> None:
    """Each pattern twice, so that a single one would be told. All pictures of all sets were looked
    at (docs/diagnoses.md); here some of each."""
    detector = Detector(board)
    files = sorted((shared_data / folder).glob("*.jpg"))
    for file in files[:: max(1, len(files) // 4)]:
        picture = np.asarray(cv2.imread(str(file), cv2.IMREAD_GRAYSCALE), np.uint8)
        seen = detector.detect(picture)
        if seen.count:
            detector.note_beside([detector.look_beside(picture, seen)] * 2)
            assert "second-board" not in [one.kind for one in detector.diagnoses], file.name

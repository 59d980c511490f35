"""Which board is in the pictures, with nothing known of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.engine.board_pictures import picture_of
from venus3d.cli import main
from venus3d.engine.calibration.board_finding import FoundBoard, find_boards
from venus3d.engine.calibration.board_recognition import recognise_board
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

POSE = Pose.from_vector([15, -20, 8, 0, 0, 0.5])


def seen_of(board: Board, camera: Camera, pose: Pose = POSE) -> FoundBoard:
    (found,) = find_boards([picture_of(board, camera, pose)])
    return found


@pytest.mark.parametrize("legacy", [False, True])
def test_a_charuco_board_with_all_that_there_is_to_tell(paper_camera: Camera, legacy: bool) -> None:
    board = Board(8, 6, 0.03, 0.024, "DICT_6X6_250", legacy=legacy, first_id=40)
    found = seen_of(board, paper_camera)
    assert found.options == (
        "--board.kind charuco --board.columns 8 --board.rows 6 --board.dictionary DICT_6X6_100 "
        "--board.first-id 40" + " --board.legacy" * legacy
    )
    assert found.share == pytest.approx(0.8, abs=0.04)
    assert found.whole and found.markers == 24


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize(
    "grid",
    [
        Board(9, 6, 0.028, 0.018, kind="circles"),
        Board(4, 11, 0.015, 0.018, kind="asymmetric-circles"),
    ],
)
def test_white_circles_on_a_dark_board_are_named(
    paper_camera: Camera, grid: Board, inverted: bool
) -> None:
    shown = replace(grid, inverted=inverted)
    picture = picture_of(shown, paper_camera, POSE)
    assert ("--board.inverted" in seen_of(shown, paper_camera).options) == inverted
    said = recognise_board(replace(shown, inverted=not inverted), [picture])
    assert said is not None and said.kind == "wrong-polarity"
    assert said.cure == ("Start with" if inverted else "Leave out") + " --board.inverted."
    assert recognise_board(shown, [picture]) is None, "it is the board asked for"
    other = recognise_board(Board(), [picture])
    assert other is not None and other.kind == "other-pattern"
    assert ("--board.inverted" in other.cure) == inverted


def test_the_option_named_reads_the_white_circles(
    paper_camera: Camera, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """From the refusal to the result, by what the sentences say alone."""
    white = Board(7, 5, 0.028, 0.018, kind="circles", inverted=True)
    for number, (x, y) in enumerate([(30, 0), (-30, 0), (0, 30), (0, -30)]):
        pose = Pose.from_vector([x, y, 5, 0, 0, 0.45])
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture_of(white, paper_camera, pose))
    sizes = {"columns": 7, "rows": 5, "square-mm": 28, "marker-mm": 18}
    options = [f"--board.{name}={value}" for name, value in sizes.items()]
    calibrate = ["calibrate", str(tmp_path), "--board.kind=circles", *options]
    assert main([*calibrate, "--output", str(tmp_path / "out")]) == 2
    assert "white on a dark board" in capsys.readouterr().err
    assert main(["board", "--find", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "white on a dark ground" in said and "--board.inverted" in said
    assert main([*calibrate, "--board.inverted", "--output", str(tmp_path / "out")]) == 0


def test_two_boards_side_by_side_are_two(paper_camera: Camera) -> None:
    """With offset ids, as rigs of several boards have them."""
    one, other = Board(5, 4), Board(5, 4, first_id=10)
    halves = [picture_of(board, paper_camera, POSE)[:, 250:1000] for board in (one, other)]
    found = find_boards([np.hstack(halves)])
    assert [(b.kind, b.columns, b.rows, b.first_id) for b in found] == [
        ("charuco", 5, 4, 0),
        ("charuco", 5, 4, 10),
    ]


def test_a_board_seen_in_part_and_whole_is_one(paper_camera: Camera) -> None:
    near = Pose.from_vector([0, 0, 0, 0.1, 0, 0.25])
    pictures = [picture_of(Board(), paper_camera, pose) for pose in (near, POSE, near)]
    (found,) = find_boards(pictures)
    assert (found.columns, found.rows, found.pictures, found.whole) == (9, 6, 3, True)


@pytest.mark.parametrize(
    ("name", "options", "share"),
    [
        (
            "cases/aprilgrid",
            "--board.kind aprilgrid --board.columns 6 --board.rows 6 --board.dictionary "
            "DICT_APRILTAG_36H11",
            1 / 1.3,
        ),
        (
            "cases/aruco-gridboard",
            "--board.kind aruco-grid --board.columns 6 --board.rows 4 --board.dictionary "
            "DICT_6X6_50",
            0.8,
        ),
        ("checkerboard-9x6", "--board.kind chessboard --board.columns 10 --board.rows 7", None),
    ],
)
def test_real_boards(shared_data: Path, name: str, options: str, share: float | None) -> None:
    files = sorted((shared_data / name).glob("*.jpg"))[:2]
    pictures = [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in files]
    (found,) = find_boards(np.asarray(picture, np.uint8) for picture in pictures)
    assert found.options == options and found.pictures == 2
    if share is not None:
        assert found.share == pytest.approx(share, abs=0.02)


def test_a_bad_view_of_a_board_is_no_second_one(shared_data: Path) -> None:
    """Markers too small to be put in order were called a board that is not read."""
    files = sorted((shared_data / "cases" / "board-too-small").glob("*.jpg"))
    pictures = [np.asarray(cv2.imread(str(one), cv2.IMREAD_GRAYSCALE), np.uint8) for one in files]
    (found,) = find_boards(pictures)
    assert (found.kind, found.columns, found.rows) == ("charuco", 9, 6)


def test_the_command_prints_the_options(
    paper_camera: Camera, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = picture_of(Board(7, 5, first_id=3), paper_camera, POSE)
    cv2.imwrite(str(tmp_path / "a.png"), picture)
    assert main(["board", "--find", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "7 x 5 squares, DICT_5X5_50, ids from 3" in said and "in 1 of 1 pictures" in said
    assert (
        "--board.columns 7 --board.rows 5 --board.dictionary DICT_5X5_50 --board.first-id 3" in said
    )
    cv2.imwrite(str(tmp_path / "a.png"), np.full_like(picture, 90))
    assert main(["board", "--find", str(tmp_path)]) == 2
    assert "No board is seen" in capsys.readouterr().err


def test_a_charuco_board_where_a_checkerboard_is_asked_for(paper_camera: Camera) -> None:
    asked = Board(kind="chessboard", columns=9, rows=6)
    said = recognise_board(asked, [picture_of(Board(), paper_camera, POSE)])
    assert said is not None and "a ChArUco board of 9 x 6 squares" in said.cause
    assert "--board.kind charuco --board.columns 9 --board.rows 6" in said.cure
    itself = replace(asked, columns=8)
    assert recognise_board(itself, [picture_of(itself, paper_camera, POSE)]) is None

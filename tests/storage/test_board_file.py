"""A board's file: our own, Kalibr's, calib.io's names; and `--board FILE` on the command line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from venus3d.cli import main
from venus3d.cli.board_argument import with_board_file
from venus3d.engine.errors import BoardError, StorageError
from venus3d.engine.geometry.board import Board
from venus3d.options import BoardOptions
from venus3d.storage.board_file import read_board, save_board

BOARDS = [
    Board(),
    Board(8, 5, 0.0305, 0.0225, "DICT_4X4_250", legacy=True, inverted=True, first_id=12),
    Board(kind="chessboard", columns=10, rows=7, square=0.026),
    Board(stretch=0.004),
    Board(4, 11, 0.02, 0.016, kind="asymmetric-circles", inverted=True),
]


@pytest.mark.parametrize(
    "board", BOARDS, ids=["charuco", "other charuco", "chessboard", "stretched", "circles"]
)
def test_a_saved_board_is_read_as_it_was(board: Board, tmp_path: Path) -> None:
    path = save_board(board, tmp_path / "board.toml")
    read = BoardOptions(**read_board(path)).board()
    assert replace(read, stretch=0) == replace(board, stretch=0)
    assert read.stretch == pytest.approx(board.stretch, abs=1e-9)


def test_kalibr_s_files(tmp_path: Path) -> None:
    """The two examples of Kalibr's wiki; a checkerboard counts inner corners there."""
    path = tmp_path / "target.yaml"
    path.write_text(
        "target_type: 'aprilgrid' #gridtype\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\n"
        "tagSpacing: 0.3\n"
    )
    assert read_board(path) == {
        "kind": "aprilgrid",
        "columns": 6,
        "rows": 5,
        "square_mm": pytest.approx(114.4),
        "marker_mm": 88.0,
        "dictionary": "DICT_APRILTAG_36H11",
    }
    path.write_text(
        "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\n"
        "colSpacingMeters: 0.06\n"
    )
    board = BoardOptions(**read_board(path)).board()
    assert (board.kind, board.columns, board.rows, board.square) == ("chessboard", 7, 8, 0.06)
    path.write_text(
        "target_type: 'circlegrid'\ntargetCols: 6\ntargetRows: 7\nspacingMeters: 0.02\n"
        "asymmetricGrid: True\n"
    )
    board = BoardOptions(**read_board(path)).board()
    assert board == Board(6, 7, 0.02, 0.01, kind="asymmetric-circles")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (
            "calib.io_charuco_200x150_8x11_15_12_DICT_5X5.pdf",
            Board(11, 8, 0.015, 0.012, "DICT_5X5_50"),
        ),
        (
            "calib.io_charuco_420x297_12x17_25_18.5_DICT_4X4 (1).pdf",
            Board(17, 12, 0.025, 0.0185, "DICT_4X4_250"),
        ),
        ("calib.io_checker_200x150_8x11_15.png", Board(11, 8, 0.015, kind="chessboard")),
        ("calib.io_checker_A4_8x11_20", Board(11, 8, 0.02, kind="chessboard")),
        (
            "calib.io_circles_200x150_8x10_18_8.33.pdf",
            Board(10, 8, 0.018, 0.00833, kind="circles"),
        ),
        ("calib.io_circles_200x150_7x10_12_5.pdf", Board(10, 7, 0.012, 0.005, kind="circles")),
        ("calib.io_circles_200x150_8x11_12_5_01.bmp", Board(11, 8, 0.012, 0.005, kind="circles")),
        ("calib.io_checker_200x150_8x11_15_01.png", Board(11, 8, 0.015, kind="chessboard")),
        (
            "calib.io_charuco_200x150_8x11_15_12_DICT_5X5_02 (1).png",
            Board(11, 8, 0.015, 0.012, "DICT_5X5_50"),
        ),
        (
            "calib.io_charuco_200x150_8x11_15_12_DICT_5X5_1000-3.png",
            Board(11, 8, 0.015, 0.012, "DICT_5X5_1000"),
        ),
        (
            "calib.io_charuco_200x150_8x11_15_12_DICT_5X5_1000.png",
            Board(11, 8, 0.015, 0.012, "DICT_5X5_1000"),
        ),
    ],
)
def test_the_names_of_calib_io(name: str, expected: Board) -> None:
    """Rows come first; the file itself is not needed."""
    assert BoardOptions(**read_board(Path(name))).board() == expected


@pytest.mark.parametrize(
    ("file", "text", "says"),
    [
        ("board.toml", 'kind = "charuco"\ncolumns = 9\n', "rows, square_mm is missing"),
        ("board.toml", "color = 3\n", "no option 'color'"),
        ("board.toml", 'columns = "many"\n', "columns: Expected `int`"),
        ("board.yaml", "target_type: hexgrid\n", "a hexgrid of Kalibr"),
        ("board.yaml", "target_type: aprilgrid\ntagCols: 6\n", "describes no board"),
        ("board.yaml", "[1, 2", "it is no YAML"),
    ],
)
def test_what_is_no_board_is_refused(file: str, text: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / file
    path.write_text(text)
    with pytest.raises(StorageError, match=says):
        read_board(path)


@pytest.mark.parametrize(
    "name",
    [
        "calib.io_circles_200x150_7x10_12.pdf",
        "calib.io_circles_200x150_7x10_12_01.bmp",
        "calib.io_acircles_200x150_7x10_12_5.pdf",
    ],
)
def test_names_that_do_not_tell_all_are_refused(name: str) -> None:
    with pytest.raises(StorageError, match=r"distance and diameter|no name of a"):
        read_board(Path(name))


def test_an_option_beside_the_file_wins(tmp_path: Path) -> None:
    path = save_board(Board(first_id=3, legacy=True), tmp_path / "b.toml")
    given = [
        "calibrate",
        "--board.square_mm=27.8",
        "--board",
        str(path),
        "here",
        "--board.rows",
        "5",
    ]
    expanded = with_board_file(given)
    assert "--board" not in expanded and expanded[-3:] == ["here", "--board.rows", "5"]
    assert expanded.count("--board.rows") == 1 and "--board.square-mm" not in expanded
    assert "--board.legacy" in expanded and "--board.inverted" not in expanded
    assert with_board_file([*given[:2], f"--board={path}", *given[4:]]) == expanded


def test_the_commands_save_and_read_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    assert main(["board", "--board.columns", "7", "--save", str(path)]) == 0
    assert main(["board", "--board", str(path), "--output", str(tmp_path / "b.svg")]) == 0
    assert "7 x 6" in capsys.readouterr().out
    assert main(["board", "--board"]) == 2
    assert "--board needs a file" in capsys.readouterr().err
    assert main(["board", "--board", str(tmp_path / "none.toml")]) == 2
    assert "cannot be read" in capsys.readouterr().err


def test_squares_that_a_printer_stretched() -> None:
    """28.2 mm from left to right and 27.9 mm from top to bottom, from corner to corner."""
    board = BoardOptions(square_x_mm=28.2, square_y_mm=27.9).board()
    corners = board.corners.reshape(5, 8, 3)
    np.testing.assert_allclose(np.diff(corners[:, :, 0], axis=1), 0.0282, atol=1e-12)
    np.testing.assert_allclose(np.diff(corners[:, :, 1], axis=0), 0.0279, atol=1e-12)
    assert BoardOptions(square_y_mm=28.0).board() == Board()
    with pytest.raises(BoardError, match="longer one way"):
        BoardOptions(square_x_mm=56.0).board()
    with pytest.raises(BoardError):
        BoardOptions(square_x_mm=-28.0).board()

"""The board against OpenCV's own board."""

from __future__ import annotations

import pickle

import cv2
import numpy as np
import pytest

from venus3d.engine.errors import BoardError
from venus3d.engine.geometry.board import DICTIONARIES, Board

BOARDS = [
    Board(),
    Board(legacy=True),
    Board(columns=5, rows=7, square=0.04, marker=0.02, dictionary="DICT_4X4_50"),
    Board(columns=12, rows=8, square=0.018, marker=0.014, dictionary="DICT_5X5_1000"),
]


@pytest.mark.parametrize("board", BOARDS)
def test_corners_are_opencvs_about_the_centre(board: Board) -> None:
    theirs = np.asarray(board.cv_board.getChessboardCorners(), dtype=np.float64).reshape(-1, 3)
    assert board.corner_count == len(theirs)
    np.testing.assert_allclose(
        # OpenCV keeps them in single precision.
        board.corners,
        theirs - [board.width / 2, board.height / 2, 0],
        atol=1e-7,
    )
    np.testing.assert_allclose(board.corners.mean(axis=0), 0, atol=1e-15)
    np.testing.assert_allclose(np.ptp(board.outline, axis=0), [board.width, board.height, 0])
    assert board.marker_count == len(board.cv_board.getIds())


@pytest.mark.parametrize("board", BOARDS)
def test_ids_count_along_the_rows(board: Board) -> None:
    for corner_id, (column, row) in enumerate(board.lattice.tolist()):
        assert corner_id == row * (board.columns - 1) + column
        place = [(column + 1) * board.square, (row + 1) * board.square]
        np.testing.assert_allclose(
            board.points_of([corner_id])[0, :2], place - np.array([board.width, board.height]) / 2
        )


@pytest.mark.parametrize("inverted", [False, True])
@pytest.mark.parametrize("legacy", [False, True])
def test_opencv_reads_the_texture(legacy: bool, inverted: bool) -> None:
    board = Board(legacy=legacy, inverted=inverted)
    texture = board.texture(60)
    assert texture.shape == (360, 540)
    picture = cv2.copyMakeBorder(
        255 - texture if inverted else texture, 60, 60, 60, 60, cv2.BORDER_CONSTANT, value=255
    )
    corners, ids, *_ = cv2.aruco.CharucoDetector(board.cv_board).detectBoard(picture)
    numbers = np.asarray(ids).ravel()
    assert sorted(numbers) == list(range(40))
    # Metres to pixels: 60 px a square, the board's centre in the middle; centres of pixels count.
    expected = board.points_of(numbers)[:, :2] / board.square * 60
    expected += [60 + 270 - 0.5, 60 + 180 - 0.5]
    np.testing.assert_allclose(np.asarray(corners).reshape(-1, 2), expected, atol=0.6)


@pytest.mark.parametrize(
    ("options", "cause"),
    [
        ({"columns": 2}, "too few inner corners"),
        ({"marker": 0.03}, "swapped"),
        ({"marker": 0.0}, "positive"),
        ({"square": float("nan")}, "positive"),
        ({"dictionary": "DICT_9X9"}, "no marker dictionary"),
        ({"columns": 20, "rows": 20}, "larger dictionary"),
    ],
)
def test_options_that_make_no_board(options: dict[str, float], cause: str) -> None:
    with pytest.raises(BoardError, match=cause):
        Board(**options)  # type: ignore[arg-type]


def test_dictionaries_are_those_of_this_opencv() -> None:
    assert "DICT_5X5_100" in DICTIONARIES and "DICT_4X4_50" in DICTIONARIES
    assert all(isinstance(getattr(cv2.aruco, name), int) for name in DICTIONARIES)


def test_pickles_after_opencv_objects_were_made() -> None:
    """A board that had detected something could not be sent to another process."""
    board = Board(legacy=True)
    assert board.cv_board is not None
    again = pickle.loads(pickle.dumps(board))
    assert again == board and again.cv_board.getLegacyPattern()

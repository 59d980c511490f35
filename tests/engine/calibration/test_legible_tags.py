"""The size from which a grid's tags are read is the one that is told."""

from __future__ import annotations

import numpy as np
import pytest

from tests.engine.board_pictures import picture_of
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

CAMERA = Camera(640, 480, 900, 900, 320, 240)
APRILGRID = Board(6, 5, 0.036, 0.036 / 1.3, "DICT_APRILTAG_36H11", kind="aprilgrid")
GRID = Board(6, 4, 0.04, 0.032, "DICT_6X6_50", kind="aruco-grid")


def found_share(board: Board, square_px: float) -> float:
    """Of the tags, in pictures with noise in which a square is about so wide."""
    rng = np.random.default_rng(3)
    counts: list[int] = []
    for turn in (-20, -5, 10, 25, 40):
        pose = Pose.from_vector([6, -6, turn, 0, 0, 900 * board.square / square_px])
        picture = picture_of(board, CAMERA, pose, noise=2.0, rng=rng)
        counts.append(Detector(board, find_layout=False).detect(picture).count)
    return sum(counts) / (len(counts) * board.corner_count)


@pytest.mark.parametrize("board", [APRILGRID, GRID])
def test_tags_of_the_legible_size_are_read(board: Board) -> None:
    assert found_share(board, 1.08 * board.of_kind.legible_square_px(board)) > 0.95


def test_an_aprilgrids_tags_need_more_than_a_plain_grids() -> None:
    """The squares between them touch them: half of those of 21 px are lost."""
    assert APRILGRID.of_kind.legible_square_px(APRILGRID) == pytest.approx(35.1)
    assert GRID.of_kind.legible_square_px(GRID) == pytest.approx(24)
    assert found_share(APRILGRID, 21) < 0.75 < found_share(GRID, 21)

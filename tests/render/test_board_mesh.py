"""The board's picture on its mesh."""

from __future__ import annotations

import numpy as np
import pytest

from venus3d.engine.geometry.board import Board
from venus3d.render.board_mesh import board_mesh

TAGS = [
    Board(6, 4, 0.05, 0.04, "DICT_6X6_1000", kind="aruco-grid"),
    Board(6, 6, 0.0286, 0.022, "DICT_APRILTAG_36h11", kind="aprilgrid"),
]


@pytest.mark.parametrize("board", TAGS, ids=lambda board: board.kind)
def test_a_tag_is_as_large_as_it_is_given(board: Board) -> None:
    """Its edges lie between the pixels of the picture. In black and white they were half a pixel
    off: seen from near, corners were off by as much, and simulated calibrations by 4 sigma."""
    picture = board_mesh(board).visual.material.baseColorTexture
    dark = 1 - np.asarray(picture.convert("L"), dtype=np.float64) / 255
    px = 128  # a square; around all a rim of one
    squares = np.ceil([board.width / board.square, board.height / board.square])
    corners = board.points_of(np.arange(4))[:, :2] / board.square * px + (squares / 2 + 1) * px
    (left, top), (right, bottom) = corners.min(axis=0), corners.max(axis=0)
    cell = (right - left) / (int(board.cv_dictionary.markerSize) + 2)
    # Through the tag's border, from white to white: how much of it is dark.
    across = dark[round(top + cell / 3), round(left) - 9 : round(right) + 9].sum()
    down = dark[round(top) - 9 : round(bottom) + 9, round(left + cell / 3)].sum()
    assert across == pytest.approx(board.marker / board.square * px, abs=0.1)
    assert down == pytest.approx(board.marker / board.square * px, abs=0.1)

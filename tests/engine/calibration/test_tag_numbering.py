"""Grids of tags asked for with other columns, rows or ids than they have, mirrored, and twice."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from venus3d.cli import main
from venus3d.engine.calibration.board_recognition import recognise_board
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

Picture = NDArray[np.uint8]
CAMERA = Camera(800, 450, 625, 625, 400, 225)
WIDE = Camera(800, 450, 560, 560, 400, 225, -0.25, 0.06)
POSES = [
    Pose.from_vector(vector)
    for vector in (
        [20, -25, 10, 0, 0, 0.4],
        [-15, 30, -35, 0.01, 0, 0.45],
        [25, 5, 95, 0, 0, 0.45],
    )
]
APRILGRID = Board(5, 4, 0.04, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid")
GRID = Board(5, 4, 0.04, 0.032, "DICT_4X4_50", kind="aruco-grid")
EACH = pytest.mark.parametrize("printed", [APRILGRID, GRID], ids=["aprilgrid", "aruco-grid"])


@lru_cache
def pictures_of(board: Board, camera: Camera = CAMERA) -> list[Picture]:
    return [picture_of(board, camera, pose) for pose in POSES]


@EACH
@pytest.mark.parametrize(("columns", "rows"), [(6, 4), (4, 5), (4, 4), (7, 3), (10, 2), (3, 7)])
def test_other_columns_are_refused_with_those_seen(printed: Board, columns: int, rows: int) -> None:
    """They were read wrongly, and refused as too far away."""
    asked = replace(printed, columns=columns, rows=rows)
    detector = Detector(asked)
    assert [detector.detect(picture).count for picture in pictures_of(printed)] == [0, 0, 0]
    (said,) = detector.explain_misses()
    assert said.kind == "swapped-size" and "a board of 5 columns" in said.cause
    assert "--board.columns 5 --board.rows 4" in said.cure


@EACH
@pytest.mark.parametrize(("begun", "asked"), [(3, 0), (7, 0), (20, 0), (29, 0), (0, 2), (11, 23)])
def test_another_first_id_is_found_told_and_read(printed: Board, begun: int, asked: int) -> None:
    """Half of the tags were read, some in wrong places, or none."""
    board = replace(printed, first_id=begun)
    detector = Detector(replace(printed, first_id=asked))
    pictures = pictures_of(board)
    assert [detector.detect(picture).count for picture in pictures] == [0, 0, 0]
    (said,) = detector.explain_misses()
    assert said.kind == "other-first-id" and f"start at id {begun};" in said.cause
    for pose, picture in zip(POSES, pictures, strict=True):
        seen = detector.detect(picture)
        truth = CAMERA.project(pose.apply(board.points_of(seen.ids)))
        assert seen.count > 0.85 * board.corner_count and np.abs(seen.corners - truth).max() < 0.5
    assert [one.kind for one in detector.diagnoses] == ["other-first-id"]


@EACH
def test_another_first_id_is_read_while_pictures_come(printed: Board) -> None:
    picture = picture_of(replace(printed, first_id=7), CAMERA, POSES[0])
    detector = Detector(printed)
    seen = [detector.detect(picture).count for _ in range(12)]
    assert seen[0] == 0 and seen[-1] == printed.corner_count
    assert detector.board.first_id == 7


@EACH
@pytest.mark.parametrize("camera", [CAMERA, WIDE], ids=["narrow", "wide"])
@pytest.mark.parametrize("marker", [1.0, 0.7])
def test_any_part_of_the_board_asked_for_is_read(
    printed: Board, camera: Camera, marker: float
) -> None:
    """Whatever size of the tags is given."""
    asked = replace(printed, marker=marker * printed.marker)
    for number, (pose, picture) in enumerate(zip(POSES, pictures_of(printed, camera), strict=True)):
        height, width = picture.shape
        parts = (
            (slice(None), slice(0, width // 2)),
            (slice(height // 2, None), slice(None)),
            (slice(0, height // 3), slice(width // 3, None)),
        )
        hidden = picture.copy()
        hidden[parts[number]] = 128
        for shown in (picture, hidden):
            seen = Detector(asked).detect(shown)
            truth = camera.project(pose.apply(printed.points_of(seen.ids)))
            assert seen.count >= 16 and np.abs(seen.corners - truth).max() < 2.0
            assert recognise_board(printed, [shown]) is None


@EACH
def test_a_misread_tag_is_no_other_numbering(printed: Board) -> None:
    """Two tags in each other's place."""
    px = 120
    sheet = printed.texture(px)
    first, second = (
        (slice(row * px + 8, (row + 1) * px - 8), slice(column * px + 8, (column + 1) * px - 8))
        for row, column in ((1, 1), (2, 3))
    )
    if printed.kind == "aprilgrid":  # the joints lie around the tags
        gap = round(px * (1 - printed.marker / printed.square))
        first, second = (
            tuple(slice(s.start + gap, s.stop) for s in one) for one in (first, second)
        )
    sheet[first], sheet[second] = sheet[second].copy(), sheet[first].copy()
    picture = cv2.copyMakeBorder(sheet, px, px, px, px, cv2.BORDER_CONSTANT, value=(255,))
    assert Detector(printed).detect(picture).count >= 72


@EACH
def test_two_equal_grids_are_two(printed: Board) -> None:
    """They were one of twice the columns."""
    px = 60
    one = cv2.copyMakeBorder(printed.texture(px), px, px, 8, 8, cv2.BORDER_CONSTANT, value=(255,))
    detector = Detector(replace(printed, first_id=1))
    assert detector.detect(np.hstack([one, one])).count == 0
    said = detector.diagnoses or detector.explain_misses()
    assert [d.kind for d in said] == ["two-boards"]
    named = recognise_board(printed, [np.hstack([one, one])])
    assert named is not None and named.kind == "two-boards"


@pytest.mark.parametrize(
    "printed",
    [APRILGRID, GRID, replace(GRID, dictionary="DICT_6X6_250"), Board(6, 5, 0.03, 0.022)],
)
def test_mirrored_boards_are_named(
    printed: Board, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of 4 x 4 cells, some tags look like others when mirrored."""
    detector = Detector(printed)
    pictures = [np.ascontiguousarray(p[:, ::-1]) for p in pictures_of(printed)]
    assert [detector.detect(picture).count for picture in pictures] == [0, 0, 0]
    (said,) = detector.explain_misses()
    assert said.kind == "mirrored" and printed.dictionary in said.cause
    for number, picture in enumerate(pictures):
        cv2.imwrite(str(tmp_path / f"{number}.png"), picture)
    assert main(["board", "--find", str(tmp_path)]) == 2
    assert "mirrored" in capsys.readouterr().err


@pytest.mark.parametrize("px", [4, 5, 6])
def test_stray_markers_within_large_tags_are_no_mirror_image(px: int) -> None:
    """Of 4 x 4 cells: a fisheye's AprilGrid, too small to be read, was called mirrored."""
    rng = np.random.default_rng(px)
    for _ in range(3):
        cells = rng.integers(0, 2, (450 // px // 2, 800 // px // 2), dtype=np.uint8) * 220
        picture = cv2.resize(cells, None, fx=2 * px, fy=2 * px, interpolation=cv2.INTER_NEAREST)
        said = recognise_board(APRILGRID, [np.asarray(picture, np.uint8)])
        assert said is None or said.kind != "mirrored"

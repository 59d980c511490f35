"""Every kind of board: found in pictures whose truth is known, and followed through them."""

from __future__ import annotations

import time
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.images_calibration import calibrate_images
from venus3d.storage.formats.plain_json import JSON
from venus3d.storage.formats.record import CameraRecord
from venus3d.storage.result import board_summary
from venus3d.storage.result_reader import board_of

CAMERA = Camera(1280, 720, 1000, 1000, 645, 352)
POSE = Pose.from_vector([20, -25, 10, 0.01, -0.01, 0.42])
BOARDS = {
    "chessboard": Board(kind="chessboard", columns=10, rows=7, square=0.024),
    "chessboard, even": Board(kind="chessboard", columns=10, rows=6, square=0.024),
}
EACH = pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))


def picture_of(board: Board, pose: Pose, seed: int = 0) -> NDArray[np.uint8]:
    """A picture without distortion, so that a homography warps it; four pixels in each, blurred."""
    px = 60
    sheet = cv2.copyMakeBorder(board.texture(px), px, px, px, px, cv2.BORDER_CONSTANT, value=255)
    # From pixels of the sheet, whose centres are whole numbers, to metres, then to the picture.
    to_board = np.array(
        [
            [board.square / px, 0, board.square / px * (0.5 - sheet.shape[1] / 2)],
            [0, board.square / px, board.square / px * (0.5 - sheet.shape[0] / 2)],
            [0, 0, 1],
        ]
    )
    double = np.array([[2.0, 0, 0.5], [0, 2.0, 0.5], [0, 0, 1]])
    H = double @ CAMERA.K @ np.column_stack([pose.R[:, :2], pose.t]) @ to_board
    fine = cv2.warpPerspective(sheet, H, (2560, 1440), borderValue=(110,))
    picture = cv2.GaussianBlur(
        cv2.resize(fine, (1280, 720), interpolation=cv2.INTER_AREA), None, 0.6
    )
    noisy = picture + np.random.default_rng(seed).normal(0, 2.0, picture.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def errors_of(board: Board, seen: Observation, pose: Pose) -> np.ndarray:
    return np.linalg.norm(
        seen.corners - CAMERA.project(pose.apply(board.points_of(seen.ids))), axis=1
    )


@EACH
def test_found_where_it_is(board: Board) -> None:
    """Each point under its own id, to 0.1 px in a picture with noise."""
    picture = picture_of(board, POSE)
    seen = Detector(board).detect(picture)
    assert seen.count == board.corner_count
    errors = errors_of(board, seen, POSE)
    assert np.sqrt((errors**2).mean()) < 0.1 and errors.max() < 0.4


@EACH
def test_followed_from_frame_to_frame(board: Board) -> None:
    """Also when it moves by half a square between two frames; each in at most 8 ms."""
    tracker, times = BoardTracker(Detector(board)), list[float]()
    for k in range(6):
        pose = Pose.from_vector([20, -25, 10 + 2 * k, 0.01 + 0.004 * k, -0.01, 0.42])
        picture = picture_of(board, pose, k)
        began = time.thread_time()
        seen = tracker.track(Frame(picture, 0.04 * k, str(k)))
        times.append(time.thread_time() - began)
        assert seen.count == board.corner_count
        assert errors_of(board, seen, pose).max() < 0.4
    assert np.median(times[2:]) < 0.008, times


def test_a_checkerboard_that_turns_over_is_followed() -> None:
    """The half-turn symmetry: a board that is turned by 150 degrees keeps its ids, though it looks
    as if it were turned by 30 the other way."""
    board = BOARDS["chessboard, even"]
    detector = Detector(board)
    for turn in (0, 50, 100, 150):
        pose = Pose.from_vector([10, -15, turn, 0, 0, 0.45])
        seen = detector.detect(picture_of(board, pose))
        assert errors_of(board, seen, pose).max() < 0.4


def test_the_colours_tell_which_way_up() -> None:
    board = BOARDS["chessboard"]
    pose = Pose.from_vector([10, -15, 150, 0, 0, 0.45])
    seen = Detector(board).detect(picture_of(board, pose))
    assert errors_of(board, seen, pose).max() < 0.4


def test_a_real_checkerboard(shared_data: Path) -> None:
    """13 stills of the left camera of a stereo pair: plain OpenCV finds 13, fx 519.2 +- 1.7."""
    board = Board(kind="chessboard", columns=10, rows=7, square=0.025)
    found = calibrate_images(shared_data / "checkerboard-9x6", board)
    assert len(found.views) == 13 and found.rms_px <= 0.153
    assert abs(found.camera.fx - 519.2) < 2
    assert found.board == board


@EACH
def test_stored_with_what_its_kind_has(board: Board) -> None:
    assert board_of(board_summary(board)) == board
    content = JSON.write(CameraRecord(CAMERA, board=board))
    assert JSON.read(content).board == board

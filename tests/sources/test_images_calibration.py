"""One call from pictures to a camera: the public `calibrate`."""

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
from venus3d.engine.errors import CalibrationError, SourceError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.images_calibration import calibrate_images, calibrate_recording

VECTORS = (
    [35, 0, 0, 0, 0, 0.5],
    [0, 35, 5, -0.1, 0.05, 0.45],
    [-30, -20, 0, 0.1, 0, 0.5],
    [20, -30, 9, 0, -0.05, 0.4],
)


@pytest.fixture(scope="module")
def pictures(paper_camera: Camera, default_board: Board) -> list[NDArray[np.uint8]]:
    """Of a board in the old layout, which nobody says."""
    printed = replace(default_board, legacy=True)
    return [picture_of(printed, paper_camera, Pose.from_vector(v)) for v in VECTORS]


def test_a_folder_a_pattern_files_and_arrays(
    tmp_path: Path,
    pictures: list[NDArray[np.uint8]],
    paper_camera: Camera,
    default_board: Board,
) -> None:
    files = [tmp_path / f"{number}.png" for number in range(len(pictures))]
    for file, picture in zip(files, pictures, strict=True):
        cv2.imwrite(str(file), picture)
    of_folder = calibrate_images(tmp_path, default_board)
    assert of_folder.camera.fx == pytest.approx(paper_camera.fx, rel=0.01)
    assert of_folder.board == replace(default_board, legacy=True)
    assert [view.observation.name for view in of_folder.views] == [f.name for f in files]
    assert all(view.observation.board == of_folder.board for view in of_folder.views)
    for images in (f"{tmp_path}/*.png", files, [str(file) for file in files], pictures):
        again = calibrate_images(images, default_board).camera
        np.testing.assert_allclose(again.parameters, of_folder.camera.parameters, rtol=1e-5)


def test_observations_of_an_own_detector(
    pictures: list[NDArray[np.uint8]], paper_camera: Camera, default_board: Board
) -> None:
    detector = Detector(default_board)
    unsettled = detector.detect(pictures[0])
    board = settle(detector, pictures * 4)
    empty = Observation.nothing(paper_camera.image_size)
    calibration = calibrate_images([*map(detector.detect, pictures), empty], default_board)
    assert calibration.board == board == replace(default_board, legacy=True)
    assert calibration.camera.fx == pytest.approx(paper_camera.fx, rel=0.01)
    assert len(calibration.views) == len(pictures)
    misread = replace(unsettled, board=default_board)
    with pytest.raises(CalibrationError, match="more than one layout"):
        calibrate_images([misread, detector.detect(pictures[1])], default_board)
    larger = replace(default_board, square=0.03)
    with pytest.raises(CalibrationError, match="use the board that the detector has"):
        calibrate_images([*map(detector.detect, pictures)], larger)


def test_what_is_to_be_known_of_the_pictures(
    pictures: list[NDArray[np.uint8]], default_board: Board
) -> None:
    empty = np.full((720, 1280), 90, np.uint8)
    found = calibrate_recording([*pictures, empty], default_board)
    assert len(found.warnings) == 1
    assert found.warnings[0].startswith("The board was not found in image 5, or no more")
    assert "wrong-layout" in [diagnosis.kind for diagnosis in found.diagnoses]


def test_pictures_that_make_no_calibration(
    pictures: list[NDArray[np.uint8]], default_board: Board
) -> None:
    with pytest.raises(SourceError, match="give at least one"):
        calibrate_images([], default_board)
    with pytest.raises(SourceError, match="all files or all arrays"):
        calibrate_images([pictures[0], "a.png"], default_board)  # type: ignore[list-item]
    with pytest.raises(CalibrationError, match="Only 2 pictures show the board"):
        calibrate_images(pictures[:2], replace(default_board, legacy=True))
    with pytest.raises(CalibrationError, match="differ in size"):
        calibrate_images([*pictures, pictures[0][:-10]], default_board)


@pytest.mark.parametrize("other", [Board(6, 5, first_id=15), Board(8, 6, 0.022, kind="chessboard")])
def test_a_second_board_in_the_pictures_is_told(paper_camera: Camera, other: Board) -> None:
    first = Board(6, 5)
    pictures: list[NDArray[np.uint8]] = []
    for vector in VECTORS:
        pose = Pose.from_vector([*vector[:3], 0, 0, 0.42])
        beside = Pose.from_vector([10, 10, 3, 0, 0, 0.42])
        both = (picture_of(first, paper_camera, pose), picture_of(other, paper_camera, beside))
        pictures.append(np.hstack([picture[:, 320:960] for picture in both]))
    found = calibrate_recording(pictures, first)
    said = [one.cause for one in found.diagnoses if one.kind == "second-board"]
    assert len(said) == 1 and f"{other.columns} x {other.rows} squares" in said[0]
    alone = [np.where(np.arange(1280) < 640, picture, 120).astype(np.uint8) for picture in pictures]
    kinds = [one.kind for one in calibrate_recording(alone, first).diagnoses]
    assert "second-board" not in kinds

"""The small live picture, against OpenCV's mean over each pixel's area."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.engine.board_pictures import picture_of
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.render.annotated_picture import small_picture


@pytest.mark.parametrize(
    ("size", "small"),
    [
        ((640, 360), (640, 360)),
        ((960, 541), (640, 361)),
        ((1280, 721), (640, 360)),
        ((1920, 1080), (640, 360)),
        ((3840, 2160), (640, 360)),
        ((320, 240), (320, 240)),
    ],
)
def test_it_shows_what_the_mean_over_areas_shows(
    paper_camera: Camera, default_board: Board, size: tuple[int, int], small: tuple[int, int]
) -> None:
    grey = picture_of(default_board, paper_camera, Pose.from_vector([20, 10, 5, 0, 0, 0.4]))
    whole = cv2.resize(np.asarray(grey), size, interpolation=cv2.INTER_LINEAR)
    bgr = np.dstack([whole, whole // 2, 255 - whole])
    shown = small_picture(bgr)
    wanted = cv2.resize(bgr, small, interpolation=cv2.INTER_AREA)[:, :, ::-1]
    assert shown.shape == wanted.shape and shown.dtype == np.uint8
    assert np.sqrt(((shown.astype(float) - wanted) ** 2).mean()) < 4
    grey_shown = small_picture(whole)
    assert np.array_equal(grey_shown[:, :, 0], grey_shown[:, :, 2])


@pytest.mark.parametrize("width", [1280, 1920, 3840])
def test_pixels_are_averaged_not_left_out(rng: np.random.Generator, width: int) -> None:
    noise = rng.integers(0, 255, (width * 9 // 16, width), np.uint8)
    assert small_picture(noise).std() < 0.55 * noise.std()
    left_out = cv2.resize(noise, (640, 360), interpolation=cv2.INTER_NEAREST)
    assert left_out.std() > 0.9 * noise.std(), "the bar tells them apart"

"""Pictures of another size: the camera's pixels are where the resized picture has them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import PAPER_CAMERA as CAMERA
from venus3d.engine.geometry.resize import resize_to

POINT = np.array([[0.1, -0.05, 1.0]])
SIZE = CAMERA.image_size


def spot(camera_pixel: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """A picture with a smooth spot at a pixel."""
    u, v = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    return np.exp(-((u - camera_pixel[0]) ** 2 + (v - camera_pixel[1]) ** 2) / (2 * 12**2))


def centre(picture: np.ndarray) -> np.ndarray:
    v, u = np.indices(picture.shape)
    return np.array([(u * picture).sum(), (v * picture).sum()]) / picture.sum()


def test_scaling_is_that_of_real_pictures() -> None:
    """OpenCV's INTER_AREA, which averages whole pixels: borders stay borders."""
    resize = resize_to(SIZE, (640, 360))
    picture = spot(CAMERA.project(POINT)[0], SIZE)
    small = cv2.resize(picture, (640, 360), interpolation=cv2.INTER_AREA)
    np.testing.assert_allclose(centre(small), resize.camera(CAMERA).project(POINT)[0], atol=0.01)


def test_binning_drops_what_is_left_over() -> None:
    resize = resize_to((1281, 721), (640, 360), "bin")
    picture = spot(np.array([700.0, 300.0]), (1281, 721))
    binned = picture[:720, :1280].reshape(360, 2, 640, 2).mean(axis=(1, 3))
    camera = resize.camera(CAMERA)
    assert camera.image_size == (640, 360)
    np.testing.assert_allclose(centre(binned), [(700.5) / 2 - 0.5, (300.5) / 2 - 0.5], atol=0.01)
    assert camera.cx == pytest.approx((CAMERA.cx + 0.5) / 2 - 0.5)


@pytest.mark.parametrize(("offset", "first"), [(None, (320, 120)), ((10, 20), (10, 20))])
def test_a_crop_moves_the_centre_alone(
    offset: tuple[int, int] | None, first: tuple[int, int]
) -> None:
    camera = resize_to(SIZE, (640, 480), "crop", offset).camera(CAMERA)
    np.testing.assert_allclose(camera.project(POINT), CAMERA.project(POINT) - first, atol=1e-9)


def test_derivatives_are_those_of_the_camera() -> None:
    resize = resize_to(SIZE, (640, 480), "scale")
    step = 1e-3
    for index in range(9):
        moved = CAMERA.parameters + step * np.eye(9)[index]
        shifted = resize.camera(type(CAMERA).from_parameters(moved, SIZE)).parameters
        change = (shifted - resize.camera(CAMERA).parameters) / step
        np.testing.assert_allclose(change, resize.derivatives(CAMERA) * np.eye(9)[index], atol=1e-9)


def test_another_shape_needs_an_answer() -> None:
    with pytest.raises(CalibrationError, match=r"less of the scene .*--by crop.*--by scale"):
        resize_to(SIZE, (640, 480))


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (((1281, 480), "crop"), "beyond the picture"),
        (((640, 480), "crop", (700, 0)), "at 700,0"),
        (((500, 300), "bin"), "whole pixels"),
        (((640, 360), "scale", (1, 1)), "that of a crop"),
    ],
)
def test_what_cannot_be_is_refused(arguments: tuple, told: str) -> None:
    with pytest.raises(CalibrationError, match=told):
        resize_to(SIZE, *arguments)

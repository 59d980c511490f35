"""What a simulated camera's sensor makes of a rendered board: a room behind it, dim light, blur,
the lens's image circle, noise."""

from __future__ import annotations

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

KEY = (255, 0, 255)
"""A colour that no board has; where it shows there is background (see `_cut_out`)."""
_NOISE_STRIDE = 64

Box = tuple[int, int, int, int]
"""Left, top, right, bottom; the last two are exclusive."""


@dataclass(frozen=True, eq=False)
class Blur:
    """How sharp an image is, and what that makes of the room."""

    sigma: float
    """Pixels."""
    room: NDArray[np.uint8]
    """The background alone, blurred."""

    @property
    def reach(self) -> int:
        """As far as a pixel is smeared, pixels."""
        return 1 + math.ceil(4 * self.sigma)


class Sensor:
    """Develops pictures of one camera. Used by one thread."""

    def __init__(
        self,
        camera: Camera,
        background: NDArray[np.uint8],
        rng: np.random.Generator,
        *,
        light: float,
        noise_sigma: float,
        field_deg: float | None,
    ) -> None:
        """Arguments as of `Simulation`; `background` is BGR, and `rng` draws the noise."""
        self._size, self._background, self._light = camera.image_size, background, light
        self._exposed_part = None if field_deg is None else _image_circle(camera, field_deg)
        self._noise, self._rng = _noise_sheet(camera, noise_sigma, rng), rng

    def blur(self, sigma: float) -> Blur:
        """A blur of this standard deviation, pixels."""
        return Blur(sigma, _blurred(self._background, sigma))

    def develop(self, rendered: NDArray[np.uint8], pose: Pose, blur: Blur) -> NDArray[np.uint8]:
        """The picture (BGR) of a board at `T_camera_board`, rendered (RGB) alone on the `KEY`."""
        # A sheet that turns away from the lamp above gets a little darker.
        facing = float(np.clip(pose.R[:, 2] @ np.array([0.0, 0.45, 0.89]), 0.0, 1.0))
        light = self._light * (0.75 + 0.25 * facing)
        green, through = _cut_out(rendered)
        # Only the board's part of the image is composed, with the background that the blur mixes
        # in: a board that fills a quarter of the image costs a quarter.
        x, y, width, height = cv2.boundingRect(cv2.bitwise_not(through))
        inner = _grown((x, y, x + width, y + height), blur.reach, self._size)
        left, top, right, bottom = _grown(inner, blur.reach, self._size)
        outer = np.s_[top:bottom, left:right]
        part = _blurred(
            _composed(green[outer], through[outer], self._background[outer], light), blur.sigma
        )
        image = blur.room.copy()
        image[inner[1] : inner[3], inner[0] : inner[2]] = part[
            inner[1] - top : inner[3] - top, inner[0] - left : inner[2] - left
        ]
        image = self._vignetted(image)
        if self._noise is not None:
            y, x = self._rng.integers(0, _NOISE_STRIDE, 2)
            noise = self._noise[y : y + image.shape[0], x : x + image.shape[1]]
            image = cv2.add(image, noise, dtype=cv2.CV_8U)
        return np.asarray(image, dtype=np.uint8)

    def _vignetted(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The image, dark outside the image circle."""
        if self._exposed_part is None:
            return image
        return np.asarray(cv2.multiply(image, self._exposed_part, scale=1 / 255), dtype=np.uint8)


def _blurred(image: NDArray[np.uint8], sigma: float) -> NDArray[np.uint8]:
    if sigma <= 0:
        return image
    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma), dtype=np.uint8)


def _image_circle(camera: Camera, field_deg: float) -> NDArray[np.uint8]:
    """(H, W, 3) 255 where the lens throws an image, with a soft edge of two pixels; else 0."""
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    edge = np.radians(field_deg / 2)
    rim = camera.project([np.sin(edge), 0.0, np.cos(edge)]) - [camera.cx, camera.cy]
    radius = np.hypot((u - camera.cx), (v - camera.cy) * camera.fx / camera.fy)
    soft = np.clip((rim[0] - radius) / 2 + 0.5, 0.0, 1.0)
    return cv2.merge([np.asarray(np.rint(255 * soft), dtype=np.uint8)] * 3)  # type: ignore[return-value]


def _cut_out(rendered: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """The board's grey times its coverage, and the share of background visible.

    The board is grey, so red minus green is the share of the key (255, 0, 255), edges included: one
    rendering gives an exact cut-out.
    """
    green = cv2.extractChannel(rendered, 1)
    through = cv2.subtract(cv2.extractChannel(rendered, 0), green)
    return np.asarray(green, dtype=np.uint8), np.asarray(through, dtype=np.uint8)


def _composed(
    green: NDArray[np.uint8],
    through: NDArray[np.uint8],
    background: NDArray[np.uint8],
    light: float,
) -> NDArray[np.uint8]:
    """The cut-out, lit, in front of the background (BGR)."""
    # Printed black reflects some 5 % of the light.
    board = cv2.addWeighted(green, 0.95 * light, cv2.bitwise_not(through), 0.05 * light, 0)
    behind = cv2.multiply(background, cv2.merge([through] * 3), scale=1 / 255)
    return np.asarray(cv2.add(behind, cv2.merge([board] * 3)), dtype=np.uint8)


def _grown(box: Box, by: int, size: tuple[int, int]) -> Box:
    left, top, right, bottom = box
    return (
        max(0, left - by),
        max(0, top - by),
        min(size[0], right + by),
        min(size[1], bottom + by),
    )


def _noise_sheet(
    camera: Camera, sigma: float, rng: np.random.Generator
) -> NDArray[np.int16] | None:
    """Noise somewhat larger than a frame, from which each frame takes a random part.
    Two million normal numbers a frame would cost more than the rendering."""
    if sigma <= 0:
        return None
    shape = (camera.height + _NOISE_STRIDE, camera.width + _NOISE_STRIDE, 3)
    noise = rng.standard_normal(shape, dtype=np.float32) * np.float32(sigma)
    return np.round(noise).astype(np.int16)

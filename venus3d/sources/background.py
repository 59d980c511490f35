"""The blurred interior behind the simulated board."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray


def interior(size: tuple[int, int], rng: np.random.Generator) -> NDArray[np.uint8]:
    """BGR (H, W, 3) picture of a wall, a window, a shelf and a table, for an image of `size`."""
    width, height = 320, max(2, round(320 * size[1] / size[0]))
    across, down = np.meshgrid(np.linspace(0, 1, width), np.linspace(0, 1, height))
    # A wall lit from a window on the left, darker towards the floor.
    light = 148 - 46 * across - 34 * down**2
    picture = light[..., None] * np.array([0.93, 0.98, 1.0])

    def block(x: float, y: float, w: float, h: float, bgr: tuple[int, int, int]) -> None:
        left, top = int(x * width), int(y * height)
        picture[top : int((y + h) * height), left : int((x + w) * width)] = bgr

    block(0.04, 0.06, 0.20, 0.46, (206, 200, 190))
    block(0.135, 0.06, 0.012, 0.46, (120, 124, 128))
    block(0.70, 0.30, 0.26, 0.025, (58, 74, 92))
    block(0.0, 0.84, 1.0, 0.16, (66, 84, 104))
    x = 0.71
    while x < 0.93:
        w, h = rng.uniform(0.012, 0.03), rng.uniform(0.10, 0.19)
        colour = rng.uniform(45, 135) + rng.uniform(-28, 28, 3)
        block(x, 0.30 - h, w, h, (int(colour[0]), int(colour[1]), int(colour[2])))
        x += w + 0.003
    picture = cv2.resize(picture.astype(np.float32), size, interpolation=cv2.INTER_CUBIC)
    picture = cv2.GaussianBlur(picture, (0, 0), size[0] / 110)
    # Less than one grey value of noise prevents banding.
    picture += rng.normal(0, 0.7, picture.shape).astype(np.float32)
    return np.clip(picture, 0, 255).astype(np.uint8)

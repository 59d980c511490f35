"""The cameras that can be simulated, by name."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.lenses import FISHEYE

SIMULATED = "sim"
"""The name of the source that simulates one."""
SimCamera = Literal["webcam", "action", "fisheye", "telephoto"]

SIM_CAMERAS: dict[SimCamera, Camera] = {
    "webcam": PAPER_CAMERA,
    # 120 degrees from left to right.
    "action": Camera(1280, 720, 608, 606, 633, 366, 0.02, -0.012, 0.004, -0.001, lens=FISHEYE),
    # 190 degrees from left to right; its image circle leaves the picture's corners dark.
    "fisheye": Camera(1280, 720, 398, 397, 644, 355, -0.02, 0.004, -0.002, 0.0003, lens=FISHEYE),
    # 12 degrees.
    "telephoto": Camera(1280, 720, 6080, 6075, 648, 351, 0.12, 0.9, 0.0004, -0.0003),
}
"""Each with its true parameters; `webcam` is the paper's."""

FIELD_DEG: dict[SimCamera, float] = {"fisheye": 190.0}
"""Diameter of the image circle of those that have one."""


def simulated_camera(name: SimCamera, image_size: tuple[int, int] | None = None) -> Camera:
    """The camera of this name, for its own pictures or for those of `image_size` (width, height).
    Pixels stay as square as they are: of another shape, the picture's middle is what is seen."""
    camera = SIM_CAMERAS[name]
    if image_size is None:
        return camera
    width, height = image_size
    scale = max(width / camera.width, height / camera.height)
    return replace(
        camera,
        width=width,
        height=height,
        fx=camera.fx * scale,
        fy=camera.fy * scale,
        cx=(camera.cx + 0.5 - camera.width / 2) * scale + width / 2 - 0.5,
        cy=(camera.cy + 0.5 - camera.height / 2) * scale + height / 2 - 0.5,
    )

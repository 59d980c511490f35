"""Text painted into pictures: labels at points in space, and plain lines of text."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from venus3d.engine.camera import Camera
from venus3d.scene.shapes import Colour, LabelShape


@lru_cache(maxsize=32)
def font(size_px: int, bold: bool = False) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Open Sans as pyrender ships it; Pillow's own font where that is missing."""
    spec = find_spec("pyrender")
    if spec is not None and spec.origin is not None:
        name = "OpenSans-Bold.ttf" if bold else "OpenSans-Semibold.ttf"
        path = Path(spec.origin).parent / "fonts" / name
        if path.is_file():
            return ImageFont.truetype(str(path), size_px)
    return ImageFont.load_default(size_px)


def paint_labels(
    picture: NDArray[np.uint8], labels: Sequence[LabelShape], camera: Camera
) -> NDArray[np.uint8]:
    """RGB picture with the labels at their points as `camera` sees them; unseen ones are left out."""
    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image)
    size = max(11, round(image.height / 13))
    for label in labels:
        x, y = camera.project(label.position)
        if not (np.isfinite([x, y]).all() and 0 <= x < image.width and 0 <= y < image.height):
            continue
        colour = label.colour
        draw.text(
            (float(x), float(y)), label.text, fill=colour, font=font(size, bold=True),
            anchor="mm", stroke_width=max(1, size // 9), stroke_fill=halo(colour),
        )
    return np.asarray(image)


def halo(colour: Colour) -> Colour:
    """Near black around light text, near white around dark text."""
    light = 0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2] > 110
    return (16, 18, 22) if light else (255, 255, 255)

"""Text in pictures: labels at points in space, and lines that fit a width."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from venus3d.engine.geometry.camera import Camera
from venus3d.render.palette import text_on
from venus3d.render.shapes import LabelShape


@lru_cache(maxsize=32)
def font(size_px: int, bold: bool = False) -> Any:
    """Open Sans as pyrender ships it; Pillow's own font where that is missing."""
    spec = find_spec("pyrender")
    if spec is not None and spec.origin is not None:
        name = "OpenSans-Bold.ttf" if bold else "OpenSans-Semibold.ttf"
        path = Path(spec.origin).parent / "fonts" / name
        if path.is_file():
            return ImageFont.truetype(str(path), size_px)
    return ImageFont.load_default(size_px)


def fitting_font(text: str, size_px: int, width_px: float, bold: bool = False) -> Any:
    """`font` of this size, or the largest in which `text` fits the width."""
    length = font(size_px, bold).getlength(text)
    return font(min(size_px, int(size_px * width_px / max(length, 1))), bold)


@lru_cache(maxsize=256)
def wrapped_lines(text: str, face: Any, width_px: float) -> tuple[str, ...]:
    """`text` broken into as few lines of this width as possible; cached, since measuring is
    slow."""
    lines: list[str] = []
    for word in text.split():
        if lines and face.getlength(f"{lines[-1]} {word}") <= width_px:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return tuple(lines)


def paint_labels(
    picture: NDArray[np.uint8], labels: Sequence[LabelShape], camera: Camera
) -> NDArray[np.uint8]:
    """RGB picture with the labels at their points as `camera` sees them. A label just outside is
    drawn at the border; one behind the camera is left out."""
    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image)
    size = int(np.clip(image.height / 13, 11, 44))
    face, stroke = font(size, bold=True), max(1, size // 8)
    taken: list[tuple[float, float, float, float]] = []
    for label in labels:
        x, y = (float(v) for v in camera.project(label.position))
        if not np.isfinite([x, y]).all():
            continue
        half = face.getlength(label.text) / 2 + stroke
        x = float(np.clip(x, half + 2, image.width - half - 2))
        y = float(np.clip(y, 0.7 * size, image.height - 0.7 * size))
        # Overlapping labels: the later one moves below the earlier one.
        for x0, y0, x1, y1 in taken:
            if x - half < x1 and x + half > x0 and y - 0.6 * size < y1 and y + 0.6 * size > y0:
                y = y1 + 0.6 * size if y1 + 1.2 * size < image.height else y0 - 0.6 * size
        taken.append((x - half, y - 0.6 * size, x + half, y + 0.6 * size))
        draw.text(
            (x, y),
            label.text,
            fill=label.colour,
            font=face,
            anchor="mm",
            stroke_width=stroke,
            stroke_fill=text_on(label.colour),
        )
    return np.asarray(image)

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
from venus3d.render.palette import luminance, mixed
from venus3d.render.shapes import Colour, LabelShape

_PILL: Colour = (12, 15, 20)
_TICK = "✓"
_DARK = 0.12
"""Luminance below which a colour is lost on a pill."""


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


@lru_cache(maxsize=256)
def pill_picture(text: str, colour: Colour, height_px: int) -> NDArray[np.uint8]:
    """A label as RGBA (H, W, 4): white on a dark pill with an edge of this colour."""
    face, width = _pill_font(height_px), pill_width(text, height_px)
    image = Image.new("RGBA", (width, height_px), (*_PILL, 0))
    draw = ImageDraw.Draw(image)
    # On light ground the colours are dark, and so is the pill.
    edge = colour if luminance(colour) > _DARK else mixed(colour, (255, 255, 255), 0.5)
    draw.rounded_rectangle(
        (0, 0, width - 1, height_px - 1),
        radius=height_px / 2,
        fill=(*_PILL, 235),
        outline=edge,
        width=max(2, height_px // 13),
    )
    left = (width - face.getlength(text)) / 2
    for i, part in enumerate(text.split(_TICK)):
        if i:  # a sign that the font lacks
            corners = height_px * np.array([[0.04, 0.52], [0.16, 0.66], [0.36, 0.34]])
            line = [(left + x, y) for x, y in corners.tolist()]
            draw.line(line, fill=(255, 255, 255), width=max(2, height_px // 11), joint="curve")
            left += face.getlength(_TICK)
        draw.text((left, height_px / 2), part, fill=(255, 255, 255), font=face, anchor="lm")
        left += face.getlength(part)
    return np.asarray(image)


@lru_cache(maxsize=256)
def pill_width(text: str, height_px: int) -> int:
    """Width of a label's picture, pixels."""
    return round(max(_pill_font(height_px).getlength(text) + 0.8 * height_px, height_px))


def _pill_font(height_px: int) -> Any:
    return font(round(0.56 * height_px), bold=True)


def paint_labels(
    picture: NDArray[np.uint8],
    labels: Sequence[LabelShape],
    camera: Camera,
    height: float = 1 / 9,
) -> NDArray[np.uint8]:
    """RGB picture with the labels, of this share of its height, at their points as `camera` sees
    them. A label just outside is drawn at the border; one behind the camera is left out."""
    image = Image.fromarray(picture)
    tall = int(np.clip(height * image.height, 15, 56))
    taken: list[tuple[float, float, float, float]] = []
    for label in labels:
        x, y = (float(v) for v in camera.project(label.position))
        if not np.isfinite([x, y]).all():
            continue
        pill = Image.fromarray(pill_picture(label.text, label.colour, tall))
        half, gap = pill.width / 2, 0.55 * tall
        x = float(np.clip(x, half + 2, image.width - half - 2))
        y = float(np.clip(y, gap, image.height - gap))
        # Overlapping labels: the later one moves below the earlier one.
        for x0, y0, x1, y1 in taken:
            if x - half < x1 and x + half > x0 and y - gap < y1 and y + gap > y0:
                y = y1 + gap if y1 + 2 * gap < image.height else y0 - gap
        taken.append((x - half, y - gap, x + half, y + gap))
        image.paste(pill, (round(x - half), round(y - tall / 2)), pill)
    return np.asarray(image)

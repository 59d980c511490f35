"""Reads one image file: its size, its pixels.

The depth is kept (16-bit grey stays 16-bit) and the orientation tag is *not* applied: a lens is
calibrated on the sensor's own rows and columns, whichever way up the camera was held.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from venus3d.engine.errors import SourceError
from venus3d.sources.opencv_log import silence_opencv

SUFFIXES: tuple[str, ...] = (
    *(".png", ".jpg", ".jpeg", ".jpe", ".bmp", ".dib", ".tif", ".tiff", ".webp", ".jp2"),
    *(".pgm", ".ppm", ".pbm", ".pnm"),
)
"""File suffixes that are searched for in a folder."""
_FLAGS = cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION


def is_image(path: Path) -> bool:
    """Whether the file starts like an image that OpenCV reads."""
    silence_opencv()
    return bool(cv2.haveImageReader(str(path)))


def size_of(path: Path) -> tuple[int, int]:
    """(width, height) from the file's header, if possible without decoding the pixels.
    Raises `SourceError` if the file is no image."""
    if not is_image(path):
        raise _no_image(path)
    try:
        with Image.open(path) as head:
            return (head.width, head.height)
    except OSError:  # a format that only OpenCV knows
        height, width = read_image(path).shape[:2]
        return (width, height)


def read_image(path: Path) -> NDArray[np.uint8]:
    """Pixels: (H, W, 3) BGR 8 bit, or (H, W) grey of 8 or 16 bit; 16-bit colour becomes grey.
    Raises `SourceError` if the file is no image, is truncated, or has other pixel types."""
    if not is_image(path):
        raise _no_image(path)
    _check_complete(path)
    pixels: Any = cv2.imread(str(path), _FLAGS)
    if pixels is None:
        raise SourceError(f"The image {path} is damaged or incomplete; replace or remove it.")
    if pixels.dtype not in (np.uint8, np.uint16):
        raise SourceError(
            f"The image {path} holds {pixels.dtype} numbers; save it with 8 or 16 bit per channel."
        )
    if pixels.ndim == 3 and pixels.dtype == np.uint16:
        # Corners are detected in grey: the depth is worth more than the colour.
        pixels = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
    return pixels


def _check_complete(path: Path) -> None:
    """Raise for a truncated JPEG, which OpenCV silently fills with grey."""
    try:
        with Image.open(path) as picture:
            if picture.format == "JPEG":
                picture.draft("L", (picture.width // 8, picture.height // 8))
                picture.load()
    except OSError as error:
        if "truncated" in str(error):
            raise SourceError(
                f"The image {path} breaks off early; copy it again or remove it."
            ) from error


def _no_image(path: Path) -> SourceError:
    return SourceError(
        f"{path} is not an image, whatever its name says; use a PNG, JPEG, TIFF or BMP file."
    )

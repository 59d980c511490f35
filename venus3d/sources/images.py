"""Reads one image file: its header, its pixels.

The depth is kept (16-bit grey stays 16-bit) and the orientation tag is *not* applied: a lens is
calibrated on the sensor's own rows and columns, whichever way up the camera was held. Python reads
the bytes and OpenCV decodes them: a name that is not UTF-8 ends the process in `cv2.imread`.
"""

from __future__ import annotations

import os
import warnings
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from venus3d.engine.errors import SourceError
from venus3d.regular_file import read_regular
from venus3d.sources.opencv_log import silence_opencv

SUFFIXES: tuple[str, ...] = (
    *(".png", ".apng", ".jpg", ".jpeg", ".jpe", ".jfif", ".jfi", ".bmp", ".dib", ".tif", ".tiff"),
    *(".webp", ".gif", ".avif", ".jp2", ".j2k", ".pgm", ".ppm", ".pbm", ".pnm", ".pam"),
)
"""File suffixes of the images that are read."""
UNREAD_PICTURES: tuple[str, ...] = (
    *(".heic", ".heif", ".hif", ".jxl", ".psd", ".tga", ".exr", ".hdr", ".pfm", ".jxr"),
    # What cameras call raw; many begin like a TIFF file, whose first picture is a thumbnail.
    *(".dng", ".raw", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".srf", ".sr2", ".raf"),
    *(".orf", ".rw2", ".pef", ".srw", ".3fr", ".iiq", ".x3f", ".rwl", ".mrw", ".kdc", ".gpr"),
)
"""Suffixes of pictures that are not read."""
VIDEOS: tuple[str, ...] = (
    *(".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".wmv", ".mts"),
)
"""Suffixes of the usual videos."""
MOST_PIXELS = 160_000_000
"""A larger image is refused: it would take gigabytes, and minutes, to search."""
_FLAGS = cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION
_GREY_FLAGS = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
_ORIENTATION = 0x0112
_JPEG = b"\xff\xd8\xff"
# Long enough to tell an image whatever its name says.
_SURE = (_JPEG, b"\x89PNG\r\n", b"GIF87a", b"GIF89a", b"II*\0", b"MM\0*", b"\0\0\0\x0cjP  ")
_LIKELY = (*_SURE, b"BM", b"RIFF", b"\xff\x4f\xff\x51", b"II+\0", b"MM\0+")
_LIKELY = (*_LIKELY, *(b"P%d" % n for n in range(1, 8)))

# Pillow warns of images that are larger than it likes; `MOST_PIXELS` judges them here.
warnings.filterwarnings("ignore", category=Image.DecompressionBombWarning)


class UnreadableImageError(SourceError):
    """A file that gives no image. Among others it is left out, and named with `why`."""

    def __init__(self, sentence: str, why: str = "") -> None:
        super().__init__(sentence)
        self.why = why


@dataclass(frozen=True)
class ImageHeader:
    """What an image file says of itself."""

    size: tuple[int, int]
    """(width, height) of the stored rows and columns."""
    pictures: int = 1
    """Pages or frames in the file; the first is read."""
    orientation: int = 1
    """EXIF's tag: 1 as stored, 3 turned by 180°, 6 and 8 by 90°."""


def is_image(path: Path) -> bool:
    """Whether the file is named like an image that is read, or starts like one."""
    suffix = path.suffix.lower()
    if suffix in (*SUFFIXES, *UNREAD_PICTURES, *VIDEOS):
        return suffix in SUFFIXES
    try:
        start = read_regular(path, 12)
    except OSError:
        return False
    return start.startswith(_SURE) or (start[:4], start[8:]) == (b"RIFF", b"WEBP")


def read_header(path: Path) -> ImageHeader:
    """The file's header, if possible without decoding the pixels.
    Raises `UnreadableImageError` if it cannot be read, is no image, or is too large."""
    try:
        start = read_regular(path, 12)
        if not start:
            raise _empty(path)
        if not _is_likely(start):
            raise _no_image(path)
        with Image.open(path) as head:
            _check_size(path, head.width, head.height)
            return ImageHeader(head.size, _pictures(head), _orientation(head))
    except Image.DecompressionBombError as error:
        raise _too_large(path) from error
    except SourceError:
        raise
    except OSError as error:
        if error.errno is not None:
            raise _unreadable(path, error) from error
    except Exception:  # a damaged header makes Pillow raise anything
        pass
    height, width = read_image(path).shape[:2]  # a format that only OpenCV knows, or an error
    return ImageHeader((width, height))


def read_image(path: Path, *, grey: bool = False) -> NDArray[np.uint8]:
    """Pixels: (H, W, 3) BGR 8 bit, or (H, W) grey of 8 or 16 bit; 16-bit colour becomes grey.
    With `grey`, a JPEG's brightness alone, which takes a third of the time.
    Raises `UnreadableImageError` if the file is none, is truncated, or has other pixel types."""
    try:
        content = read_regular(path)
    except OSError as error:
        raise _unreadable(path, error) from error
    if not content:
        raise _empty(path)
    if not _is_likely(content[:12]):
        raise _no_image(path)
    _check_complete(path, content)
    is_jpeg = content.startswith(_JPEG)
    pixels = _decoded(content, _GREY_FLAGS if grey and is_jpeg else _FLAGS)
    if pixels is None:
        raise UnreadableImageError(
            f"The image {shown(path)} is damaged or incomplete; replace or remove it.",
            "damaged or incomplete",
        )
    if pixels.dtype not in (np.uint8, np.uint16):
        raise UnreadableImageError(
            f"The image {shown(path)} holds {pixels.dtype} numbers; save it with 8 or 16 bit per "
            "channel.",
            f"{pixels.dtype} numbers instead of 8 or 16 bit",
        )
    if pixels.ndim == 3 and pixels.dtype == np.uint16:
        # Corners are detected in grey: the depth is worth more than the colour.
        pixels = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
    return pixels


def shown(path: Path | str) -> str:
    """A path as text that can be printed and written: bytes that are not UTF-8 as \\xe4."""
    return os.fsencode(path).decode("utf-8", "backslashreplace")


def _decoded(content: bytes, flags: int) -> Any:
    silence_opencv()
    try:
        return cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error:  # a size that OpenCV refuses, or none
        return None


def _is_likely(start: bytes) -> bool:
    return start.startswith(_LIKELY) or start[4:8] == b"ftyp"


def _check_size(path: Path, width: int, height: int) -> None:
    if width * height > MOST_PIXELS:
        raise _too_large(path)


def _pictures(head: Image.Image) -> int:
    # Phones put a depth map or the brighter half of a picture behind it (MPO): no further picture.
    return 1 if head.format in ("JPEG", "MPO") else int(getattr(head, "n_frames", 1))


def _orientation(head: Image.Image) -> int:
    # Of a PNG file, Pillow would decode the pixels first.
    return 1 if head.format == "PNG" else int(head.getexif().get(_ORIENTATION, 1))


def _check_complete(path: Path, content: bytes) -> None:
    """Raise for a truncated JPEG, which OpenCV silently fills with grey."""
    if not content.startswith(_JPEG) or content.endswith(b"\xff\xd9"):
        return
    try:
        with Image.open(BytesIO(content)) as picture:
            picture.draft("L", (picture.width // 8, picture.height // 8))
            picture.load()
    except Image.DecompressionBombError as error:
        raise _too_large(path) from error
    except OSError as error:
        if "truncated" in str(error):
            raise UnreadableImageError(
                f"The image {shown(path)} breaks off early; copy it again or remove it.",
                "breaks off early",
            ) from error


def _empty(path: Path) -> UnreadableImageError:
    return UnreadableImageError(
        f"The file {shown(path)} is empty; record or copy it again.", "empty"
    )


def _no_image(path: Path) -> UnreadableImageError:
    return UnreadableImageError(
        f"{shown(path)} is not an image, whatever its name says; use a PNG, JPEG, TIFF or BMP "
        "file.",
        "not an image",
    )


def _too_large(path: Path) -> UnreadableImageError:
    most = f"more than {MOST_PIXELS // 10**6} megapixels"
    return UnreadableImageError(
        f"The image {shown(path)} has {most}, too many to search; scale all images down by the "
        "same whole number.",
        most,
    )


def _unreadable(path: Path, error: OSError) -> UnreadableImageError:
    if isinstance(error, PermissionError):
        return UnreadableImageError(
            f"The file {shown(path)} may not be read by you; check its permissions.",
            "may not be read by you",
        )
    reason = error.strerror or str(error)
    return UnreadableImageError(
        f"The file {shown(path)} cannot be read ({reason}); copy or remove it.", reason.lower()
    )

"""A folder, pattern or list of images as a source: sorted by name, without duplicates."""

from __future__ import annotations

import glob
import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from venus3d.engine.errors import SourceError
from venus3d.sources.frame import Frame
from venus3d.sources.images import SUFFIXES, read_image, size_of


class Folder:
    """Images of one size, in order; `Frame.time_s` counts them.

    All file headers are read at once, so that an unusable file is found before the work starts.
    Raises `SourceError` for an empty list, a file that is no image, and images of several sizes.
    """

    is_live = False

    def __init__(self, paths: Sequence[Path]) -> None:
        if not paths:
            raise SourceError("There are no images to read; give at least one.")
        self._paths = tuple(paths)
        self._size = _common_size(self._paths)
        self._next = 0
        self.notes: tuple[str, ...] = ()

    @staticmethod
    def of_directory(directory: Path) -> Folder:
        """The images in a directory, without subfolders."""
        try:
            files = [path for path in directory.iterdir() if path.is_file()]
        except OSError as error:
            raise SourceError(
                f"The folder {directory} cannot be read ({error.strerror}); check its permissions."
            ) from error
        images = [
            path
            for path in files
            if path.suffix.lower() in SUFFIXES and not path.name.startswith(".")
        ]
        if not images:
            raise SourceError(
                f"The folder {directory} holds no images; "
                "it needs PNG, JPEG, TIFF or BMP files right inside it."
            )
        return Folder(sorted(images, key=_natural))

    @staticmethod
    def of_pattern(pattern: str) -> Folder:
        """The files that match a pattern such as `shots/*.png`."""
        paths = [Path(name) for name in glob.glob(pattern, recursive=True)]
        images = [path for path in paths if path.is_file()]
        if not images:
            raise SourceError(
                f"No file matches {pattern}; check the pattern, and quote it in the shell."
            )
        return Folder(sorted(images, key=_natural))

    @property
    def image_size(self) -> tuple[int, int]:
        """(width, height) of all images."""
        return self._size

    def __len__(self) -> int:
        return len(self._paths)

    def read(self) -> Frame | None:
        """The next image; None after the last. Raises `SourceError` if it is damaged."""
        if self._next >= len(self._paths):
            return None
        path = self._paths[self._next]
        frame = Frame(read_image(path), float(self._next), path.name)
        if frame.image_size != self._size:
            raise SourceError(f"The image {path} changed its size meanwhile; start again.")
        self._next += 1
        return frame

    def close(self) -> None:
        """Ends reading; nothing is held open."""
        self._next = len(self._paths)


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort key that puts 2.png before 10.png."""
    parts = re.split(r"(\d+)", str(path))
    return [(int(part), "") if part.isdecimal() else (-1, part.lower()) for part in parts]


def _common_size(paths: Sequence[Path]) -> tuple[int, int]:
    by_size: dict[tuple[int, int], list[str]] = defaultdict(list)
    for path in paths:
        by_size[size_of(path)].append(path.name)
    if len(by_size) == 1:
        return next(iter(by_size))
    # The rarest size first: most often it is the stray one to be removed.
    groups = sorted(by_size.items(), key=lambda item: len(item[1]))
    sizes = "; ".join(f"{_named(names)}: {w} x {h} px" for (w, h), names in groups)
    raise SourceError(
        f"The images have {len(groups)} sizes ({sizes}); keep one size, one camera has only one."
    )


def _named(names: list[str]) -> str:
    shown = ", ".join(names[:3])
    return shown if len(names) <= 3 else f"{shown} and {len(names) - 3} more"

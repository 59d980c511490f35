"""A folder, pattern or list of images as a source: sorted by name, without duplicates."""

from __future__ import annotations

import glob
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

from venus3d.engine.errors import SourceError
from venus3d.engine.sentences import listed
from venus3d.sources.frame import Frame, RealSource
from venus3d.sources.images import (
    SUFFIXES,
    UNREAD_PICTURES,
    VIDEOS,
    ImageHeader,
    UnreadableImageError,
    is_image,
    read_header,
    read_image,
    shown,
)

_MOST_NAMED = 5


class Folder(RealSource):
    """Images of one size, in order; `Frame.time_s` counts them.

    Whichever way they are named, a file is read if its name or its content is that of an image
    (`is_image`), and the notes say what was left out: also what proves to be damaged when it is
    read, which is no reason to lose the others. All file headers are read at once, so that most of
    that is found before the work starts. Raises `SourceError` for an empty list, for images of
    several sizes, and if none can be read.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        if not paths:
            raise SourceError("There are no images to read; give at least one.")
        # A file that is named twice is read once.
        self._paths, left_out = _sorted_out(dict.fromkeys(paths))
        if not self._paths:
            videos = [path for path in paths if path.suffix.lower() in VIDEOS]
            if videos:
                raise SourceError(
                    f"There are no images, but {shown(videos[0].name)} is a video: give the video "
                    f"itself, {shown(videos[0])}."
                )
            raise SourceError(f"{_left_out(left_out)} There is no other image.")
        self._unread: dict[Path, UnreadableImageError] = {}
        headers: dict[Path, ImageHeader] = {}
        for path in self._paths:
            try:
                headers[path] = read_header(path)
            except UnreadableImageError as error:
                self._unread[path] = error
        self.check_any()
        self._size = _common_size(headers)
        self._next = 0
        self._notes = (
            *([_left_out(left_out)] if left_out else []),
            *_header_notes(headers),
        )

    @staticmethod
    def of_directory(directory: Path) -> Folder:
        """The images in a directory, without subfolders."""
        try:
            entries = [path for path in directory.iterdir() if not path.name.startswith(".")]
        except OSError as error:
            raise SourceError(
                f"The folder {shown(directory)} cannot be read ({error.strerror}); check its "
                "permissions."
            ) from error
        # Tables, notes and earlier results lie beside the images: nobody misses them.
        images = [path for path in entries if _has_picture_name(path) or is_image(path)]
        if not images:
            deeper = next((one for one in sorted(entries) if _holds_images(one)), None)
            raise SourceError(
                f"The folder {shown(directory)} holds no images; "
                + (
                    "it needs PNG, JPEG, TIFF or BMP files right inside it."
                    if deeper is None
                    else f"there are some in {shown(deeper)}: give that."
                )
            )
        return Folder(sorted(images, key=_natural))

    @staticmethod
    def of_pattern(pattern: str) -> Folder:
        """The files that match a pattern such as `shots/*.png`."""
        paths = [Path(name) for name in glob.glob(pattern, recursive=True)]
        images = [path for path in paths if not path.is_dir() or _has_picture_name(path)]
        if not images:
            raise SourceError(
                f"No file matches {shown(pattern)}; check the pattern, and quote it in the shell."
            )
        return Folder(sorted(images, key=_natural))

    @property
    def notes(self) -> tuple[str, ...]:
        """What was left out and what a person should know of the rest, as far as it was read."""
        unread = self._in_order()
        return (*([_unread(unread)] if unread else []), *self._notes)

    @property
    def unread(self) -> int:
        """Number of the images that could not be read so far."""
        return len(self._unread)

    def __len__(self) -> int:
        """Number of the images but for those that could not be read so far."""
        return len(self._paths) - len(self._unread)

    def check_any(self) -> None:
        """Raise the first image's error if none can be read."""
        if len(self._unread) == len(self._paths):
            raise self._in_order()[0][1]

    def read(self) -> Frame | None:
        """The next image that can be read; None after the last. Raises `SourceError` if it was
        none, and for one that changed its size."""
        while self._next < len(self._paths):
            self._next += 1
            frame = self._read(self._next - 1)
            if frame is not None:
                return frame
        self.check_any()
        return None

    def readers(self) -> Iterator[Callable[[], Frame | None]]:
        """A function for each image, in order, that reads it on any thread, a JPEG as grey. It
        gives None for one that is left out."""
        return (partial(self._read, index, grey=True) for index in range(len(self._paths)))

    def close(self) -> None:
        """Ends reading; nothing is held open."""
        self._next = len(self._paths)

    def _in_order(self) -> list[tuple[Path, UnreadableImageError]]:
        return [(path, self._unread[path]) for path in self._paths if path in self._unread]

    def _read(self, index: int, *, grey: bool = False) -> Frame | None:
        path = self._paths[index]
        if path in self._unread:
            return None
        try:
            image = read_image(path, grey=grey)
        except UnreadableImageError as error:
            self._unread[path] = error
            return None
        frame = Frame(image, float(index), shown(path.name)).flipped(self.flip)
        if frame.image_size != self._size:
            raise SourceError(f"The image {shown(path)} changed its size meanwhile; start again.")
        return frame


def _holds_images(path: Path) -> bool:
    try:
        return path.is_dir() and any(one.suffix.lower() in SUFFIXES for one in path.iterdir())
    except OSError:
        return False


def _has_picture_name(path: Path) -> bool:
    return path.suffix.lower() in (*SUFFIXES, *UNREAD_PICTURES, *VIDEOS)


def _sorted_out(paths: Iterable[Path]) -> tuple[tuple[Path, ...], list[str]]:
    """The images, and the names of the others."""
    images: list[Path] = []
    others: list[str] = []
    for path in paths:
        if path.is_dir() or not (is_image(path) or not path.exists()):
            others.append(shown(path.name))
        else:
            images.append(path)  # whatever is wrong with it is told when it is opened
    return tuple(images), others


def _left_out(names: list[str]) -> str:
    if len(names) == 1:
        return (
            f"{names[0]} is left out, as it is not read as an image; save it as a JPEG or PNG file "
            "of full size if it is one."
        )
    return (
        f"{len(names)} files are left out, as they are not read as images "
        f"({listed(names, most=_MOST_NAMED)}); save those that are as JPEG or PNG files of full "
        "size."
    )


def _unread(files: list[tuple[Path, UnreadableImageError]]) -> str:
    named = [f"{shown(path.name)} ({error.why})" for path, error in files]
    if len(named) == 1:
        return f"{named[0]} cannot be read and is left out; copy it again or remove it."
    return (
        f"{len(named)} files cannot be read and are left out: {listed(named, most=_MOST_NAMED)}; "
        "copy them again or remove them."
    )


def _header_notes(headers: dict[Path, ImageHeader]) -> Iterator[str]:
    several = [shown(path.name) for path, header in headers.items() if header.pictures > 1]
    if several:
        pages = sum(header.pictures - 1 for header in headers.values())
        more = "one more is" if pages == 1 else f"{pages} more are"
        yield (
            f"Of {listed(several, most=_MOST_NAMED)} only the first picture is read, and {more} "
            "left out; save each as a file of its own."
        )
    turned = sum(header.orientation != 1 for header in headers.values())
    if turned:
        yield (
            f"{turned} of {len(headers)} images {'has' if turned == 1 else 'have'} an orientation "
            "tag, which is not applied: a lens is calibrated on the sensor's rows and columns. "
            "Read images the same way before you undistort them (cv2.IMREAD_IGNORE_ORIENTATION)."
        )


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort key that puts 2.png before 10.png."""
    parts = re.split(r"(\d+)", str(path))
    return [(int(part), "") if part.isdecimal() else (-1, part.lower()) for part in parts]


def _common_size(headers: dict[Path, ImageHeader]) -> tuple[int, int]:
    by_size: dict[tuple[int, int], list[str]] = defaultdict(list)
    for path, header in headers.items():
        by_size[header.size].append(shown(path.name))
    if len(by_size) == 1:
        return next(iter(by_size))
    # The rarest size first: most often it is the stray one to be removed.
    groups = sorted(by_size.items(), key=lambda item: len(item[1]))
    sizes = "; ".join(f"{_named(names)}: {w} x {h} px" for (w, h), names in groups)
    turned = len(groups) == 2 and groups[0][0] == groups[1][0][::-1]
    why = (
        "some were turned by 90° by a program: turn those back, all by the same quarter"
        if turned
        else "keep one size, one camera has only one"
    )
    raise SourceError(f"The images have {len(groups)} sizes ({sizes}); {why}.")


def _named(names: list[str]) -> str:
    shown_names = ", ".join(names[:3])
    return shown_names if len(names) <= 3 else f"{shown_names} and {len(names) - 3} more"

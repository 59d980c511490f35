"""A folder that is still being filled, by a tethered camera or a phone that copies its pictures."""

from __future__ import annotations

import threading
import time
from pathlib import Path

from venus3d.engine.errors import SourceError
from venus3d.sources.frame import Frame, RealSource
from venus3d.sources.images import is_image, read_header, read_image, shown
from venus3d.sources.live import OtherSize

_LOOK_S = 0.25
_GIVEN_UP_S = 10.0
"""A file that cannot be read for so long after it last grew is damaged, and not half written."""


class WatchedFolder(RealSource):
    """The pictures in a folder, those that are there and those that come; never at its end.

    A picture of another size than the first one is left out, and `trouble` says so until the next.
    """

    def __init__(self, directory: Path) -> None:
        """Watch `directory`. Raises `SourceError` if it is none or holds no picture yet, since a
        session needs to know its picture size."""
        if not directory.is_dir():
            raise SourceError(f"There is no folder {shown(directory)} to watch; make it first.")
        self._directory = directory
        self.notes: tuple[str, ...] = ()
        self._read: set[Path] = set()
        self._grown: dict[Path, tuple[int, float]] = {}
        self._stop = threading.Event()
        self._count = 0
        self._refused: tuple[int, int] | None = None
        self._size = self._first_size()

    @property
    def trouble(self) -> OtherSize | None:
        """That the last picture had another size; None if it could be used."""
        return None if self._refused is None else OtherSize(self._size, self._refused)

    def accept_size(self) -> tuple[int, int]:
        """Go on with the size of the last picture, which is returned: for a new session."""
        self._size = self._refused or self._size
        return self._size

    def read(self) -> Frame | None:
        """The next picture, waiting for one; None once closed."""
        while not self._stop.is_set():
            for path in self._newcomers():
                if (frame := self._frame(path)) is not None:
                    return frame
            self._stop.wait(_LOOK_S)
        return None

    def close(self) -> None:
        """Stop waiting; from any thread. May be called twice."""
        self._stop.set()

    def _first_size(self) -> tuple[int, int]:
        unread: SourceError | None = None
        for path in self._newcomers():
            try:
                return read_header(path).size
            except SourceError as error:
                unread = unread or error
        raise unread or SourceError(
            f"{shown(self._directory)} holds no picture yet; take one, so that its size is known, "
            "and start again."
        )

    def _newcomers(self) -> list[Path]:
        """Pictures that were not read yet, the oldest first."""
        try:
            new = [path for path in self._directory.iterdir() if path not in self._read]
            new = [path for path in new if not path.name.startswith(".") and is_image(path)]
            return sorted(new, key=lambda path: (path.stat().st_mtime_ns, path.name))
        except OSError:  # a file that was renamed meanwhile, a folder that comes back
            return []

    def _frame(self, path: Path) -> Frame | None:
        try:
            size = path.stat().st_size
            if size != self._grown.get(path, (-1, 0.0))[0]:
                self._grown[path] = (size, time.monotonic())
            image = read_image(path)
        except (SourceError, OSError) as error:
            # Half written, most likely.
            if time.monotonic() - self._grown.get(path, (0, time.monotonic()))[1] > _GIVEN_UP_S:
                self._read.add(path)
                self.notes = (*self.notes, str(error))
            return None
        self._read.add(path)
        self._count += 1
        frame = Frame(image, float(self._count), shown(path.name)).flipped(self.flip)
        self._refused = None if frame.image_size == self._size else frame.image_size
        return frame if self._refused is None else None

"""Reads small files: a pipe or a device instead of one would be waited for, for ever."""

from __future__ import annotations

import errno
import stat
from pathlib import Path


def read_regular(path: Path, most: int = -1) -> bytes:
    """The content of a file, or its first `most` bytes. Raises `OSError`, also for what is no
    regular file."""
    mode = path.stat().st_mode
    if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # of a folder the system says so
        raise OSError(errno.EINVAL, "Not a regular file")
    with path.open("rb") as file:
        return file.read(most)

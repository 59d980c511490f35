"""The folder that results go into: made and tried before the work starts, written to safely."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from venus3d.engine.errors import StorageError


def prepare(directory: Path, option: str = "--output") -> Path:
    """Make `directory`, with its parents, and make sure that files can be written into it.

    Raises `StorageError`, which names the option to change, now rather than after an hour of
    calibrating.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        # Only writing tells: permission bits do not stop root, and full or read-only disks do.
        with tempfile.TemporaryFile(dir=directory) as trial:
            trial.write(b"venus3d")
    except OSError as error:
        raise StorageError(
            f"Nothing can be written to {directory} ({reason(error)}); "
            f"choose another folder with {option}."
        ) from error
    return directory


def write_bytes(path: Path, content: bytes) -> Path:
    """Write a file whole or not at all, even if the power goes. Raises `StorageError`."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_files({path: content})
    except OSError as error:
        raise StorageError(
            f"{path} cannot be written ({reason(error)}); choose another place."
        ) from error
    return path


def replace_files(contents: Mapping[Path, bytes], before: Callable[[], None] | None = None) -> None:
    """Write files of one folder, each whole or not at all, even if the program is killed or the
    power goes.

    All that takes long is done beside them; then they take their places one right after the other.
    `before` is called in between. Raises `OSError`; what could not be written is then as it was.
    """
    beside: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            beside[path] = path.with_name(f".{path.name}.{uuid4().hex[:8]}")
            with beside[path].open("xb") as file:
                file.write(content)
                file.flush()
                # Without this a power cut may leave the new name with nothing in it.
                os.fsync(file.fileno())
        if before is not None:
            before()
        for path, written in beside.items():
            os.replace(written, path)
    except BaseException:
        for written in beside.values():
            written.unlink(missing_ok=True)
        raise
    for folder in {path.parent for path in contents}:
        sync_folder(folder)


def sync_folder(folder: Path) -> None:
    """Put on the disk which names a folder has, where that can be asked for."""
    # Windows opens no folders, some network disks do not sync them.
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def locked(folder: Path) -> Generator[None, None, None]:
    """Keep other processes and threads that ask for the same out meanwhile, where that is possible.

    Raises `OSError` if there is no such folder.
    """
    if sys.platform == "win32":
        yield
        return
    import fcntl

    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # some network disks lock no folders
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def reason(error: OSError) -> str:
    """Why, in a few words that fit into brackets."""
    if isinstance(error, FileExistsError):  # mkdir's answer where a file has the folder's name
        return "not a directory"
    return (error.strerror or str(error)).lower()

"""The output folder: checked before the work starts, written atomically."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Generator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

from venus3d.engine.errors import StorageError
from venus3d.storage.places import refuse_session


def prepare(directory: Path, option: str = "--output") -> Path:
    """Create `directory` with its parents, and make sure that files can be written into it.
    Raises `StorageError`, which names the option to change, before rather than after the work."""
    refuse_session(directory, f"name another with {option}")
    try:
        directory.mkdir(parents=True, exist_ok=True)
        # Only writing tells: permission bits do not stop root, and disks may be full or read-only.
        with tempfile.TemporaryFile(dir=directory) as trial:
            trial.write(b"venus3d")
    except OSError as error:
        raise StorageError(
            f"Nothing can be written to {directory} ({reason(error)}); "
            f"choose another folder with {option}."
        ) from error
    return directory


def write_bytes(path: Path, content: bytes) -> Path:
    """Write a file atomically, even if the power fails. Raises `StorageError`, also for a file of a
    session, which only the session writes."""
    refuse_session(path, "choose another place")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_files({path: content})
    except OSError as error:
        raise StorageError(
            f"{path} cannot be written ({reason(error)}); choose another place."
        ) from error
    return path


def replace_files(contents: Mapping[Path, bytes], before: Callable[[], None] | None = None) -> None:
    """Write files of one folder, each atomically, even if the program is killed or the power fails.

    They are written under temporary names, then `before` is called, then they are renamed one right
    after the other. Raises `OSError`; files not written are unchanged.
    """
    beside: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            beside[path] = path.with_name(f".{path.name}.{uuid4().hex[:8]}")
            with beside[path].open("xb") as file:
                file.write(content)
                file.flush()
                # Without this a power failure may leave the new name with an empty file.
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
    """Sync a folder's names to disk, where possible."""
    # Windows opens no folders, some network disks do not sync them.
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def locked(folder: Path) -> Generator[None, None, None]:
    """Lock a folder against other processes and threads that use this lock, where possible.
    Raises `OSError` if there is no such folder."""
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
    """The reason in a few words that fit into brackets."""
    if isinstance(error, FileExistsError):  # mkdir's answer if a file has the folder's name
        return "not a directory"
    return (error.strerror or str(error)).lower()

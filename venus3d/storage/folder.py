"""The folder that results go into: made and tried before the work starts."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

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
            f"Nothing can be written to {directory} ({_reason(error)}); "
            f"choose another folder with {option}."
        ) from error
    return directory


def write_bytes(path: Path, content: bytes) -> Path:
    """Write a file whole or not at all. Raises `StorageError`."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # An interruption must not leave half a result in the place of a good one.
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            os.chmod(name, 0o666 & ~_umask())
            os.replace(name, path)
        except BaseException:
            os.unlink(name)
            raise
    except OSError as error:
        raise StorageError(
            f"{path} cannot be written ({_reason(error)}); choose another place."
        ) from error
    return path


def _reason(error: OSError) -> str:
    if isinstance(error, FileExistsError):  # mkdir's answer where a file has the folder's name
        return "not a directory"
    return (error.strerror or str(error)).lower()


def _umask() -> int:
    # Python can read the umask only by setting it.
    mask = os.umask(0o022)
    os.umask(mask)
    return mask

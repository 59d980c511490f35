"""Where a command may write: over no file of a session, of a calibration, or of its own source."""

from __future__ import annotations

import os
from pathlib import Path

from venus3d.engine.errors import StorageError

HEADER, EVENTS, VIEWS = "session.json", "events.jsonl", "views"
_RESULT = ("camera.yaml", "result.json")
_ANOTHER = "name another with --output"


def is_session(directory: Path) -> bool:
    """Whether a folder holds a session."""
    return (directory / HEADER).is_file()


def refuse_session(path: Path, cure: str = _ANOTHER) -> None:
    """Raise `StorageError` if a file or folder is a session's own, there already or not, or if it
    is a device or a pipe: a file would take its place."""
    # A link to one as well, such as /dev/stdout.
    if os.path.exists(path) and not (os.path.isfile(path) or os.path.isdir(path)):
        raise StorageError(f"{path} is a device or a pipe, no file; {cure}.")
    # A link is replaced itself, not what it leads to; a folder's link leads into the folder.
    for place in (Path(os.path.abspath(path)), Path(os.path.realpath(path))):
        folders = [one.parent for one in (place, *place.parents) if one.name == VIEWS]
        if place.name in (HEADER, EVENTS, *_RESULT):
            folders.append(place.parent)
        for folder in filter(is_session, folders):
            raise StorageError(
                f"{path} is not written: {folder.name} is the folder of a session; {cure}."
            )


def free_place(path: Path, *sources: Path, replaces: bool, option: str = "--output") -> Path:
    """`path`, if a command may write this file. Raises `StorageError` for a file of a session or of
    a calibration, for one of the sources, and where a file is that it must not replace."""
    cure = f"name another with {option}"
    refuse_session(path, cure)
    pair = [path.parent / name for name in _RESULT]
    if path in pair and all(map(os.path.exists, pair)):
        raise StorageError(f"{path} belongs to the calibration in {path.parent}; {cure}.")
    there = os.path.exists(path)
    if there and any(os.path.exists(one) and path.samefile(one) for one in sources):
        raise StorageError(f"{path} is the source itself; {cure}.")
    if there and not replaces:
        raise StorageError(f"{path} exists already and holds something else; {cure}.")
    return path

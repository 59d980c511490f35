"""Reads a session's folder (`session_folder`) without opening it: another may go on meanwhile."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, cast

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import StorageError
from venus3d.engine.guidance.views import CapturedView
from venus3d.regular_file import read_regular
from venus3d.storage.damaged import DAMAGED
from venus3d.storage.folder import reason
from venus3d.storage.places import EVENTS, HEADER, VIEWS

SCHEMA = 1
"""Version of session.json and events.jsonl."""

Event = dict[str, Any]


def read_header(directory: Path) -> Event:
    """session.json of a folder. Raises `StorageError`."""
    path = directory / HEADER
    try:
        content = json.loads(read_regular(path).decode())
    except OSError as error:
        raise StorageError(
            f"{directory} holds no session ({HEADER}: {reason(error)}); give the folder that "
            "venus3d guide has written."
        ) from error
    except (ValueError, RecursionError) as error:
        raise StorageError(f"{path} is damaged ({error}); {way_out(directory)}") from error
    schema: Any = content.get("schema") if isinstance(content, dict) else None
    if type(schema) is int and schema > SCHEMA:
        raise StorageError(
            f"{path} has schema {schema}, and this version reads schema {SCHEMA}: a newer venus3d "
            f"wrote it. Update venus3d; or {way_out(directory)}"
        )
    if schema != SCHEMA:
        raise StorageError(f"{path} is damaged (no schema); {way_out(directory)}")
    return dict(content)


def way_out(directory: Path) -> str:
    """What can be done with a session that cannot be gone on with; the end of a sentence."""
    return (
        f"calibrate from its pictures: venus3d calibrate {directory / VIEWS}, with --board.* for "
        "another board than the usual one."
    )


def read_journal(directory: Path) -> tuple[list[Event], int]:
    """The events in order, and the size in bytes of the lines that are whole: what lies behind was
    cut off. Raises `StorageError` for a journal that cannot be read."""
    path = directory / EVENTS
    try:
        content = read_regular(path)
    except OSError as error:
        raise StorageError(
            f"{path} cannot be read ({reason(error)}); {way_out(directory)}"
        ) from error
    whole = content[: content.rfind(b"\n") + 1]
    try:
        events = [json.loads(line) for line in whole.splitlines()]
    except (ValueError, RecursionError) as error:
        raise damaged(directory) from error
    if not all(map(_is_event, events)):
        raise damaged(directory)
    return events, len(whole)


def _is_event(line: Any) -> bool:
    """Whether a line of a journal has what every reader takes for granted."""
    if not isinstance(line, dict):
        return False
    event = cast(Event, line)
    if event.get("event") != "captured":
        return isinstance(event.get("event"), str)
    return isinstance(event.get("number"), int) and isinstance(event.get("picture", 0), str | None)


def damaged(directory: Path) -> StorageError:
    """For a journal that makes no sense."""
    return StorageError(
        f"{directory / EVENTS} is no journal of this version of venus3d, or is damaged; its "
        f"pictures are in {directory / VIEWS}: venus3d calibrate {directory}."
    )


def camera_settings(directory: Path) -> dict[str, Any] | None:
    """What was set on the camera last: a number of the driver's, "auto" or None by the setting's
    name; None if nothing was. Raises `StorageError`."""
    events, _ = read_journal(directory)
    try:
        told = [dict(event["settings"]) for event in events if event["event"] == "camera"]
    except DAMAGED as error:
        raise damaged(directory) from error
    return told[-1] if told else None


def pictures_by_number(events: Sequence[Event]) -> dict[int, str]:
    """The path within the folder of each captured view's picture, by the view's number."""
    return {
        int(event["number"]): str(event["picture"])
        for event in events
        if event["event"] == "captured" and event["picture"] is not None
    }


def kept_pictures(
    directory: Path, numbers: Sequence[int]
) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Number and picture (BGR) of each of a session's views, as far as they were kept and can be
    read; another process may be writing the session."""
    names = pictures_by_number(read_journal(directory)[0])
    return read_pictures(
        {number: directory / names[number] for number in numbers if number in names}
    )


def pictures_of(directory: Path, views: Sequence[CapturedView]) -> dict[int, Path]:
    """The pictures of those views that the session in a folder, if there is one, has captured: with
    the same corners. Numbers alone do not tell, as a session that was begun anew has each twice."""
    try:
        events, _ = read_journal(directory)
        return {
            int(event["number"]): directory / str(event["picture"])
            for event in events
            if event["event"] == "captured" and event["picture"] is not None
            for view in views
            if view.number == event["number"] and _has_corners(event, view)
        }
    except (*DAMAGED, StorageError):
        return {}


def missing_pictures(directory: Path, numbers: Sequence[int]) -> dict[int, str]:
    """Of these views, the pictures that were kept and are not there: paths within the folder."""
    names = pictures_by_number(read_journal(directory)[0])
    return {
        number: names[number]
        for number in numbers
        if number in names and not (directory / names[number]).is_file()
    }


def _has_corners(event: Event, view: CapturedView) -> bool:
    seen, ids = view.observation, np.array(event["ids"], dtype=np.intp)
    order, own_order = np.argsort(ids), np.argsort(seen.ids)
    corners = np.array(event["corners_px"], dtype=np.float64).reshape(ids.size, 2)
    return np.array_equal(ids[order], seen.ids[own_order]) and np.array_equal(
        corners[order], seen.corners[own_order]
    )


def read_pictures(files: Mapping[int, Path]) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Number and picture (BGR) of each view whose file can be read."""
    for number, path in files.items():
        with suppress(OSError, cv2.error):
            raw = np.frombuffer(path.read_bytes(), np.uint8)
            picture = cv2.imdecode(raw, cv2.IMREAD_COLOR)
            if picture is not None:
                yield number, np.asarray(picture, dtype=np.uint8)


def picture_files(directory: Path, tell: Callable[[str], None]) -> list[Path]:
    """The pictures of the views that count; if the journal does not tell, all that are there.
    `tell` receives a sentence for each that is missing. Raises `StorageError` if there is none."""
    try:
        files = _counted(directory)
    except (*DAMAGED, StorageError):
        files = sorted((directory / VIEWS).glob("*.png"))
    there = [path for path in files if path.is_file()]
    for path in files:
        if path not in there:
            tell(f"{path} is missing and left out.")
    if not there:
        raise StorageError(f"{directory} is a session without a picture; there is nothing to read.")
    return there


def _counted(directory: Path) -> list[Path]:
    events, _ = read_journal(directory)
    counted: list[int] = []
    for event in events:
        if event["event"] == "state":
            counted = list(event["views"])
        elif event["event"] == "captured":
            counted.append(event["number"])
    names = pictures_by_number(events)
    return [directory / names[number] for number in counted if number in names]

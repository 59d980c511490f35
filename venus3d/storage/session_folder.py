"""A guided session on disk: what it was started with, every view, and all that has happened.

    session.json     what the session was started with, and from the first view on the size of the
                     camera's pictures and the board as it is read
    events.jsonl     one line for each event, in order
    views/007.png    the picture of view 7 as it was captured, lossless
    camera.yaml, result.json   after every view (`result_folder`)

A view is on the disk, picture and line, before the session counts it, and a file is complete under
its name or not there. Only the journal's last line can be cut off; it is left out then, and said.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import StorageError
from venus3d.engine.guidance.record import SessionState
from venus3d.engine.guidance.views import CapturedView
from venus3d.storage.damaged import DAMAGED
from venus3d.storage.folder import prepare, reason, replace_files, sync_folder, write_bytes
from venus3d.storage.places import EVENTS, HEADER, VIEWS, is_session
from venus3d.storage.result import board_summary
from venus3d.storage.session_events import captured_event, state_event, state_of
from venus3d.storage.session_reader import (
    SCHEMA,
    camera_settings,
    damaged,
    kept_pictures,
    read_header,
    read_journal,
)

_LOCK = ".lock"
_FAST = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_SUB]
"""Less than half the time of other filters, a third more bytes."""


class SessionFolder:
    """The folder of one session, locked while it is open. A `Recorder`, which writes on a thread of
    its own: a disk takes its time."""

    def __init__(
        self, directory: Path, header: Mapping[str, Any], tell: Callable[[str], None]
    ) -> None:
        """Use `create` or `open`."""
        self.directory, self.header, self._tell = directory, header, tell
        self._is_new = False  # begun here, and no view yet
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="journal")
        self._lock = _locked(directory)
        try:
            (directory / VIEWS).mkdir(exist_ok=True)
            self._events = (directory / EVENTS).open("ab")
        except OSError as error:
            self._lock()
            raise _unwritable(directory, error) from error

    @classmethod
    def create(
        cls, directory: Path, header: Mapping[str, Any], tell: Callable[[str], None]
    ) -> SessionFolder:
        """A new session; `header` is what it is started with, `tell` receives remarks.
        Raises `StorageError` if the folder has a session already, or cannot be written."""
        if is_session(directory):
            raise StorageError(
                f"{directory} holds a session already; go on with it by --resume {directory}, or "
                "choose another folder with --output."
            )
        prepare(directory)
        content = {"schema": SCHEMA, **header}
        folder = cls(directory, content, tell)
        write_bytes(directory / HEADER, _json(content))
        folder._is_new = True
        return folder

    @classmethod
    def open(cls, directory: Path, tell: Callable[[str], None]) -> SessionFolder:
        """An existing session, to go on with it. Raises `StorageError` if there is none, it cannot
        be read, or another process has it open."""
        return cls(directory, read_header(directory), tell)

    def close(self) -> None:
        """Let others open it; one begun here without a view goes, so that a mistyped source does
        not take its name. Waits for what is being written. May be called twice."""
        self._writer.shutdown()
        self._events.close()
        if self._is_new:
            self._is_new = False
            for name in (HEADER, EVENTS, _LOCK):
                (self.directory / name).unlink(missing_ok=True)
            for folder in (self.directory / VIEWS, self.directory):
                with suppress(OSError):  # not empty: somebody else's files stay
                    folder.rmdir()
        self._lock()

    def state(self) -> SessionState | None:
        """The session as it was last; None if nothing had been captured.
        Raises `StorageError` for a journal that cannot be read."""
        events, whole = read_journal(self.directory)
        path = self.directory / EVENTS
        if path.stat().st_size > whole:
            self._tell(f"The last line of {path} was cut off, and is left out.")
            os.truncate(path, whole)
        try:
            return state_of(events)
        except DAMAGED as error:
            raise damaged(self.directory) from error

    def pictures(self, state: SessionState) -> Iterator[tuple[int, NDArray[np.uint8]]]:
        """Number and picture (BGR) of each of its views, as far as they can be read."""
        return kept_pictures(self.directory, [view.number for view in state.views])

    def camera(self) -> dict[str, Any] | None:
        """What was set on the camera last, as given to `camera_set`; None if nothing was.
        Raises `StorageError`."""
        return camera_settings(self.directory)

    def camera_set(self, settings: Mapping[str, Any]) -> None:
        """Write what is set on the camera; a failure is told, as no view is lost by it."""
        self._writer.submit(self._note, {"event": "camera", "settings": dict(settings)})

    # -- the recorder ----------------------------------------------------------------------------

    def captured(self, view: CapturedView) -> Future[None]:
        """Begin to write the picture, then the line; what comes of it raises `StorageError` if that
        fails, and nothing is captured then."""
        return self._writer.submit(self._write, view)

    def _write(self, view: CapturedView) -> None:
        seen, picture = view.observation, None
        if seen.image is not None:
            picture = f"{VIEWS}/{view.number:03d}.png"
            path = self.directory / picture
            done, encoded = cv2.imencode(".png", seen.image, _FAST)
            if not done:
                raise StorageError(f"{path} cannot be encoded.")
            if path.exists():  # of a view that was taken back
                path = path.with_name(f"{view.number:03d}-{datetime.now():%H%M%S%f}.png")
                picture = f"{VIEWS}/{path.name}"
            try:
                replace_files({path: encoded.tobytes()})
            except OSError as error:
                raise _unwritable(self.directory, error) from error
        self._complete_header(view)
        self._append(captured_event(view, picture))
        self._is_new = False
        self._tell(f"View {view.number} is kept{f' as {picture}' if picture else ''}.")

    def adopt(self, views: Sequence[CapturedView], pictures: Mapping[int, Path]) -> None:
        """Begin with views that were captured elsewhere, and with the files that hold their
        pictures, by the views' numbers. Raises `StorageError`."""
        for view in views:
            picture = None
            with suppress(LookupError, OSError):  # the view counts without it
                content = pictures[view.number].read_bytes()
                name = f"{VIEWS}/{view.number:03d}.png"
                replace_files({self.directory / name: content})
                picture = name
            self._complete_header(view)
            self._append(captured_event(view, picture))

    def _complete_header(self, view: CapturedView) -> None:
        """Write into session.json what only a view tells, with the first one."""
        seen = view.observation
        if "image_size" in self.header or seen.board is None:
            return
        board = board_summary(seen.board)
        self.header = {**self.header, "image_size": list(seen.image_size), "board": board}
        try:
            replace_files({self.directory / HEADER: _json(self.header)})
        except OSError as error:
            raise _unwritable(self.directory, error) from error

    def changed(self, state: SessionState) -> None:
        """Begin to write the state's line; a failure is told, as no view is lost by it."""
        self._is_new = self._is_new and not state.views
        self._writer.submit(self._note, state_event(state))

    def _note(self, event: Mapping[str, Any]) -> None:
        try:
            self._append(event)
        except StorageError as error:
            self._tell(str(error))

    def _append(self, event: Mapping[str, Any]) -> None:
        line = {"at": datetime.now().isoformat(timespec="milliseconds"), **event}
        start = self._events.tell()
        try:
            self._events.write(json.dumps(line, separators=(",", ":")).encode() + b"\n")
            self._events.flush()
            os.fsync(self._events.fileno())
        except OSError as error:
            self._cut_back(start)
            raise _unwritable(self.directory, error) from error

    def _cut_back(self, size: int) -> None:
        """Take back half a line, and what the buffer still holds of it."""
        path = self.directory / EVENTS
        with suppress(OSError):
            self._events.close()
        os.truncate(path, size)
        self._events = path.open("ab")


def _json(content: Mapping[str, Any]) -> bytes:
    return (json.dumps(content, indent=2) + "\n").encode()


def _unwritable(directory: Path, error: OSError) -> StorageError:
    return StorageError(
        f"nothing can be written to {directory} ({reason(error)}); make room there. All views "
        "captured before are safe."
    )


def _locked(directory: Path) -> Callable[[], None]:
    """Lock a session for this process, which the system unlocks when it dies; returns the key.
    Raises `StorageError` if another process has it."""
    if sys.platform == "win32":
        return lambda: None
    import fcntl

    try:
        handle = os.open(directory / _LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except OSError as error:
        raise _unwritable(directory, error) from error
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        os.close(handle)
        raise StorageError(
            f"{directory} is open in another venus3d; end that one, or choose another folder."
        ) from error
    except OSError:  # some network disks lock nothing
        pass
    sync_folder(directory)
    keys = [handle]

    def unlock() -> None:
        while keys:
            os.close(keys.pop())

    return unlock

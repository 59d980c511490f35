"""camera.yaml and result.json of one session; other files with these names are kept."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.errors import StorageError
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.sentences import Sentence
from venus3d.storage.camera_yaml import camera_yaml
from venus3d.storage.folder import locked, reason, replace_files, sync_folder
from venus3d.storage.result import result_json

_NOT_WRITTEN = Sentence(
    "camera.yaml and result.json cannot be written to {folder} ({reason}); make room there, or put "
    "the folder right."
)


class ResultFolder:
    """The output of one session, rewritten repeatedly. Used by one thread at a time.

    A file that this session did not write (an earlier result, another program's, an edited one) is
    renamed before it is replaced. Two sessions may share a folder: the first to write continues
    under the names that its files were given.
    """

    def __init__(self, directory: Path, tell: Callable[[str], None] = lambda _: None) -> None:
        """Nothing is written yet. `tell` receives the new names of an earlier result."""
        self.directory = directory
        self._tell = tell
        self._tail = ""
        self._is_written = False
        self._run = 1
        self._own: dict[Path, bytes] = {}
        self._kept: dict[Path, bytes] = {}

    @property
    def paths(self) -> tuple[Path, Path]:
        """The present or future paths of camera.yaml and result.json."""
        return self._paths(self._tail)

    @property
    def is_written(self) -> bool:
        """Whether this session has written a result."""
        return self._is_written

    def adopt(self) -> None:
        """Treat the files that are there as this session's own: it is being gone on with."""
        contents = {path: _content(path) for path in self.paths}
        self._own = {path: found for path, found in contents.items() if found is not None}

    def write(
        self,
        calibration: Calibration,
        summary: Mapping[str, Any],
        history: Sequence[Progress] = (),
        run: int = 1,
    ) -> tuple[Path, Path]:
        """Write the result in place of this session's last one. Each file is complete at every
        moment. Raises `StorageError` and leaves the old files.

        Args:
            run: the session's calibration (`Snapshot.run`); with another number than last time, the
                last result is kept as an earlier one.
        """
        if run != self._run:
            self._run, self._own = run, {}
        camera = camera_yaml(calibration).encode()
        result = result_json(summary, calibration, history).encode()
        kept: list[str] = []
        try:
            self.directory.mkdir(parents=True, exist_ok=True)
            with locked(self.directory):
                self._follow()
                contents = dict(zip(self.paths, (camera, result), strict=True))
                replace_files(contents, before=lambda: kept.extend(self._keep_others()))
                self._own = contents
                self._is_written = True
        except OSError as error:
            raise StorageError(
                _NOT_WRITTEN.format(folder=self.directory, reason=reason(error))
            ) from error
        finally:
            if kept:
                self._tell(
                    f"The earlier result in {self.directory} is kept as {' and '.join(kept)}."
                )
        return self.paths

    def withdraw(self) -> None:
        """Remove what this session has written: it was a mistake. An earlier result stays under
        the name that it was given. Raises `StorageError`."""
        try:
            with locked(self.directory):
                self._follow()
                for path, content in self._own.items():
                    if _content(path) == content:
                        path.unlink()
        except OSError as error:
            raise StorageError(
                f"{self.directory} holds a wrong result that cannot be removed ({reason(error)}); "
                "remove it."
            ) from error
        self._own, self._is_written = {}, False

    def _paths(self, tail: str) -> tuple[Path, Path]:
        return self.directory / f"camera{tail}.yaml", self.directory / f"result{tail}.json"

    def _follow(self) -> None:
        """Find out whether another session has renamed our files."""
        result = self.paths[1]
        if result not in self._own or _content(result) == self._own[result]:
            return
        for path in self.directory.glob("result-*.json"):
            if _content(path) == self._own[result]:
                self._tail = path.stem.removeprefix("result")
                self._own = dict(zip(self.paths, self._own.values(), strict=True))
                return

    def _keep_others(self) -> list[str]:
        """Rename files that are not ours, both alike; returns their new names."""
        others = [path for path in self.paths if os.path.lexists(path) and not self._is_known(path)]
        if not others:
            return []
        free = self._free(min(path.lstat().st_mtime for path in others))
        named = dict(zip(self.paths, free, strict=True))
        kept: list[str] = []
        for path in others:
            content = _content(path)
            _put_aside(path, named[path])
            if content is not None:
                self._kept[path] = content  # in case it cannot be replaced just now
            kept.append(named[path].name)
        # The old names must be on disk before the new content is.
        sync_folder(self.directory)
        return kept

    def _free(self, time_s: float) -> tuple[Path, Path]:
        """Two unused names with this time: files of different results must not look like a pair."""
        stamp = time.strftime("-%Y-%m-%dT%H-%M-%S", time.localtime(time_s))
        pairs = (self._paths(stamp if n == 1 else f"{stamp}-{n}") for n in count(1))
        return next(pair for pair in pairs if not any(map(os.path.lexists, pair)))

    def _is_known(self, path: Path) -> bool:
        content = _content(path)
        return content is not None and content in (self._own.get(path), self._kept.get(path))


def _content(path: Path) -> bytes | None:
    try:
        return path.read_bytes()
    except OSError:
        return None


def _put_aside(path: Path, name: Path) -> None:
    """Rename a file. If possible it keeps its old name as well until it is replaced, so that a file
    of that name always exists. Raises `OSError`."""
    try:
        os.link(path, name)
    except FileExistsError:
        raise  # renaming would replace it
    except OSError:
        os.rename(path, name)

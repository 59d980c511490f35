"""The folder of a guided calibration: new, named, or that of a session to go on with."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from importlib.metadata import version
from itertools import chain, count
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from venus3d.cli.given import given_over
from venus3d.cli.known_start import KnownStart, known_start
from venus3d.engine.errors import StorageError, VenusError
from venus3d.engine.guidance.known_camera import KnownCamera
from venus3d.engine.guidance.record import SessionState
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.sources.camera_settings import SETTING_NAMES, CameraSettings
from venus3d.storage.folder import prepare
from venus3d.storage.places import refuse_session
from venus3d.storage.result_folder import ResultFolder
from venus3d.storage.session_folder import SessionFolder
from venus3d.storage.session_reader import (
    camera_settings,
    missing_pictures,
    read_header,
    read_pictures,
    way_out,
)

SESSIONS = Path("venus3d-sessions")
"""Where sessions are kept for which no folder is named."""
_PACKAGES = ("venus3d", "numpy", "scipy", "opencv-contrib-python-headless", "viser")
# What belongs to one run, not to the session.
_OF_THE_RUN = ("resume", "output", "record", "headless", "json")


@dataclass(frozen=True, eq=False)
class KeptSession:
    """A session's options and folder."""

    options: GuideOptions
    folder: SessionFolder | None
    """None if it is not recorded."""
    files: ResultFolder | None
    """None if no result is to be written."""
    state: SessionState | None = None
    """Where a session is gone on with."""
    known: KnownCamera | None = None
    """The camera that it starts from."""
    where: str = ""
    """The sentence that says where it is kept; empty if it is not."""
    adopted: Mapping[int, Path] = field(default_factory=dict[int, Path])
    """Pictures of the views that it starts with, if it is not recorded."""

    def pictures(self) -> Iterable[tuple[int, NDArray[np.uint8]]]:
        """Numbers and pictures of the views that there are already."""
        if self.folder is None or self.state is None:
            return read_pictures(self.adopted)
        return self.folder.pictures(self.state)

    def camera_set(self, settings: CameraSettings) -> None:
        """Keep what is set on the camera now, for when the session is gone on with."""
        if self.folder is not None:
            self.folder.camera_set(msgspec.to_builtins(settings))

    def close(self) -> None:
        """Let others open the folder."""
        if self.folder is not None:
            self.folder.close()


def opened_session(options: GuideOptions, tell: Callable[[str], None]) -> KeptSession:
    """Open the folder that the options ask for. Raises `StorageError` if that cannot be."""
    if options.resume is not None:
        return _resumed(options, options.resume, tell)
    if not options.record and options.output is not None:
        refuse_session(options.output / "result.json")
    start = known_start(options, tell)
    if not options.record:
        output = options.output
        files = None if output is None else ResultFolder(prepare(output), tell)
        return KeptSession(options, None, files, start.state, start.camera, adopted=start.pictures)
    directory = options.output or _unused(SESSIONS / f"{datetime.now():%Y-%m-%d_%H-%M-%S}")
    folder = SessionFolder.create(directory, _header(options), tell)
    try:
        if start.state is not None:
            folder.adopt(start.state.views, start.pictures)
        files, options = ResultFolder(directory, tell), replace(options, output=directory)
        where = f"This session is kept in {directory}."
        return KeptSession(options, folder, files, start.state, start.camera, where)
    except BaseException:
        folder.close()
        raise


def _unused(directory: Path) -> Path:
    """This folder, or one with a number behind."""
    names = (directory.with_name(f"{directory.name}_{n}") for n in count(2))
    return next(path for path in chain([directory], names) if not path.exists())


def resumed_options(arguments: Sequence[str], directory: Path) -> GuideOptions:
    """The options of a session that is gone on with: its own, and those that are given again. The
    camera's settings are those set last, if the source is the same. Raises `StorageError`."""
    before = options_of(read_header(directory), directory)
    # A switch cannot be given to be off; older sessions hold these.
    before = replace(before, headless=False, json=False)
    last = camera_settings(directory)
    if last is not None:
        set_last = CameraSettings(**{name: last.get(name) for name in SETTING_NAMES})
        before = replace(before, camera=set_last)

    options = given_over(before, "guide", arguments)
    if options.source != before.source:
        # What was chosen for the source before says nothing of another one.
        usual = GuideOptions()
        elsewhere = replace(
            before,
            camera=usual.camera,
            sim=usual.sim,
            autopilot=usual.autopilot,
            speed=usual.speed,
        )
        options = given_over(elsewhere, "guide", arguments)
    if not options.record or (options.output or directory).resolve() != directory.resolve():
        raise VenusError(
            "--resume goes on in the session's own folder; leave out --output and --no-record."
        )
    return options


def _resumed(options: GuideOptions, directory: Path, tell: Callable[[str], None]) -> KeptSession:
    folder = SessionFolder.open(directory, tell)
    try:
        files = ResultFolder(directory, tell)
        files.adopt()
        state = folder.state()
        if state is not None:
            _check_board(options, options_of(folder.header, directory), directory)
        numbers = [] if state is None else [view.number for view in state.views]
        for number, name in missing_pictures(directory, numbers).items():
            tell(
                f"The picture of view {number} is missing ({directory / name}); its corners count "
                "all the same."
            )
        views = len(numbers)
        where = f"Going on with {views} view{'' if views == 1 else 's'} in {directory}."
        chosen = replace(options, output=directory)
        start = known_start(chosen, tell) if state is None else KnownStart()
        return KeptSession(chosen, folder, files, state or start.state, start.camera, where)
    except BaseException:
        folder.close()
        raise


def _check_board(options: GuideOptions, before: GuideOptions, directory: Path) -> None:
    if options.board.board() != before.board.board():
        raise StorageError(
            f"{directory} has views of the board that it was begun with; leave the board's options "
            f"out to go on. With another one, venus3d calibrate {directory} works on its pictures."
        )


def options_of(header: Mapping[str, Any], directory: Path) -> GuideOptions:
    """The options that a session was started with. Raises `StorageError`."""
    try:
        return msgspec.convert(header["options"], GuideOptions, dec_hook=_decoded)
    except (KeyError, msgspec.ValidationError) as error:
        raise StorageError(
            f"{directory}/session.json is not of this version of venus3d ({error}); "
            f"{way_out(directory)}"
        ) from error


def _header(options: GuideOptions) -> dict[str, Any]:
    kept = replace(options, **{name: getattr(GuideOptions(), name) for name in _OF_THE_RUN})
    return {
        "begun": datetime.now().isoformat(timespec="seconds"),
        "versions": {name: version(name) for name in _PACKAGES},
        "options": msgspec.to_builtins(kept, enc_hook=str),
    }


def _decoded(kind: type, value: Any) -> Any:
    return kind(value)

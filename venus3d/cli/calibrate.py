"""`venus3d calibrate`: calibration from existing images or a video, without guidance."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec

from venus3d.cli.given import given_over, gives_board
from venus3d.cli.options import CalibrateOptions
from venus3d.cli.progress import search_progress
from venus3d.cli.report import deliver, print_note, print_result, write_first
from venus3d.engine.calibration.refusals import FEWEST_VIEWS
from venus3d.engine.errors import StorageError, VenusError
from venus3d.options import BoardOptions
from venus3d.sources.images_calibration import calibrate_recording
from venus3d.sources.recording import Images
from venus3d.storage.folder import prepare
from venus3d.storage.places import is_session, refuse_session
from venus3d.storage.result import summary_of
from venus3d.storage.result_folder import ResultFolder
from venus3d.storage.session_reader import picture_files, read_header


def calibrate_command(options: CalibrateOptions) -> None:
    """Detect, calibrate, print, write. Raises `VenusError` for a user's mistake."""
    images, board = _images(options.source), options.board.board()
    if options.max_frames < FEWEST_VIEWS:
        raise VenusError(f"--max-frames must be at least {FEWEST_VIEWS}.")
    if options.every is not None and options.every < 1:
        raise VenusError("--every must be at least 1.")
    if options.output is not None:
        refuse_session(options.output / "result.json")
        prepare(options.output)
    with search_progress() as on_count:
        found = calibrate_recording(
            images,
            board,
            max_frames=options.max_frames,
            every=options.every,
            flip=options.flip,
            lens=options.lens,
            on_progress=print_note,
            on_count=on_count,
        )
    calibration, warnings, diagnoses = found.calibration, found.warnings, found.diagnoses
    summary = summary_of(calibration, warnings=warnings, diagnoses=diagnoses)
    files = None if options.output is None else ResultFolder(options.output, print_note)
    written = write_first(files, calibration, summary)
    print_result(calibration, warnings, diagnoses=diagnoses)
    deliver(summary, written, as_json=options.json)


def with_sessions_board(options: CalibrateOptions, arguments: Sequence[str]) -> CalibrateOptions:
    """Of a session that is calibrated its own board, but for the options that the command's
    arguments give. Raises `StorageError` where neither tells one."""
    directory = Path(options.source)
    if not is_session(directory):
        return options
    try:
        board = _board_of(directory)
    except StorageError:
        if gives_board(arguments):
            return options
        raise
    return given_over(CalibrateOptions(options.source, board), "calibrate", arguments)


def _board_of(session: Path) -> BoardOptions:
    try:
        return msgspec.convert(read_header(session)["options"]["board"], BoardOptions)
    except (KeyError, TypeError, msgspec.ValidationError) as error:
        raise StorageError(
            f"{session}/session.json does not tell the board ({error}); give --board.* too."
        ) from error


def _images(source: str) -> Images:
    """What to read: of a session its pictures."""
    directory = Path(source)
    if not is_session(directory):
        return source
    files = picture_files(directory, print_note)
    print_note(f"The pictures of the {len(files)} views of the session in {directory}.")
    return files

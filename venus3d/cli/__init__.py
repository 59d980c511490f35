"""The command line: options are parsed, mistakes become one sentence and exit code 2.
Each command's module is imported only when it is run, so that `--help` and mistakes answer at
once."""

from __future__ import annotations

import errno
import io
import os
import pkgutil
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout, suppress
from functools import reduce
from operator import or_
from pathlib import Path
from typing import Annotated, Any, TextIO, cast

import tyro
from tyro.conf import subcommand

from venus3d import __version__
from venus3d.cli.board_argument import with_board_file
from venus3d.cli.options import (
    BoardCommand,
    CalibrateOptions,
    CamerasOptions,
    DecomposeOptions,
    DoctorOptions,
    ExportOptions,
    ImportOptions,
    ReplayOptions,
    ReportOptions,
    UndistortOptions,
    VerifyOptions,
)
from venus3d.cli.printed import Printed
from venus3d.cli.study_options import StudyOptions
from venus3d.engine.errors import VenusError
from venus3d.engine.printable import printable
from venus3d.scene.pages.exercise.options import PracticeOptions, TrialOptions
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.pages.measure.options import MeasureOptions
from venus3d.scene.pages.teach.options import TeachOptions
from venus3d.storage.folder import reason
from venus3d.threads.signals import on_stop_signal

DESCRIPTION = """Camera calibration that a person can see.

Lengths and translations are in millimetres, angles in degrees. `venus3d COMMAND --help` explains a
command, `venus3d --version` names the version.
"""

_COMMANDS: dict[str, tuple[type, str]] = {
    "guide": (GuideOptions, "venus3d.cli.guide:guide"),
    "teach": (TeachOptions, "venus3d.cli.teach:teach"),
    "practice": (PracticeOptions, "venus3d.scene.pages.exercise.run:run_practice"),
    "trial": (TrialOptions, "venus3d.cli.trial:trial"),
    "replay": (ReplayOptions, "venus3d.cli.replay:replay"),
    "calibrate": (CalibrateOptions, "venus3d.cli.calibrate:calibrate_command"),
    "decompose": (DecomposeOptions, "venus3d.cli.decompose:decompose_command"),
    "board": (BoardCommand, "venus3d.cli.board:board_command"),
    "export": (ExportOptions, "venus3d.cli.export:export_command"),
    "import": (ImportOptions, "venus3d.cli.import_:import_command"),
    "verify": (VerifyOptions, "venus3d.cli.verify:verify_command"),
    "measure": (MeasureOptions, "venus3d.scene.pages.measure.run:run_measure"),
    "report": (ReportOptions, "venus3d.cli.make_report:report_command"),
    "undistort": (UndistortOptions, "venus3d.cli.undistort:undistort_command"),
    "cameras": (CamerasOptions, "venus3d.cli.cameras:cameras"),
    "doctor": (DoctorOptions, "venus3d.cli.doctor:doctor"),
    "study": (StudyOptions, "venus3d.cli.study:study"),
}
"""Each command's options, whose docstring is its description, and the function that takes them."""
_COMMAND: Any = reduce(
    or_, (Annotated[options, subcommand(name)] for name, (options, _) in _COMMANDS.items())
)
OK, MISTAKE, INTERRUPTED = 0, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit code. Reads `sys.argv` by default."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:  # closed by whoever called
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))
    for stream in (sys.stdout, sys.stderr):
        # A file's name may hold what the terminal cannot show: that ends no command.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    output = Printed(sys.stdout)
    try:
        try:
            code = _run(given, output)
            if code == INTERRUPTED and arguments is None:
                # Everything is saved. A second Ctrl-C while a thread still computes ends the
                # process without Python's traceback.
                signal.signal(signal.SIGINT, signal.SIG_DFL)
            return code
        finally:
            output.end()
    except OSError as error:
        unread = _silenced() or error is output.failure
        # The reader of our output (head, less) has closed it, or the terminal is gone. A failing
        # disk gives EIO as well.
        if error.errno == errno.EPIPE or (error.errno == errno.EIO and unread):
            return OK
        if not unread:
            raise
        reason = error.strerror or str(error)
        with suppress(OSError):  # stderr may be the same full disk
            print(
                f"venus3d: What the command prints could not be written: {reason}; make room "
                "there, or print to another place.",
                file=sys.stderr,
            )
        _silenced()
        return MISTAKE


def _run(given: list[str], output: Printed) -> int:
    if given == ["--version"]:
        print(f"venus3d {__version__}")
        return OK
    try:
        if given[:1] == ["guide"] and "--trial" in given:
            raise VenusError(
                "The trial is a command of its own: venus3d trial [SOURCE]; --trial-poses is its "
                "--poses."
            )
        arguments = with_board_file(given)
        options = tyro.cli(
            _COMMAND, prog="venus3d", description=DESCRIPTION, args=arguments or ["--help"]
        )
        _check_places(options)
        options = _on_what_was(options, arguments[1:])
        # On a kill or a closed terminal the captured views are kept, as with Ctrl-C.
        with on_stop_signal(_interrupt, ctrl_c=False), redirect_stdout(cast(TextIO, output)):
            code = _command_of(options)(options)
    except VenusError as error:
        print(printable(f"venus3d: {error}"), file=sys.stderr)
        return MISTAKE
    except OSError as error:
        # Whether a place is there is asked in many places; these two the system refuses to say.
        if error.errno not in (errno.ENAMETOOLONG, errno.EACCES) or error.filename is None:
            raise
        told = f"venus3d: {error.filename} cannot be used ({reason(error)}); give another place."
        print(printable(told), file=sys.stderr)
        return MISTAKE
    except KeyboardInterrupt as stop:
        # A study says where it stopped; Ctrl-C itself has no message.
        stopped = ": ".join(["stopped", *map(str, stop.args)])
        print(printable(f"venus3d: {stopped}."), file=sys.stderr)
        return INTERRUPTED
    return code if isinstance(code, int) else OK


def _check_places(options: object) -> None:
    """Refuse the name by which other programs write to stdout: a folder would be made of it."""
    for part in (options, getattr(options, "what", None)):
        for name in ("output", "save", "export"):
            if getattr(part, name, None) == Path("-"):
                raise VenusError(
                    f"--{name} - would write to stdout, which holds what is printed; name a file "
                    "or a folder."
                )


def _on_what_was(options: object, arguments: Sequence[str]) -> object:
    """The options over those of the session or the result that the command goes on from."""
    # Imported only now: what these read no other command waits for.
    if isinstance(options, GuideOptions) and options.resume is not None:
        if options.known_camera is not None:
            raise VenusError(
                "--resume goes on with a session, and --from begins one; give one of them."
            )
        from venus3d.cli.kept_session import resumed_options

        return resumed_options(arguments, options.resume)
    if isinstance(options, GuideOptions) and options.known_camera is not None:
        from venus3d.cli.known_start import with_known_board

        return with_known_board(options, arguments)
    if isinstance(options, CalibrateOptions):
        from venus3d.cli.calibrate import with_sessions_board

        return with_sessions_board(options, arguments)
    return options


def _interrupt() -> None:
    raise KeyboardInterrupt


def _silenced() -> bool:
    """Redirect closed streams to nowhere, as Python complains at exit. True if there was one."""
    found = False
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
            os.write(stream.fileno(), b"")
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
            found = True
    return found


def _command_of(options: object) -> Callable[[Any], object]:
    # Imported only now: no command waits for another one's libraries.
    place = next(function for kind, function in _COMMANDS.values() if kind is type(options))
    return pkgutil.resolve_name(place)

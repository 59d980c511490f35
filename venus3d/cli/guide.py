"""`venus3d guide`: run the guidance loop, then print and write what came of it."""

from __future__ import annotations

import traceback
from contextlib import ExitStack, closing, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from venus3d.cli.report import deliver, print_note, print_result, write_first
from venus3d.engine.errors import CalibrationError, StorageError, VenusError
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.audience.run import announcement
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.pages.guide.result_saver import is_over
from venus3d.scene.pages.guide.run import GuideResult, run_guide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.web.address import audience_address
from venus3d.scene.web.page import announce
from venus3d.storage.folder import prepare
from venus3d.storage.result import summary_of
from venus3d.storage.result_folder import ResultFolder

RESULT_FOLDER = Path("venus3d-result")
"""Where a guided calibration with the viewer is written if no folder is named."""


def guide(options: GuideOptions) -> None:
    """Guide, print, write.

    Raises `VenusError` for a user's mistake, `KeyboardInterrupt` if Ctrl-C left no result.
    """
    options.check()  # a mistake here is told before anything starts
    if options.output is None and not options.headless:
        # Ten minutes of holding a board must not be lost for want of an option.
        options = replace(options, output=RESULT_FOLDER)
    if options.output is not None:
        prepare(options.output)
    files = None if options.output is None else ResultFolder(options.output, print_note)
    result = _guided(options, files)
    snapshot = result.snapshot
    if snapshot.calibration is None:
        _tell_of_nothing(result, options, files)
        return
    summary = _summary(result)
    written = write_first(files, snapshot.calibration, summary, snapshot.history)
    print_result(snapshot.calibration, result.warnings, result.truth, snapshot.diagnoses)
    deliver(summary, written, as_json=options.json)


def _guided(options: GuideOptions, files: ResultFolder | None) -> GuideResult:
    """Guide; however that ends, the files hold what was captured, and it is told where they are.

    Raises `VenusError`, also for a mistake of ours, whose traceback is printed.
    """

    def keep(result: GuideResult) -> str:
        return _keep(result, options, files)

    try:
        with ExitStack() as stack:
            # First of all: its port was promised to somebody, while the viewer may take another.
            audience = open_audience(options)
            if audience is None:
                return run_guide(options, keep)
            stack.enter_context(closing(audience))
            return run_guide(
                options, keep, monitors=(audience,), on_viewer=partial(_attach, audience)
            )
    except BaseException as error:
        if files is not None and files.is_written:
            _tell_written(files)
        if isinstance(error, VenusError) or not isinstance(error, Exception):
            raise
        with suppress(OSError):  # a terminal that is gone
            traceback.print_exception(error)
        raise VenusError(
            "The guidance broke off by a mistake of ours; begin again, and please report the lines "
            "above."
        ) from error


def open_audience(options: GuideOptions) -> Audience | None:
    """The second monitor that the options ask for, if any; the caller closes it.

    Raises `VenusError` for an address that cannot be had.
    """
    if options.audience is None:
        return None
    state = AudienceState(
        mirror=options.audience_mirror,
        lens=options.audience_view == "lens",
        light=options.audience_light,
        sound=options.audience_sound,
    )
    return Audience(*audience_address(options.audience, options.port), state)


def _attach(audience: Audience, viewer: Viewer) -> None:
    """Let the operator choose what the second monitor shows, and hear of its failures."""
    audience.on_failure = viewer.say
    viewer.extend(lambda server: AudienceControls(server, audience).commands)
    announce(announcement(audience))


def _keep(result: GuideResult, options: GuideOptions, files: ResultFolder | None) -> str:
    """Write a result while the guidance goes on, so that nothing is lost if it is just killed.

    Returns the sentence for the screen. Raises `StorageError`, which the terminal is told as well.
    """
    snapshot = result.snapshot
    if files is None or snapshot.calibration is None:
        return ""
    try:
        camera, complete = files.write(snapshot.calibration, _summary(result), snapshot.history)
    except StorageError as error:
        print_note(f"Not saved: {error}")
        raise
    if is_over(snapshot) and not options.headless:
        _tell_written(files)
    return f"Saved: {camera.name} and {complete.name} in {files.directory}."


def _tell_written(files: ResultFolder) -> None:
    for path in files.paths:
        print_note(f"Written: {path}")


def _tell_of_nothing(
    result: GuideResult, options: GuideOptions, files: ResultFolder | None
) -> None:
    """Print that there is no result, or raise it where it is a mistake."""
    if files is not None and files.is_written:
        print(f"No view is left; {files.directory} holds the last calibration that there was.")
        return
    if result.snapshot.diagnoses:
        raise CalibrationError(str(result.snapshot.diagnoses[0]))
    if options.headless:
        raise CalibrationError(
            "No view was captured, so there is no result; check the board's options, or use "
            "venus3d calibrate for pictures taken without guidance."
        )
    print("No view was captured, so there is no result.")
    raise KeyboardInterrupt  # which has ended it, and nothing was saved


def _summary(result: GuideResult) -> dict[str, Any]:
    snapshot = result.snapshot
    assert snapshot.calibration is not None
    return summary_of(
        snapshot.calibration,
        warnings=result.warnings,
        diagnoses=snapshot.diagnoses,
        converged=snapshot.convergence is not None and snapshot.convergence.converged,
        truth=result.truth,
        forecast=snapshot.forecast,
    )

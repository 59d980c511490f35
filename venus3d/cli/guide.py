"""`venus3d guide`: run the guidance loop, then print and write the result."""

from __future__ import annotations

import traceback
from contextlib import ExitStack, closing, suppress
from functools import partial
from typing import Any

from venus3d.cli.kept_session import KeptSession, opened_session
from venus3d.cli.report import deliver, print_note, print_result, write_first
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.diagnosis import DiagnosisKind
from venus3d.engine.calibration.other_cameras import OTHER_CAMERAS
from venus3d.engine.calibration.refusals import FEWEST_VIEWS, OtherCameraError, calibrate_or_refuse
from venus3d.engine.errors import CalibrationError, StorageError, VenusError
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.sentences import Sentence
from venus3d.scene.pages.audience.audience import Audience
from venus3d.scene.pages.audience.controls import AudienceControls
from venus3d.scene.pages.audience.run import announcement
from venus3d.scene.pages.audience.state import AudienceState
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.pages.guide.result_saver import is_over
from venus3d.scene.pages.guide.run import GuideResult, run_guide
from venus3d.scene.pages.guide.viewer import Viewer
from venus3d.scene.pages.measure.monitor import MeasureMonitor
from venus3d.scene.web.addresses import check_port, is_free
from venus3d.scene.web.monitor import audience_address
from venus3d.scene.web.page import announce
from venus3d.storage.result import summary_of
from venus3d.storage.result_folder import ResultFolder

_SAVED = Sentence("Saved: {camera} and {result} in {folder}.")
_NO_VIEW = "No view was captured, so there is no result."
_CAPTURED = (
    "{shown} of {looked} pictures show the board; guidance captured {captured} of them, as it "
    "takes only what is still and shows something new. {cause}"
)
_READ_ALL_THE_SAME: frozenset[DiagnosisKind] = frozenset(
    ("second-board", "wrong-layout", "other-first-id", "wrong-marker-size", "thin-border")
)
"""Of the diagnoses: those of a board that is read, which is no reason for having no view."""


BROKE_OFF = 3
"""Exit code: there is a result, of fewer views than were wanted."""


def guide(options: GuideOptions) -> int:
    """Guide, print, write; the exit code is 3 where it broke off before it had converged.
    Raises `VenusError` for a user's mistake, `KeyboardInterrupt` if Ctrl-C left no result."""
    options.check()  # report mistakes before anything starts
    if not options.headless:
        check_port(options.port)
        is_free(options.host, options.port)  # the viewer may take another port, not address
    with ExitStack() as stack:
        kept = opened_session(options, print_note)
        stack.callback(kept.close)
        return _guide(kept.options, kept)


def _guide(options: GuideOptions, kept: KeptSession) -> int:
    files = kept.files
    result = _guided(options, kept)
    snapshot = result.snapshot
    if snapshot.calibration is None or not _is_result(snapshot):
        _tell_of_nothing(result, options, files)
        return BROKE_OFF if result.broke_off else 0
    summary = _summary(result)
    written = write_first(files, snapshot.calibration, summary, snapshot.history, snapshot.run)
    print_result(snapshot.calibration, result.warnings, result.truth, snapshot.diagnoses)
    deliver(summary, written, as_json=options.json)
    return BROKE_OFF if result.broke_off else 0


def _guided(options: GuideOptions, kept: KeptSession) -> GuideResult:
    """Guide; however that ends, save what was captured and print where.
    Raises `VenusError`, also for an internal error, whose traceback is printed."""
    files = kept.files

    def keep(result: GuideResult) -> str:
        return _keep(result, options, files)

    run = partial(
        run_guide,
        options,
        keep,
        recorder=kept.folder,
        state=kept.state,
        known=kept.known,
        pictures=kept.pictures(),
        on_camera=kept.camera_set,
        on_open=lambda: print_note(kept.where) if kept.where else None,
    )
    try:
        with ExitStack() as stack:
            measuring = MeasureMonitor(options.host, options.port + 1, options.language)
            stack.enter_context(closing(measuring))
            # Open this first: its port was promised to somebody, while the viewer may take another.
            audience = open_audience(options)
            monitors = (measuring,) if audience is None else (measuring, audience)
            if audience is not None:
                stack.enter_context(closing(audience))
            return run(monitors=monitors, on_viewer=partial(_attach, audience, measuring))
    except BaseException as error:
        if files is not None and files.is_written:
            _tell_written(files)
        if isinstance(error, VenusError) or not isinstance(error, Exception):
            raise
        with suppress(OSError):  # the terminal is gone
            traceback.print_exception(error)
        raise VenusError(
            "The guidance broke off by a mistake of ours; begin again, and please report the lines "
            "above."
        ) from error


def open_audience(options: GuideOptions) -> Audience | None:
    """The second monitor, if the options ask for one; the caller closes it.
    Raises `VenusError` for an unavailable address."""
    if options.audience is None:
        return None
    state = AudienceState(
        mirror=options.audience_mirror,
        lens=options.audience_view == "lens",
        light=options.audience_light,
        sound=options.audience_sound,
    )
    host, port = audience_address(options.audience, options.port)
    return Audience(host, port, state, options.language, options.audience_token)


def _attach(audience: Audience | None, measuring: MeasureMonitor, viewer: Viewer) -> None:
    """Connect the operator's choice for the second monitor, and its failures; the link to
    measuring."""
    measuring.on_open = viewer.measure_at
    if audience is None:
        return
    audience.on_failure = viewer.warn
    viewer.extend(lambda server: AudienceControls(server, audience).commands)
    announce(announcement(audience))


def _is_other_camera(snapshot: Snapshot) -> bool:
    return any(diagnosis.kind in OTHER_CAMERAS for diagnosis in snapshot.diagnoses)


def _is_result(snapshot: Snapshot) -> bool:
    """Whether there is a calibration, and not only a start to guide with or another camera's."""
    known = snapshot.calibration
    return known is not None and all(known.free) and not _is_other_camera(snapshot)


def _keep(result: GuideResult, options: GuideOptions, files: ResultFolder | None) -> str:
    """Write a result during guidance, so that nothing is lost if the program is killed.
    Returns the sentence for the page. Raises `StorageError`, which is printed as well."""
    snapshot = result.snapshot
    known = snapshot.calibration
    if files is None or known is None or not _is_result(snapshot):
        if files is not None and files.is_written and _is_other_camera(snapshot):
            files.withdraw()
        return ""
    try:
        camera, complete = files.write(known, _summary(result), snapshot.history, snapshot.run)
    except StorageError as error:
        print_note(f"Not saved: {error}")
        raise
    if is_over(snapshot) and not options.headless:
        _tell_written(files)
    return _SAVED.format(camera=camera.name, result=complete.name, folder=files.directory)


def _tell_written(files: ResultFolder) -> None:
    for path in files.paths:
        print_note(f"Written: {path}")


def _tell_of_nothing(
    result: GuideResult, options: GuideOptions, files: ResultFolder | None
) -> None:
    """Print that there is no result, or raise it where it is a mistake."""
    known = result.snapshot.calibration
    if known is not None:
        refused = _refusal(result, known, files)
        if result.broke_off:  # why there are no more views comes first
            raise CalibrationError(" ".join([*result.warnings, str(refused)]))
        raise refused
    if files is not None and files.is_written:
        print(f"No view is left; {files.directory} holds the last calibration that there was.")
        return
    if result.snapshot.diagnoses:
        worst = result.snapshot.diagnoses[0]
        nothing = f"{_NO_VIEW} " if worst.kind in _READ_ALL_THE_SAME else ""
        raise CalibrationError(f"{nothing}{worst}")
    if options.headless and result.broke_off:
        raise CalibrationError(" ".join([_NO_VIEW, *result.warnings]))
    if options.headless:
        raise CalibrationError(
            "No view was captured, so there is no result; check the board's options, or use "
            "venus3d calibrate for pictures taken without guidance."
        )
    print(_NO_VIEW)
    raise KeyboardInterrupt  # ended by Ctrl-C, nothing was saved


def _refusal(
    result: GuideResult, known: Calibration, files: ResultFolder | None
) -> CalibrationError:
    """Why the captured views give no calibration."""
    board = result.snapshot.board
    left_out = [one.observation for one in known.left_out]
    cause = "The views determine no camera; add views tilted by 20-45° in different directions."
    try:
        calibrate_or_refuse(board, [*(view.observation for view in known.views), *left_out])
    except OtherCameraError as error:
        if files is not None and files.is_written:
            files.withdraw()
        return error
    except CalibrationError as error:
        cause = str(error)
    captured = len(known.views) + len(left_out)
    if result.shown is not None and captured < FEWEST_VIEWS:
        shown, looked = result.shown
        cause = _CAPTURED.format(shown=shown, looked=looked, captured=captured, cause=cause)
    if files is not None and files.is_written:
        cause += f" {files.directory} holds the calibration of fewer views."
    return CalibrationError(cause)


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

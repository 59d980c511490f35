"""`venus3d guide`: run the guidance loop, then print and write what came of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from venus3d.app import GuideResult, run_guide
from venus3d.cli.report import deliver, print_result, tell
from venus3d.cli.trial import trial
from venus3d.engine.errors import CalibrationError
from venus3d.options import GuideOptions
from venus3d.storage.folder import prepare
from venus3d.storage.result import summary_of, write_result

RESULT_FOLDER = Path("venus3d-result")
"""Where a guided calibration with the viewer is written if no folder is named."""


def guide(options: GuideOptions) -> None:
    """Guide, print, write. Raises `VenusError` for a user's mistake."""
    options.check()  # a mistake here is told before anything starts
    if options.trial:
        trial(options)
        return
    if options.output is None and not options.headless:
        # Ten minutes of holding a board must not be lost for want of an option.
        options = replace(options, output=RESULT_FOLDER)
    if options.output is not None:
        prepare(options.output)
    result = run_guide(options, on_result=lambda complete: _keep(complete, options))
    snapshot = result.snapshot
    if snapshot.calibration is None:
        if snapshot.diagnoses:
            raise CalibrationError(str(snapshot.diagnoses[0]))
        if options.headless:
            raise CalibrationError(
                "No view was captured, so there is no result; check the board's options, or use "
                "venus3d calibrate for pictures taken without guidance."
            )
        print("No view was captured, so there is no result.")
        return
    print_result(snapshot.calibration, result.warnings, result.truth, snapshot.diagnoses)
    deliver(
        _summary(result),
        snapshot.calibration,
        snapshot.board,
        output=options.output,
        as_json=options.json,
        history=snapshot.history,
    )


def _keep(result: GuideResult, options: GuideOptions) -> str:
    """Write a result while the viewer stays open, so that nothing is lost if it is just killed.

    Returns the sentence for the screen.
    """
    snapshot = result.snapshot
    if options.output is None or snapshot.calibration is None:
        return ""
    for path in write_result(
        options.output, snapshot.calibration, snapshot.board, _summary(result), snapshot.history
    ):
        tell(f"Written: {path}")
    return f"Saved: camera.yaml and result.json in {options.output}."


def _summary(result: GuideResult) -> dict[str, Any]:
    snapshot = result.snapshot
    assert snapshot.calibration is not None
    return summary_of(
        snapshot.calibration,
        snapshot.board,
        warnings=result.warnings,
        diagnoses=snapshot.diagnoses,
        converged=snapshot.convergence is not None and snapshot.convergence.converged,
        truth=result.truth,
        forecast=snapshot.forecast,
    )

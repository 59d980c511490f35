"""`venus3d guide`: run the guidance loop, then print and write what came of it."""

from __future__ import annotations

from venus3d.app import run_guide
from venus3d.cli.report import deliver, print_result
from venus3d.engine.errors import CalibrationError
from venus3d.options import GuideOptions
from venus3d.storage.folder import prepare
from venus3d.storage.result import summary_of


def guide(options: GuideOptions) -> None:
    """Guide, print, write. Raises `VenusError` for a user's mistake."""
    options.board.board()  # a mistake here is told before anything starts
    if options.output is not None:
        prepare(options.output)
    result = run_guide(options)
    snapshot = result.snapshot
    if snapshot.calibration is None:
        if options.headless:
            raise CalibrationError(
                "No view was captured, so there is no result: the board was never seen whole and "
                "tilted; check --board, or use venus3d calibrate for pictures taken without "
                "guidance."
            )
        print("No view was captured, so there is no result.")
        return
    converged = snapshot.phase == "converged" or (
        snapshot.convergence is not None and snapshot.convergence.converged
    )
    print_result(snapshot.calibration, result.warnings, result.truth)
    summary = summary_of(
        snapshot.calibration,
        snapshot.board,
        warnings=result.warnings,
        converged=converged,
        truth=result.truth,
    )
    deliver(
        summary,
        snapshot.calibration,
        snapshot.board,
        output=options.output,
        as_json=options.json,
        history=snapshot.history,
    )

"""A calibration as text in aligned columns, with its files and the JSON line."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.diagnosis import Diagnosis
from venus3d.engine.errors import StorageError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.guidance.convergence import Progress
from venus3d.engine.guidance.prompts import PARAMETER_DESCRIPTIONS
from venus3d.engine.printable import printable
from venus3d.storage.result import to_json
from venus3d.storage.result_folder import ResultFolder


def parameter_table(calibration: Calibration, truth: Camera | None = None) -> str:
    """The parameters with their standard deviations, and the truth if known."""
    head = f"{'':4}{'value':>12}   {'± σ':>10}" + ("" if truth is None else f"{'truth':>12}")
    rows = [head]
    for index, name in enumerate(calibration.camera.parameter_names):
        value, sigma = calibration.camera.parameters[index], calibration.sigma[index]
        unit, digits = ("px", 2) if index < 4 else ("", 5)
        known = f"± {sigma:.{digits}f}" if calibration.free[index] else "held"
        row = f"{name:4}{value:12.{digits}f}   {known:>10}"
        if truth is not None:
            # The coefficients of two lens models cannot be compared.
            same = index < 4 or truth.lens == calibration.camera.lens
            row += f"{truth.named[name]:12.{digits}f}" if same else f"{'–':>12}"
        rows.append(f"{row}  {unit:2}  {PARAMETER_DESCRIPTIONS[name]}")
    return "\n".join(rows)


def view_table(calibration: Calibration) -> str:
    names = [printable(view.observation.name) or str(view.number) for view in calibration.views]
    width = max(len("view"), *(len(name) for name in names))
    rows = [f"{'view':{width}}  corners   rms"]
    for name, view in zip(names, calibration.views, strict=True):
        rows.append(f"{name:{width}}  {view.observation.count:7d}   {view.rms_px:.3f} px")
    return "\n".join(rows)


def _views(calibration: Calibration) -> str:
    count = len(calibration.views)
    return f"{count} view{'' if count == 1 else 's'}"


def _left_out(calibration: Calibration) -> str:
    gone = sum(view.left_out.count for view in calibration.views if view.left_out is not None)
    if gone == 0:
        return ""
    return (
        f"; {gone} corner{'s' if gone > 1 else ''} that fit{'' if gone > 1 else 's'} no view "
        f"{'are' if gone > 1 else 'is'} left out"
    )


def print_result(
    calibration: Calibration,
    warnings: Sequence[str],
    truth: Camera | None = None,
    diagnoses: Sequence[Diagnosis] = (),
) -> None:
    """Print the result for a person."""
    corners = sum(view.observation.count for view in calibration.views)
    width, height = calibration.camera.image_size
    print(view_table(calibration), end="\n\n")
    print(parameter_table(calibration, truth), end="\n\n")
    print(
        f"rms {calibration.rms_px:.3f} px over {corners} corners in {_views(calibration)} "
        f"of {width} x {height} px{_left_out(calibration)}"
    )
    if calibration.lens_reason:
        print(calibration.lens_reason)
    for warning in warnings:
        print(f"Mind: {warning}")
    for diagnosis in diagnoses:
        print(f"Diagnosis: {diagnosis.cause}\n     Cure: {diagnosis.cure}")


Written = tuple[Path, ...] | StorageError
"""The files written, or why they could not be."""


def write_first(
    files: ResultFolder | None,
    calibration: Calibration,
    summary: Mapping[str, Any],
    history: Sequence[Progress] = (),
    run: int = 1,
) -> Written:
    """Write the files, if requested, before printing: the terminal may be gone.
    An error is returned for `deliver` to raise, so that the numbers are still printed."""
    if files is None:
        return ()
    try:
        return files.write(calibration, summary, history, run)
    except StorageError as error:
        return error


def deliver(summary: Mapping[str, Any], written: Written, *, as_json: bool) -> None:
    """Print where the files are, and the JSON line if requested.
    Raises the `StorageError` of unwritten files after printing."""
    for path in () if isinstance(written, StorageError) else written:
        print(f"Written: {path}")
    if as_json:
        print(to_json(summary))
    if isinstance(written, StorageError):
        raise written


def print_note(text: str) -> None:
    """Print a progress remark to stderr, as stdout holds results only."""
    with suppress(OSError):  # a closed terminal stops no work
        print(printable(text), file=sys.stderr, flush=True)

"""`venus3d report`: a calibration's report as one HTML file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from venus3d.cli.options import ReportOptions
from venus3d.engine.errors import StorageError
from venus3d.report.calibration_report import ReportInput, calibration_report
from venus3d.storage.places import is_session
from venus3d.storage.products import product_place, write_product
from venus3d.storage.result_reader import read_result
from venus3d.storage.session_reader import kept_pictures, read_header

_RESULT = "result.json"
_MADE = "a calibration's report"
# Of a session's options: what says how it was made, by its name on the command line.
_SAID = ("source", "method", "cost", "search", "seed", "max_views", "wanted_error", "convergence")


def report_command(options: ReportOptions) -> None:
    """Read, write, print where. Raises `VenusError` for a user's mistake."""
    file = options.source / _RESULT if options.source.is_dir() else options.source
    if options.source.is_dir() and not file.exists():
        raise StorageError(
            f"{options.source} holds no {_RESULT}; give the folder of a calibration that is done, "
            "or the file itself."
        )
    result = read_result(file)
    folder = file.parent
    place = folder if options.output is None else options.output
    place = place / "report.html" if place.is_dir() or not place.suffix else place
    product_place(place, _MADE, file)
    if place.suffix.lower() != ".html":
        raise StorageError(
            f"The report is one HTML file, not a {place.suffix}; name it .html. The browser prints "
            "it, also into a PDF."
        )
    numbers = [view.number for view in result.calibration.views]
    told = ReportInput(
        result.calibration,
        [*result.warnings, *map(str, result.diagnoses)],
        dict(kept_pictures(folder, numbers)) if is_session(folder) else {},
        _made_with(folder),
    )
    print(f"Written: {write_product(place, calibration_report(told).encode(), _MADE)}")


def _made_with(folder: Path) -> Mapping[str, Any]:
    if not is_session(folder):
        return {}
    header = read_header(folder)
    chosen = header.get("options", {})
    # What was left to the method is None.
    given = {name: chosen[name] for name in _SAID if chosen.get(name) is not None}
    options = {name.replace("_", " "): value for name, value in given.items()}
    return {"begun": header.get("begun", ""), **options, **header.get("versions", {})}

"""`venus3d verify`: whether an existing calibration still holds, by fresh views."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import numpy as np

from venus3d.cli.options import VerifyOptions
from venus3d.cli.progress import search_progress
from venus3d.cli.report import print_note
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.verification import CHANCE, Verdict, Verification, verify
from venus3d.engine.errors import CalibrationError, StorageError, VenusError
from venus3d.options import LensName
from venus3d.report.verification_report import (
    CHANGES_HEAD,
    changes_of,
    cure,
    figures_of,
    method_sentence,
    verdict_sentence,
    verification_report,
)
from venus3d.scene.pages.guide.options import GuideOptions
from venus3d.scene.pages.guide.run import run_guide
from venus3d.sources.images_calibration import calibrate_recording
from venus3d.sources.open_frame_source import is_live
from venus3d.storage.folder import prepare, write_bytes
from venus3d.storage.formats import record_in
from venus3d.storage.products import mark_of, product_place, write_product
from venus3d.storage.result import SCHEMA, to_json
from venus3d.storage.result_reader import read_result

_CODES: dict[Verdict, int] = {
    "good": 0,
    "degraded": 1,
    "turned": 1,
    "other-camera": 1,
    "unclear": 3,
}


def verify_command(options: VerifyOptions) -> int:
    """Compare, print, write; the exit code is 0 for good, 1 for changed, 3 for unclear.
    Raises `VenusError` for a user's mistake."""
    if not 0 < options.limit < float("inf"):
        raise VenusError("--limit must be a number of pixels, more than 0.")
    record = record_in(options.file, options.format, options.name)
    page, numbers = (Path(), Path()) if options.output is None else _places(options.output)
    live = options.source == "sim" or is_live(options.source)
    lens = record.camera.lens.name
    fresh, said = (_guided(options, lens), []) if live else _found(options, lens)
    found = verify(record.camera, record.covariance, fresh, options.limit)
    notes = [] if record.covariance is not None else [_UNCERTAIN.format(name=options.file.name)]
    own = _own_views(options.file, fresh)
    if own:
        notes.append(_OWN.format(count=own, every=len(fresh.views)))
    told = {**_json(found), "warnings": [*said, *notes], "made_by": mark_of(_MADE)}
    # Written before it is printed: whoever reads the output may be gone.
    written: list[Path] = []
    if options.output is not None:
        report = verification_report(found, options.file.name, [*said, *notes]).encode()
        content = (to_json(told, indent=2) + "\n").encode()
        written = [write_product(page, report, _MADE), write_bytes(numbers, content)]
    _print(found, notes)
    for path in written:
        print(f"Written: {path}")
    if options.json:
        print(to_json(told))
    return _CODES[found.verdict]


def _places(folder: Path) -> tuple[Path, Path]:
    prepare(folder)
    page, numbers = (folder / f"verification{suffix}" for suffix in (".html", ".json"))
    return product_place(page, _MADE), product_place(numbers, _MADE)


_MADE = "a verification"
_UNCERTAIN = (
    "{name} does not hold the covariance of its camera, so the test takes the camera as exactly "
    "known; a result.json holds it."
)


_OWN = (
    "{count} of the {every} views are of the calibration itself, which fits them whatever has "
    "changed since; take fresh ones."
)
_SAME_PX = 0.005


def _own_views(file: Path, fresh: Calibration) -> int:
    """How many of the fresh views the calibration was made from, as far as its result tells."""
    result = file / "result.json" if file.is_dir() else file
    try:
        views = read_result(result).calibration.views
    except StorageError:
        return 0
    known = [view.observation for view in views]
    return sum(any(_is_same(view.observation, one) for one in known) for view in fresh.views)


def _is_same(one: Observation, other: Observation) -> bool:
    """Whether two observations are of one picture: a few corners may differ, as those of a session
    were followed from picture to picture, but in another picture noise moves every one."""
    _, mine, theirs = np.intersect1d(one.ids, other.ids, return_indices=True)
    if 2 * len(mine) < max(one.count, other.count):
        return False
    away = np.linalg.norm(one.corners[mine] - other.corners[theirs], axis=1)
    return float(np.median(away)) < _SAME_PX


def _found(options: VerifyOptions, lens: str) -> tuple[Calibration, list[str]]:
    """Fresh views of a recording, and what is wrong with them, which is printed."""
    with search_progress() as on_count:
        found = calibrate_recording(
            options.source,
            options.board.board(),
            max_frames=options.max_frames,
            flip=options.flip,
            lens=lens,
            on_progress=print_note,
            on_count=on_count,
        )
    said = [*found.warnings, *map(str, found.diagnoses)]
    for warning in said:
        print_note(f"Mind: {warning}")
    return found.calibration, said


def _guided(options: VerifyOptions, lens: str) -> Calibration:
    """Fresh views from a live camera, guided on the page until Ctrl-C."""
    print_note("Take fresh views as the page asks; Ctrl-C when it says that the camera is known.")
    chosen = GuideOptions(
        source=options.source,
        board=options.board,
        flip=options.flip,
        lens=cast(LensName, lens),
    )
    known = run_guide(chosen, verifies=True).snapshot.calibration
    if known is None:
        raise CalibrationError("No view was captured, so nothing is verified.")
    return known


def _print(found: Verification, notes: list[str]) -> None:
    print(verdict_sentence(found))
    if cure(found):
        print(cure(found))
    print()
    rows = figures_of(found)
    width = max(len(name) for name, _ in rows)
    for name, value in rows:
        print(f"{name:{width}}  {value}")
    print()
    for cells in [CHANGES_HEAD, *changes_of(found)]:
        name, before, now, change, mark = cells
        print(f"{name:4}{before:>14}{now:>14}{change:>12}  {mark}".rstrip())
    print(f"\n{method_sentence(found)}")
    for note in notes:
        print(f"Mind: {note}")


def _json(found: Verification) -> dict[str, Any]:
    fresh = found.fresh
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "limit_px": found.limit_px,
        "projection_diff_px": found.diff_px,
        "projection_diff_mm": found.diff_mm,
        "distance_mm": 1000 * found.distance_m,
        "chance_px": found.chance_px,
        "chance": CHANCE,
        "changed_px": found.changed_px,
        "turned_back_px": found.turned_back_px,
        "projection_diff_map_px": found.diff_map.tolist(),
        "rms_px": found.rms_px,
        "fresh_rms_px": fresh.rms_px,
        "views": len(fresh.views),
        "image_size": list(found.camera.image_size),
        "intrinsics": found.camera.named,
        "fresh_intrinsics": fresh.camera.named,
        "changes_sigma": dict(
            zip(fresh.camera.parameter_names, found.changes.tolist(), strict=True)
        ),
    }

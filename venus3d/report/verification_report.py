"""A verification in words: whether an existing calibration still holds, and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.verification import CHANCE, Verdict, Verification
from venus3d.render.colour_scale import round_up
from venus3d.render.map_pictures import coverage_picture, difference_picture
from venus3d.report.document import (
    PICTURE_WIDTH,
    document,
    paragraph,
    picture,
    section,
    side_by_side,
    table,
)
from venus3d.scene.web.legend import scale_html

_LOOK: dict[Verdict, str] = {
    "good": "v-report-good",
    "degraded": "v-report-bad",
    "turned": "v-report-bad",
    "other-camera": "v-report-bad",
    "unclear": "v-report-doubtful",
}
_PLACES = (
    ("upper left", "upper", "upper right"),
    ("left", "middle", "right"),
    ("lower left", "lower", "lower right"),
)
_MANY_SIGMA = 1000.0
TOLD_SIGMA = 3.0
"""A parameter is said to have changed by more than this many standard deviations."""


def verdict_sentence(found: Verification) -> str:
    """What was found, in one or two sentences."""
    diff, chance, limit = (figure(px) for px in (found.diff_px, found.chance_px, found.limit_px))
    changed = figure(found.changed_px)
    if found.verdict == "unclear":
        return (
            f"These views cannot tell: they would show only a change of more than {chance} px, "
            f"and {limit} px is the limit."
        )
    if found.turned_back_px is not None:
        return (
            "These pictures are turned by 180° against those of the calibration: turned back, they "
            f"agree with it to {figure(found.turned_back_px)} px, as they are to {diff} px."
        )
    if found.verdict == "other-camera":
        return (
            "Not this camera as it was calibrated: another camera, lens, zoom, focus or "
            f"resolution, or a wrong file. The two differ by {diff} px over the picture."
        )
    if found.verdict == "degraded":
        return (
            f"It no longer holds: the camera has changed by {changed} px over the picture, and "
            f"{limit} px is the limit. The change is largest at the {worst_place(found)}."
        )
    if found.changed_px > 0:
        return f"It still holds: a change of {changed} px is seen, within the limit of {limit} px."
    return f"It still holds: no change is seen, and one of {chance} px would have been."


def cure(found: Verification) -> str:
    """What to do now; empty where there is nothing to do."""
    if found.verdict == "unclear":
        more = int(np.ceil(len(found.fresh.views) * (found.chance_px / found.limit_px) ** 2))
        return (
            "Take more views, tilted in different directions and in every part of the picture; by "
            f"the number alone, {min(more, 200)}{' or more' if more > 200 else ''} like these are "
            "needed, and the guide's choice of poses (verify FILE with a camera as SOURCE) needs "
            "far fewer."
        )
    if found.verdict == "degraded":
        return "Calibrate again; then look what moves: a loose lens, the focus, the temperature."
    if found.verdict == "turned":
        return (
            "Read them as those of the calibration were read: look for an orientation tag, a "
            "program or a driver that turns them."
        )
    if found.verdict == "other-camera":
        return "Check which file belongs to this camera, its zoom and focus; then calibrate again."
    return ""


def method_sentence(found: Verification) -> str:
    """The test that the verdict rests on."""
    chance = figure(found.chance_px)
    return (
        f"The test: {len(found.fresh.views)} fresh views give a calibration of their own, and the "
        f"two cameras differ by {figure(found.diff_px)} px (root mean square over the picture, the "
        f"best common rotation removed). Two calibrations of one unchanged camera exceed {chance} "
        f"px by chance in {100 * CHANCE:.0f} of 100 checks. Each direction in which the parameters "
        "may change together is tested by itself too, as rarely wrong in all: chance does not "
        f"explain {figure(found.changed_px)} px of the difference."
    )


def worst_place(found: Verification) -> str:
    """Where in the picture the difference is largest: "upper right corner"."""
    rows, columns = found.diff_map.shape
    row, column = np.unravel_index(int(np.nanargmax(found.diff_map)), found.diff_map.shape)
    name = _PLACES[min(3 * int(row) // rows, 2)][min(3 * int(column) // columns, 2)]
    corner = " " in name
    return f"{name} corner" if corner else name if name == "middle" else f"{name} edge"


def figures_of(found: Verification) -> list[list[str]]:
    """The figures in rows: what, and how much."""
    distance = 1000 * found.distance_m
    return [
        ["difference over the picture", f"{figure(found.diff_px)} px"],
        [f"the same at the board's distance, {distance:.0f} mm", f"{figure(found.diff_mm)} mm"],
        ["by chance, in 1 of 100 checks more than", f"{figure(found.chance_px)} px"],
        ["largest, " + worst_place(found), f"{figure(float(np.nanmax(found.diff_map)))} px"],
        ["rms of the fresh corners, existing calibration", f"{figure(found.rms_px)} px"],
        ["rms of the fresh corners, fresh calibration", f"{figure(found.fresh.rms_px)} px"],
        ["fresh views", str(len(found.fresh.views))],
    ]


def changes_of(found: Verification) -> list[list[str]]:
    """Each parameter before and now, and by how many standard deviations it differs."""
    rows: list[list[str]] = []
    for index, name in enumerate(found.camera.parameter_names):
        unit, digits = (" px", 2) if index < 4 else ("", 5)
        before, now = found.camera.parameters[index], found.fresh.camera.parameters[index]
        change = found.changes[index]
        told = "–" if np.isnan(change) else f"{change:+.1f} σ".replace("-", "−")
        told = told if np.isnan(change) or abs(change) < _MANY_SIGMA else "over 1000 σ"
        mark = "changed" if abs(change) > TOLD_SIGMA else ""
        rows.append([name, f"{before:.{digits}f}{unit}", f"{now:.{digits}f}{unit}", told, mark])
    return rows


CHANGES_HEAD = ["", "existing", "fresh", "difference", ""]


def verification_report(found: Verification, name: str, warnings: Sequence[str] = ()) -> str:
    """The whole document as HTML; `name` is that of the calibration's file."""
    width, height = found.camera.image_size
    size = (PICTURE_WIDTH, round(PICTURE_WIDTH * height / width))
    high = round_up(float(np.nanmax(found.diff_map)))
    views = found.fresh.views
    lead = f"<p class='v-report-lead {_LOOK[found.verdict]}'>{escape(verdict_sentence(found))}</p>"
    return document(
        f"Does {name} still hold?",
        f"{width} x {height} px, checked with {len(views)} fresh views",
        [
            lead,
            paragraph(cure(found)) if cure(found) else "",
            table(["", ""], figures_of(found), numbers=(1,)),
            section("Mind", *map(paragraph, warnings)) if warnings else "",
            section(
                "Over the picture",
                side_by_side(
                    picture(
                        "How far the two calibrations put one point apart.",
                        difference_picture(found.diff_map, high, size, dark=False),
                        scale_html((0.0, high / 2, high), "px"),
                    ),
                    picture(
                        "Where the corners of the fresh views were: elsewhere the difference is "
                        "least certain.",
                        coverage_picture(views, found.camera.image_size, size, dark=False),
                    ),
                ),
            ),
            section(
                "Parameter by parameter", table(CHANGES_HEAD, changes_of(found), numbers=(1, 2, 3))
            ),
            section("How it was tested", paragraph(method_sentence(found))),
        ],
    )

"""A calibration's report: what was found, how sure it is, from which views, and how to use it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.amounts import figure
from venus3d.engine.calibration.calibration import Calibration, LeftOutReason
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.projection_uncertainty import uncertainty_map
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.field_of_view import fields_of_view_deg
from venus3d.engine.geometry.pose import Array
from venus3d.engine.guidance.prompts import PARAMETER_DESCRIPTIONS
from venus3d.engine.planning.uncertainty import MAP, influences
from venus3d.render.colour_scale import round_down, round_up
from venus3d.render.map_pictures import (
    coverage,
    coverage_picture,
    distortion_magnification,
    distortion_picture,
    largest_shift_px,
    residual_magnification,
    residual_picture,
    uncertainty_picture,
)
from venus3d.report.document import (
    PICTURE_WIDTH,
    code,
    document,
    paragraph,
    photograph,
    picture,
    section,
    side_by_side,
    table,
)
from venus3d.report.usage import cpp_lines, python_lines, ros_lines
from venus3d.scene.web.legend import scale_html

_THUMBNAIL = 360
_CORNER = (80, 220, 40)  # BGR
_LEFT_OUT: dict[LeftOutReason, str] = {
    "undetermined": "its corners fix no pose",
    "misfit": "its corners fit no pose of this board",
    "repeat": "it shows what another view shows",
    "turned": "its picture is turned by 180° against the others",
}


@dataclass(frozen=True, eq=False)
class ReportInput:
    """What a report tells of."""

    calibration: Calibration
    doubts: Sequence[str] = ()
    """Warnings and diagnoses, each with its cure."""
    pictures: Mapping[int, NDArray[np.uint8]] = field(default_factory=dict)
    """(H, W, 3) BGR as captured, by the view's number; may be empty."""
    made_with: Mapping[str, Any] = field(default_factory=dict)
    """Versions, settings, date: what the session was started with; may be empty."""


def calibration_report(told: ReportInput) -> str:
    """The whole document as HTML."""
    calibration = told.calibration
    camera, board = calibration.camera, calibration.board
    width, height = camera.image_size
    subtitle = (
        f"{width} x {height} px, {len(calibration.views)} views of a board of {board.columns} x "
        f"{board.rows} squares of {1000 * board.square:.4g} mm"
    )
    return document(
        "Camera calibration",
        subtitle,
        [
            _result(calibration),
            _doubts(told.doubts),
            _maps(calibration),
            _views(told),
            section(
                "Use it",
                code("Python", python_lines(camera)),
                code("C++", cpp_lines(camera)),
                code("ROS", ros_lines()),
                paragraph("Other programs and other picture sizes: venus3d export --help."),
            ),
            _made_with(told.made_with, board),
        ],
    )


def _result(calibration: Calibration) -> str:
    camera = calibration.camera
    rows: list[list[str]] = []
    for index, name in enumerate(camera.parameter_names):
        unit, digits = (" px", 2) if index < 4 else ("", 5)
        known = f"± {calibration.sigma[index]:.{digits}f}{unit}"
        rows.append(
            [
                name,
                f"{camera.parameters[index]:.{digits}f}{unit}",
                known if calibration.free[index] else "not estimated",
                str(PARAMETER_DESCRIPTIONS[name]),
            ]
        )
    across, down, diagonal = fields_of_view_deg(camera)
    uncertainty = calibration.uncertainty_px
    known = (
        f"A point is projected with an expected error of {figure(uncertainty)} px (root mean "
        f"square over the picture). "
        if np.isfinite(uncertainty)
        else "Not all parameters were estimated, so no projection uncertainty is given. "
    )
    return section(
        "The camera",
        f"<p class='v-report-lead'>{known}The corners fit within {figure(calibration.rms_px)} px "
        "rms.</p>",
        table(["", "value", "standard deviation", ""], rows, numbers=(1, 2)),
        paragraph(f"Lens model: {camera.lens.name}. {calibration.lens_reason}".strip()),
        paragraph(
            f"Field of view: {across:.1f}° across, {down:.1f}° down, {diagonal:.1f}° from corner "
            "to corner. Pixels count from (0, 0), the centre of the upper left pixel. The standard "
            "deviations hold with errors that the corners of one view share, such as a board that "
            "is not quite flat; OpenCV's are smaller where there are such errors."
        ),
    )


def _doubts(doubts: Sequence[str]) -> str:
    if not doubts:
        return section("Doubts", paragraph("None was found."))
    items = "".join(
        f"<p class='v-report-lead v-report-doubtful'>{escape(doubt)}</p>" for doubt in doubts
    )
    return section("Doubts", items)


def _maps(calibration: Calibration) -> str:
    camera, views = calibration.camera, calibration.views
    size = (PICTURE_WIDTH, round(PICTURE_WIDTH * camera.height / camera.width))
    shift = round_up(largest_shift_px(camera))
    counts = float(coverage(views, camera.image_size).max())
    figures = [
        picture(
            "Where the corners of all views were. Striped parts were never used.",
            coverage_picture(views, camera.image_size, size, dark=False),
            scale_html((0.0, round_up(counts) / 2, round_up(counts)), "corners"),
        ),
        picture(
            "Residuals: lines from each corner's calculated place towards where it was seen, "
            f"{residual_magnification(views, camera.image_size):.0f} times as long.",
            residual_picture(views, camera.image_size, size, dark=False),
        ),
        picture(
            "What the lens does: arrows from where an ideal lens would put a point to where this "
            f"one does, {distortion_magnification(camera):.0f} times as long.",
            distortion_picture(camera, size, dark=False),
            scale_html((0.0, shift / 2, shift), "px"),
        ),
    ]
    if np.isfinite(calibration.uncertainty_px):
        known = uncertainty_map(camera, calibration.covariance, MAP)
        low, high = round_down(float(np.nanmin(known))), round_up(float(np.nanmax(known)))
        figures.insert(
            0,
            picture(
                "How far off a projected point may be, by its place in the picture.",
                uncertainty_picture(known, (low, high), size, dark=False),
                scale_html((low, float(np.sqrt(low * high)), high), "px"),
            ),
        )
    return section("Over the picture", side_by_side(*figures))


def _views(told: ReportInput) -> str:
    calibration = told.calibration
    without = {one.number: one for one in influences(calibration)} if all(calibration.free) else {}
    rows: list[list[str]] = []
    for view in calibration.views:
        one = without.get(view.number)
        gone = 0 if view.left_out is None else view.left_out.count
        rows.append(
            [
                _name(view),
                str(view.observation.count) + (f" ({gone} left out)" if gone else ""),
                f"{view.rms_px:.3f} px",
                f"{_tilt_deg(view.pose.R):.0f}°",
                f"{1000 * float(np.linalg.norm(view.pose.t)):.0f} mm",
                "–" if one is None else f"{figure(one.uncertainty_px)} px",
            ]
        )
    head = ["view", "corners", "rms", "tilt", "distance", "error to expect without it"]
    left_out = [
        f"View {one.number} ({one.observation.name or 'no name'}) is left out: "
        f"{_LEFT_OUT[one.reason]}."
        for one in calibration.left_out
    ]
    photographs = [
        photograph(_name(view), _marked(told.pictures[view.number], view))
        for view in calibration.views
        if view.number in told.pictures
    ]
    shown = (
        f"<div class='v-report-figures v-report-small'>{''.join(photographs)}</div>"
        if photographs
        else ""
    )
    return section(
        "The views", table(head, rows, numbers=(1, 2, 3, 4, 5)), *map(paragraph, left_out), shown
    )


def _name(view: View) -> str:
    name = view.observation.name
    return f"{view.number}" + (f" ({name})" if name and name != str(view.number) else "")


def _tilt_deg(R: Array) -> float:
    """Between the board's normal and the camera's axis."""
    return float(np.degrees(np.arccos(np.clip(abs(R[2, 2]), 0.0, 1.0))))


def _marked(bgr: NDArray[np.uint8], view: View) -> NDArray[np.uint8]:
    """A small copy with the corners that were used."""
    scale = _THUMBNAIL / bgr.shape[1]
    small = cv2.resize(bgr, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    if small.ndim == 2:
        small = cv2.cvtColor(small, cv2.COLOR_GRAY2BGR)
    for corner in (view.observation.corners + 0.5) * scale - 0.5:
        x, y = np.rint(corner).astype(int).tolist()
        cv2.circle(small, (x, y), 2, _CORNER, -1, cv2.LINE_AA)
    return np.asarray(small, dtype=np.uint8)


def _made_with(made_with: Mapping[str, Any], board: Board) -> str:
    named = [board.of_kind.name, f"{board.columns} x {board.rows}", board.dictionary]
    rows = [
        ["board", ", ".join(filter(None, named))],
        ["square", f"{1000 * board.square:.6g} mm"],
    ]
    if board.has("marker"):
        rows.append(["marker", f"{1000 * board.marker:.6g} mm"])
    if any(board.bow) or board.stretch:
        across, down = (1000 * bow for bow in board.bow)
        rows.append(
            [
                "board as found",
                f"bow {across:+.2f} mm across, {down:+.2f} mm down; printed "
                f"{100 * board.stretch:+.2f} % longer across than down",
            ]
        )
    rows += [[name, str(value)] for name, value in made_with.items()]
    note = (
        "All lengths are as right as the size of the squares that was given: a ruler laid on the "
        "printed board tells; no picture of the same board can."
    )
    return section("Made with", table(["", ""], rows, numbers=()), paragraph(note))

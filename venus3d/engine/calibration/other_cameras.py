"""Cameras that explain views which a pinhole inside the picture does not.

A fisheye lens, whose edge no pinhole with five distortion terms reaches, and the part cut out of a
larger picture, whose principal point may lie outside. Neither can be told from a calibration that
succeeded by chance with the first few views, so both are looked for wherever the fit is not good.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from venus3d.engine.calibration.bundle import Corners, Problem, Solution, adjust
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.diagnosis import Diagnosis, DiagnosisKind
from venus3d.engine.calibration.fisheye_fit import FisheyeFit, fit_fisheye
from venus3d.engine.calibration.initial_values import located_by
from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.sentences import Sentence

OTHER_CAMERAS: tuple[DiagnosisKind, ...] = ("fisheye-lens", "cropped-pictures")
"""The calibration is that of another camera, and is not given as a result."""
SUSPICIOUS_PX = 0.25
"""A calibration whose rms is below this describes its views, if it left none out."""
BETTER = 3.0
"""Another camera is named if it fits this many times better."""
_GOOD_PX = 1.0
"""A camera that fits the corners worse than this explains nothing."""
_FIELD_DEG, _AWAY = 60.0, (0.0, -1.0, 1.0)
_FEWEST_VIEWS, _FITS_NONE_PX = 2, 100.0
_FISHEYE = Sentence(
    "This is a fisheye lens, {angle}° across: its model fits all corners with rms {rms} px, a "
    "pinhole {pinhole} px."
)
_FISHEYE_ONLY = Sentence(
    "This is a fisheye lens, {angle}° across: its model fits all corners with rms {rms} px, no "
    "pinhole fits."
)


def other_cameras(calibration: Calibration) -> Iterator[Diagnosis]:
    """The camera that the views are from, if the calibration is of another one."""
    if calibration.camera.lens.wide is not None:
        return
    misfits = [one.observation for one in calibration.left_out if one.reason == "misfit"]
    if calibration.rms_px < SUSPICIOUS_PX and not misfits:
        return
    seen = [*(view.observation for view in calibration.views), *misfits]
    # What was left out may be what only the other camera explains.
    rms_px = float("inf") if misfits else calibration.rms_px
    found = explained(calibration.board, seen, rms_px)
    if found is not None:
        yield found


def explained(board: Board, observations: Sequence[Observation], rms_px: float) -> Diagnosis | None:
    """What explains observations that a pinhole fits with `rms_px` or, if infinite, not at all."""
    seen = [o for o in observations if determines_homography(board.points_of(o.ids))]
    if len(seen) < _FEWEST_VIEWS:
        return None
    pinhole = _best_pinhole(board, seen)
    corners = sum(o.count for o in seen)
    best_px = float("inf") if pinhole is None else float(np.sqrt(pinhole.cost / corners))
    fisheye = fit_fisheye(board, seen)
    if fisheye is not None and fisheye.rms_px < min(best_px / BETTER, rms_px / BETTER, _GOOD_PX):
        return _fisheye(fisheye, best_px)
    if pinhole is None or best_px > min(rms_px / BETTER, _GOOD_PX):
        return None
    camera = pinhole.parameters.camera
    if 0 <= camera.cx < camera.width and 0 <= camera.cy < camera.height:
        return None
    return Diagnosis(
        "cropped-pictures",
        Sentence(
            "The principal point lies outside the picture, at ({x}, {y}) px, and explains all "
            "views (rms {rms} px): the pictures are cut out of larger ones."
        ).format(x=f"{camera.cx:.0f}", y=f"{camera.cy:.0f}", rms=f"{best_px:.2f}"),
        Sentence(
            "Calibrate from the whole pictures, and subtract the place of the part from cx and cy."
        ),
    )


def _fisheye(fit: FisheyeFit, pinhole_px: float) -> Diagnosis:
    rms = f"{fit.rms_px:.2f}"
    angle = f"{fit.view_angle_deg:.0f}"
    return Diagnosis(
        "fisheye-lens",
        (_FISHEYE_ONLY if pinhole_px > _FITS_NONE_PX else _FISHEYE).format(
            angle=angle, rms=rms, pinhole=f"{pinhole_px:.2f}"
        ),
        Sentence("Calibrate it as such: --lens fisheye, or --lens auto, which finds it out."),
    )


def _best_pinhole(board: Board, seen: Sequence[Observation]) -> Solution | None:
    """The best of the optima from principal points inside and outside the picture."""
    corners = Corners.of([board.points_of(o.ids) for o in seen], [o.corners for o in seen])
    width, height = seen[0].image_size
    f = Camera.guess((width, height), _FIELD_DEG).fx
    problem = Problem(corners, np.eye(len(Camera.guess((width, height)).parameters)))
    found: list[Solution] = []
    for across in _AWAY:
        for down in _AWAY:
            cx, cy = (0.5 + across) * width, (0.5 + down) * height
            try:
                start = located_by(corners, Camera(width, height, f, f, cx, cy))
                found.append(adjust(problem, start))
            except CalibrationError:
                continue
    return min(found, key=lambda solution: solution.cost, default=None)

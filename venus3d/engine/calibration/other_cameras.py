"""Cameras that explain views which a pinhole inside the picture does not.

A fisheye lens, whose edge no pinhole with five distortion terms reaches, and the part cut out of a
larger picture, whose principal point may lie outside. Neither can be told from a calibration that
succeeded by chance with the first few views, so both are looked for wherever the fit is not good.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import chain

import numpy as np

from venus3d.engine.calibration.bundle import Corners, Parameters, Problem
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.diagnosis import Diagnosis, DiagnosisKind
from venus3d.engine.calibration.initial_values import initial_parameters, located_by
from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.calibration.robust_fit import best_of_starts
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.field_of_view import fields_of_view_deg
from venus3d.engine.geometry.lenses import FISHEYE
from venus3d.engine.sentences import Sentence

OTHER_CAMERAS: tuple[DiagnosisKind, ...] = ("fisheye-lens", "cropped-pictures")
"""The calibration is that of another camera, and is not given as a result."""
SUSPICIOUS_PX = 0.25
"""A calibration whose rms is below this describes its views, if it left none out."""
BETTER = 3.0
"""Another camera is named if it fits this many times better."""
_GOOD_PX = 1.0
"""A camera that fits the corners worse than this explains nothing."""
_FIELD_DEG, _AWAY = 60.0, (0.0, -0.5, 0.5, -1.0, 1.0)
_NARROW_DEG = 75.0
"""Across the picture: a fisheye sees more."""
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
    corners = Corners.of([board.points_of(o.ids) for o in seen], [o.corners for o in seen])
    size = seen[0].image_size
    pinhole, pinhole_px = _best(corners, _pinholes(corners, size))
    fisheye, fisheye_px = _best(corners, initial_parameters(corners, size, FISHEYE))
    fits = fisheye_px < min(pinhole_px / BETTER, rms_px / BETTER, _GOOD_PX)
    if fisheye is not None and fits and fields_of_view_deg(fisheye)[0] > _NARROW_DEG:
        return _fisheye(fisheye, fisheye_px, pinhole_px)
    if pinhole_px > _GOOD_PX:
        # A principal point outside is often not the start that gets farthest in a few steps.
        pinhole, pinhole_px = _best(corners, _pinholes(corners, size), _GOOD_PX)
    if pinhole is None or pinhole_px > min(rms_px / BETTER, _GOOD_PX):
        return None
    if 0 <= pinhole.cx < pinhole.width and 0 <= pinhole.cy < pinhole.height:
        return None
    return cropped(pinhole, pinhole_px)


def cropped(camera: Camera, rms_px: float) -> Diagnosis:
    """The pictures are parts of larger ones: a camera whose principal point lies outside explains
    them."""
    return Diagnosis(
        "cropped-pictures",
        Sentence(
            "The principal point lies outside the picture, at ({x}, {y}) px, and explains all "
            "views (rms {rms} px): the pictures are cut out of larger ones."
        ).format(x=f"{camera.cx:.0f}", y=f"{camera.cy:.0f}", rms=f"{rms_px:.2f}"),
        Sentence(
            "Calibrate from the whole pictures, and subtract the place of the part from cx and cy."
        ),
    )


def _fisheye(camera: Camera, rms_px: float, pinhole_px: float) -> Diagnosis:
    return Diagnosis(
        "fisheye-lens",
        (_FISHEYE_ONLY if pinhole_px > _FITS_NONE_PX else _FISHEYE).format(
            angle=f"{fields_of_view_deg(camera)[0]:.0f}",
            rms=f"{rms_px:.2f}",
            pinhole=f"{pinhole_px:.2f}",
        ),
        Sentence("Calibrate it as such: --lens fisheye, or --lens auto, which finds it out."),
    )


def _best(
    corners: Corners, starts: Iterator[Parameters], suspicious_px: float = float("inf")
) -> tuple[Camera | None, float]:
    """The camera that fits best from these starts, and its rms in pixels; infinite if none does.
    Only from `suspicious_px` on all starts are followed: what fits badly explains nothing."""
    first = next(starts, None)
    if first is None:
        return None, float("inf")
    problem = Problem(corners, np.eye(len(first.camera.parameters)))
    try:
        found = best_of_starts(problem, chain((first,), starts), suspicious_px)
    except CalibrationError:
        return None, float("inf")
    return found.parameters.camera, float(np.sqrt(found.cost / corners.weights.sum()))


def _pinholes(corners: Corners, size: tuple[int, int]) -> Iterator[Parameters]:
    """Pinholes with principal points inside and outside a picture of `size`."""
    width, height = size
    f = Camera.guess(size, _FIELD_DEG).fx
    for across in _AWAY:
        for down in _AWAY:
            camera = Camera(width, height, f, f, (0.5 + across) * width, (0.5 + down) * height)
            with suppress(CalibrationError):
                yield located_by(corners, camera)

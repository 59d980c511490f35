"""Whether an existing calibration still holds: it is compared with fresh views of the board.

The fresh views give a calibration of their own, and D, the projection difference of the two cameras
(rms over the picture, best common rotation removed), says how far apart they are in pixels. Two
calibrations of one unchanged camera differ as well. To first order their D^2 is d^T W d, where d is
Gaussian with the sum C of both covariances and W is `projection_weight`: a sum of squares with the
eigenvalues of W C as weights, whose quantiles are those of a scaled chi-square with the same mean
and variance (Satterthwaite 1946). So `chance_px`, exceeded by chance once in a hundred checks, is
what separates a change from the uncertainty of the check itself.

Views that leave one thing open (how long the focus is) still show the others (how the lens bends).
So each direction is tested too: in the p eigenvectors common to W and C the parts of D^2 are
independent, l_i z_i^2 with z_i of variance 1 by chance. Those beyond Student's t of as many views,
once in a hundred checks for any of them (Bonferroni), have changed; `changed_px` is their sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy.special import chdtri, stdtrit

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import View, reprojection_errors, rms_distance
from venus3d.engine.calibration.projection_uncertainty import (
    grid_pixels,
    projection_diff_map,
    projection_diff_px,
    projection_weight,
)
from venus3d.engine.calibration.turned_pictures import turned_camera
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import FOLDED, Camera, folded_share
from venus3d.engine.geometry.pose import Array

Verdict = Literal["good", "degraded", "turned", "other-camera", "unclear"]
"""good: no change beyond the limit; degraded: a change beyond it that chance does not explain;
turned: one that is none once the fresh pictures are turned back by 180°;
other-camera: so large a change that another camera, zoom, focus or resolution is more likely;
unclear: the fresh views could not have shown a change of the limit's size."""
CHANCE = 0.01
"""Share of checks of an unchanged camera in which the difference exceeds `chance_px`."""
LIMIT_PX = 1.0
"""Usual limit for the projection difference."""
ANOTHER = 0.05
"""A focal length that differs by more than this share, or a principal point by more than this share
of the picture's width, is no drift."""
ANOTHER_SHAPE = 0.1
"""Cameras that differ over the picture as much as by this share of the focal length are two,
however their focal lengths and principal points agree: no drift bends a lens so."""
_SEES = 0.9
"""Share of the fresh corners that an existing camera of these pictures sees at least."""
MAP = (36, 24)
"""Cells of `Verification.diff_map` across and down."""


@dataclass(frozen=True, eq=False)
class Verification:
    """An existing camera beside a calibration from fresh views."""

    camera: Camera
    fresh: Calibration
    verdict: Verdict
    limit_px: float
    diff_px: float
    """Projection difference of the two, pixels: rms over the picture."""
    chance_px: float
    """The difference that two calibrations of one camera exceed in `CHANCE` of checks, pixels."""
    changed_px: float
    """The part of the difference that chance does not explain, pixels: all of it if it is more than
    `chance_px`, else in the directions that have changed."""
    diff_map: Array
    """(rows, columns) the difference at the centres of equal cells, pixels; NaN where no ray is."""
    rms_px: float
    """Rms reprojection distance of the fresh corners under the existing camera, each view with its
    best pose, pixels. `fresh.rms_px` is that of the fresh camera."""
    distance_m: float
    """Median distance of the board in the fresh views, metres."""
    turned_back_px: float | None
    """`diff_px` with the fresh pictures turned by 180°, where that explains the change."""
    changes: Array
    """(p,) fresh minus existing parameters in standard deviations of the difference; NaN where
    neither is uncertain."""

    @property
    def diff_mm(self) -> float:
        """The difference at the board's distance, across the line of sight, millimetres."""
        focal = float(np.sqrt(self.fresh.camera.fx * self.fresh.camera.fy))
        return 1000 * self.diff_px * self.distance_m / focal


def verify(
    camera: Camera, covariance: Array | None, fresh: Calibration, limit_px: float = LIMIT_PX
) -> Verification:
    """Compare an existing camera with a calibration from fresh views.

    Args:
        camera: the existing calibration.
        covariance: (p, p) of its parameters; None: taken as exactly known.
        fresh: of the same picture size, with all parameters estimated.
        limit_px: the largest projection difference that does no harm, pixels.

    Raises:
        CalibrationError: different picture sizes or lens models, the existing lens does not reach
            the fresh corners or the picture, explains no view, or the fresh views leave parameters
            open.
    """
    if not all(fresh.free):
        raise CalibrationError("The fresh views do not determine all parameters; take more.")
    if camera.image_size != fresh.camera.image_size:
        (w, h), (other_w, other_h) = camera.image_size, fresh.camera.image_size
        cure = (
            "they were turned by a quarter: turn them back"
            if (w, h) == (other_h, other_w)
            else "verify with pictures of its size, or convert it with venus3d export --size"
        )
        raise CalibrationError(
            f"The camera file is for pictures of {w} x {h} px, these are {other_w} x {other_h} px; "
            f"{cure}."
        )
    if camera.lens != fresh.camera.lens:
        raise CalibrationError(
            f"The camera file has a lens of the model {camera.lens.name}, the fresh views were "
            f"calibrated with {fresh.camera.lens.name}; calibrate them with the same model."
        )
    _check_lens(camera, fresh)
    rms_px = _rms_px(camera, fresh, fresh.views)
    if np.isnan(rms_px):
        raise CalibrationError(
            "The camera file is of no camera that took these pictures: under it no pose of the "
            f"board fits most of the views ({camera.told_distortion}); check which file it is, and "
            "its distortion."
        )
    found = _compared(camera, covariance, fresh, limit_px, rms_px)
    if found.verdict not in ("degraded", "other-camera"):
        return found
    turned, signs = turned_camera(camera)
    turned_covariance = None if covariance is None else covariance * np.outer(signs, signs)
    back = _compared(turned, turned_covariance, fresh, limit_px, rms_px)
    if back.verdict in ("degraded", "other-camera"):
        return found
    return replace(found, verdict="turned", turned_back_px=back.diff_px)


def _compared(
    camera: Camera,
    covariance: Array | None,
    fresh: Calibration,
    limit_px: float,
    rms_px: float,
) -> Verification:
    joint = fresh.covariance if covariance is None else fresh.covariance + covariance
    diff_px, chance_px = projection_diff_px(camera, fresh.camera), _chance_px(fresh.camera, joint)
    sigma = np.sqrt(np.diag(joint))
    moved = fresh.camera.parameters - camera.parameters
    changed_px = diff_px
    if diff_px <= chance_px:
        changed_px = min(_changed_px(fresh.camera, joint, moved, len(fresh.views)), diff_px)
    return Verification(
        camera=camera,
        fresh=fresh,
        verdict=_verdict(camera, fresh.camera, diff_px, changed_px, chance_px, limit_px),
        limit_px=limit_px,
        diff_px=diff_px,
        chance_px=chance_px,
        changed_px=changed_px,
        diff_map=projection_diff_map(camera, fresh.camera, MAP),
        rms_px=rms_px,
        distance_m=float(np.median([np.linalg.norm(view.pose.t) for view in fresh.views])),
        turned_back_px=None,
        changes=np.divide(moved, sigma, out=np.full(len(sigma), np.nan), where=sigma > 0),
    )


def _check_lens(camera: Camera, fresh: Calibration) -> None:
    """Raise `CalibrationError` for a lens model that folds back where these pictures were seen."""
    seen = np.concatenate([view.observation.corners for view in fresh.views])
    sees = int(np.count_nonzero(np.isfinite(camera.unproject(seen)[:, 2])))
    if sees < _SEES * len(seen):
        raise CalibrationError(
            f"The camera file is not of this camera: its lens reaches only {sees} of the "
            f"{len(seen)} corners seen, and folds back before the others; check which file it is, "
            "and its distortion."
        )
    pixels = grid_pixels(camera.image_size, MAP)
    pixels = pixels[np.isfinite(fresh.camera.unproject(pixels)[:, 2])]
    folded = folded_share(camera, pixels)
    if folded > FOLDED:
        raise CalibrationError(
            f"The lens model in the camera file folds back within the picture: no ray reaches "
            f"{100 * folded:.0f} % of it ({camera.told_distortion}). It is another camera's file, "
            "or was calibrated without views up to the border; calibrate again."
        )


def _chance_px(camera: Camera, covariance: Array) -> float:
    weighted = projection_weight(camera) @ covariance
    mean, mean_square = float(np.trace(weighted)), float(np.trace(weighted @ weighted))
    scale, freedom = mean_square / mean, mean**2 / mean_square
    return float(np.sqrt(scale * chdtri(freedom, CHANCE)))


def _changed_px(camera: Camera, covariance: Array, moved: Array, views: int) -> float:
    """The part of the difference `moved` (p,) in the directions that have changed."""
    L = np.linalg.cholesky(covariance)
    shares, directions = np.linalg.eigh(L.T @ projection_weight(camera) @ L)
    z = directions.T @ np.linalg.solve(L, moved)
    limit = stdtrit(views - 1, 1 - CHANCE / (2 * len(z)))
    return float(np.sqrt(np.maximum(shares, 0.0) @ np.where(np.abs(z) > limit, z, 0.0) ** 2))


def _verdict(
    camera: Camera,
    fresh: Camera,
    diff_px: float,
    changed_px: float,
    chance_px: float,
    limit_px: float,
) -> Verdict:
    if changed_px > 0 and (_is_another(camera, fresh) or _is_bent(fresh, diff_px)):
        return "other-camera"
    if changed_px > limit_px:
        return "degraded"
    return "good" if changed_px > chance_px or chance_px <= limit_px else "unclear"


def _is_another(camera: Camera, fresh: Camera) -> bool:
    focal = np.array([fresh.fx / camera.fx, fresh.fy / camera.fy]) - 1
    centre = np.array([fresh.cx - camera.cx, fresh.cy - camera.cy]) / camera.width
    return bool(np.abs([*focal, *centre]).max() > ANOTHER)


def _is_bent(fresh: Camera, diff_px: float) -> bool:
    # Another focal length moves pixels by their distance from the principal point.
    radii = np.linalg.norm(grid_pixels(fresh.image_size, MAP) - [fresh.cx, fresh.cy], axis=1)
    return diff_px > ANOTHER_SHAPE * float(np.sqrt(np.mean(radii**2)))


def _rms_px(camera: Camera, fresh: Calibration, views: Sequence[View]) -> float:
    """Of the views that have a pose under this camera; NaN if most have none."""
    squares, corners, fitted = 0.0, 0, 0
    for view in views:
        seen = view.observation
        pose = estimate_pose(camera, fresh.board, seen, view.pose)
        if pose is None:
            continue
        errors = reprojection_errors(camera, fresh.board, seen, pose)
        squares += seen.count * rms_distance(errors) ** 2
        corners, fitted = corners + seen.count, fitted + 1
    return float(np.sqrt(squares / corners)) if 2 * fitted >= len(views) else float("nan")

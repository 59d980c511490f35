"""Projection uncertainty over the image, now and after the next view, and each view's influence.

The calibration without one of its views is estimated without calibrating again. At the optimum let
view i have the residuals r_i, the Jacobian J_i by the intrinsics and the information I_i of
`information`, and let A be the sum of the other views' informations. To first order the others give

    the parameters        x - A^-1 g,                     g = J_i^T r_i
    the sum of squares    S - |r_i|^2 - g^T A^-1 g,       S that of all views
    the covariance        sigma^2 A^-1,                   sigma^2 = squares / degrees of freedom

(Cook 1977, "Detection of influential observation in linear regression"). r_i is orthogonal to the
view's own pose at its optimum, so the pose drops out of g.

Where a view's corners share errors (`shared_errors`), A of the covariance is made of informations
that account for them, and multiplied by one factor with which the covariance of all views is the
calibration's own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.information import covariance_of, information_of
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.projection_uncertainty import (
    projection_uncertainty_px,
    uncertainty_map,
)
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.target import Target

MAP = (36, 24)
"""Cells of the maps across and down: 3 x 3 per ray of the mean, which is the middle one."""
# Singular below this smallest eigenvalue of the information with unit diagonal.
_TIED = 1e-13


@dataclass(frozen=True, eq=False)
class Influence:
    """The calibration without one of its views, to first order."""

    number: int
    """The view's number."""
    uncertainty_px: float
    """Projection uncertainty over the image, pixels; NaN if the others determine no camera."""
    rms_px: float
    """Root mean square reprojection distance of the others; NaN likewise."""
    parameters: Array
    """(p,) the camera's parameters from the others alone; NaN likewise."""
    sigma: Array
    """(p,) their standard deviations; NaN likewise."""


@dataclass(frozen=True, eq=False)
class ProjectionUncertainty:
    """Uncertainty of a camera over its image, and each view's contribution."""

    uncertainty_px: float
    """Projection uncertainty over the image, pixels: the root mean square of the map."""
    uncertainty_map: Array
    """(rows, columns) the same at the centres of equal cells; NaN where there is no ray."""
    predicted: tuple[tuple[Pose, Array], ...]
    """The poses of the target and its alternatives, each with the expected map after a view."""
    influences: tuple[Influence, ...]
    """For each view, in order, the calibration without it."""

    def predicted_at(self, pose: Pose) -> Array | None:
        """The expected map after a view at exactly this pose; None if it is none of them."""
        return next((map_ for aim, map_ in self.predicted if aim is pose), None)

    def without(self, number: int) -> Influence | None:
        """The influence of the view with this number; None if there is none."""
        return next((left for left in self.influences if left.number == number), None)


def projection_uncertainty(
    calibration: Calibration, posterior: Posterior, target: Target | None
) -> ProjectionUncertainty | None:
    """The uncertainty of a calibration; None while it does not estimate all parameters.

    Args:
        posterior: of the same views; gives the expected maps.
        target: the next target, with its alternatives; None if there is none.
    """
    if not all(calibration.free):
        return None
    targets = () if target is None else (target, *target.alternatives)
    predicted: list[tuple[Pose, Array]] = []
    if targets and posterior.settled:
        after = posterior.after(np.array([aim.pose.vector() for aim in targets]))
        predicted = [
            (aim.pose, uncertainty_map(posterior.camera, covariance, MAP))
            for aim, covariance in zip(targets, after, strict=True)
        ]
    return ProjectionUncertainty(
        calibration.uncertainty_px,
        uncertainty_map(calibration.camera, calibration.covariance, MAP),
        tuple(predicted),
        influences(calibration),
    )


def influences(calibration: Calibration) -> tuple[Influence, ...]:
    """A full calibration without each of its views, in order."""
    camera, board, views = calibration.camera, calibration.board, calibration.views
    parts = [information_of(camera, board, view.observation, view.pose) for view in views]
    total = np.sum(parts, axis=0)
    left = [
        _without(camera, views, view, total - part, _pull(calibration, view))
        for view, part in zip(views, parts, strict=True)
    ]
    if calibration.corner_errors.shared_px == 0:
        return tuple(left)
    return _with_shared_errors(calibration, left)


def _pull(calibration: Calibration, view: View) -> Array:
    """(p,) the gradient of a view's squares by the parameters, g; for unit noise."""
    points = calibration.board.points_of(view.observation.ids)
    R, t = view.pose.R[None], view.pose.t[None]
    _, intrinsic, _ = calibration.camera.project_with_jacobians(points, R, t)
    return intrinsic.reshape(-1, intrinsic.shape[-1]).T @ view.errors.reshape(-1)


def _without(
    camera: Camera, views: Sequence[View], view: View, others: Array, gradient: Array
) -> Influence:
    corners = sum(v.observation.count for v in views) - view.observation.count
    freedom = 2 * corners - len(gradient) - 6 * (len(views) - 1)
    unit = _covariance(others) if freedom > 0 else None
    if unit is None:
        nothing = np.full(len(gradient), np.nan)
        return Influence(view.number, float("nan"), float("nan"), nothing, nothing)
    squares = sum(float(np.sum(v.errors**2)) for v in views if v is not view)
    squares = max(squares - float(gradient @ unit @ gradient), 0.0)
    covariance = squares / freedom * unit
    return Influence(
        view.number,
        projection_uncertainty_px(camera, covariance),
        float(np.sqrt(squares / corners)),
        camera.parameters - unit @ gradient,
        np.sqrt(np.diag(covariance)),
    )


def _with_shared_errors(
    calibration: Calibration, left: Sequence[Influence]
) -> tuple[Influence, ...]:
    """The influences with the covariances that the errors shared by a view's corners leave."""
    camera, board, ratio = calibration.camera, calibration.board, calibration.corner_errors.ratio
    informations = [
        information_of(camera, board, v.observation, v.pose, ratio) for v in calibration.views
    ]
    total = np.sum(informations, axis=0)
    unit = covariance_of(total)
    factor = (calibration.uncertainty_px / projection_uncertainty_px(camera, unit)) ** 2
    found: list[Influence] = []
    for influence, information in zip(left, informations, strict=True):
        others = _covariance(total - information)
        if others is None or not np.isfinite(influence.rms_px):
            found.append(influence)
            continue
        covariance = factor * (influence.rms_px / calibration.rms_px) ** 2 * others
        found.append(
            replace(
                influence,
                uncertainty_px=projection_uncertainty_px(camera, covariance),
                sigma=np.sqrt(np.diag(covariance)),
            )
        )
    return tuple(found)


def _covariance(information: Array) -> Array | None:
    """(p, p) for unit noise; None if the information is (nearly) singular."""
    scale = np.sqrt(np.abs(np.diag(information)))
    if not (scale > 0).all():
        return None
    if np.linalg.eigvalsh(information / np.outer(scale, scale))[0] < _TIED:
        return None
    return covariance_of(information)

"""What a calibration knows over the image, what the next view adds, and what each view has part in.

Leaving a view out needs no new calibration to be told beforehand. At the optimum let view i have
the residuals r_i, the Jacobian J_i by the intrinsics and the information I_i of `information`, and
let A be the sum of the other views' informations. To first order the others alone

    say the parameters    x - A^-1 g,                     g = J_i^T r_i
    leave the squares     S - |r_i|^2 - g^T A^-1 g,       S those of all views
    have the covariance   sigma^2 A^-1,                   sigma^2 = squares / degrees of freedom

(Cook 1977, "Detection of influential observation in linear regression"). r_i is orthogonal to the
view's own pose, which is at its optimum, so the pose drops out of g.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.projection_uncertainty import (
    projection_uncertainty_px,
    uncertainty_map,
)
from venus3d.engine.calibration.result import Calibration
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PARAMETERS, Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.target import Target
from venus3d.engine.planning.uncertainty import Influence, ProjectionUncertainty

MAP = (36, 24)
"""Cells of the maps across and down: three in each direction for one ray of the mean error, which
is the middle one."""
# Information whose parameters are tied more strongly than this cannot be told from singular.
_TIED = 1e-13


def projection_uncertainty(
    board: Board, calibration: Calibration, posterior: Posterior, target: Target | None
) -> ProjectionUncertainty | None:
    """What this calibration knows; None while it does not estimate all nine parameters.

    Args:
        posterior: of the same views; the maps to expect after a view are its.
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
    camera, covariance = calibration.camera, calibration.covariance
    return ProjectionUncertainty(
        projection_uncertainty_px(camera, covariance),
        uncertainty_map(camera, covariance, MAP),
        tuple(predicted),
        influences(board, calibration),
    )


def influences(board: Board, calibration: Calibration) -> tuple[Influence, ...]:
    """What would be known without each of the views of a full calibration, in their order."""
    camera, views = calibration.camera, calibration.views
    told = [_told(board, camera, view) for view in views]
    total = np.sum([information for information, _ in told], axis=0)
    return tuple(
        _without(camera, views, view, total - information, gradient)
        for view, (information, gradient) in zip(views, told, strict=True)
    )


def _told(board: Board, camera: Camera, view: View) -> tuple[Array, Array]:
    """The view's information (9, 9) and its pull on the parameters, g (9,); unit noise."""
    points = board.points_of(view.observation.ids)
    R, t = view.pose.R[None], view.pose.t[None]
    _, intrinsic, _ = camera.project_with_jacobians(points, R, t)
    gradient = intrinsic.reshape(-1, len(PARAMETERS)).T @ view.errors.reshape(-1)
    return view_information(camera, points, R, t)[0], gradient


def _without(
    camera: Camera, views: Sequence[View], view: View, others: Array, gradient: Array
) -> Influence:
    corners = sum(v.observation.count for v in views) - view.observation.count
    freedom = 2 * corners - len(PARAMETERS) - 6 * (len(views) - 1)
    unit = _covariance(others) if freedom > 0 else None
    if unit is None:
        nothing = np.full(len(PARAMETERS), np.nan)
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


def _covariance(information: Array) -> Array | None:
    """(9, 9) for unit noise; None if the information is singular, or as good as."""
    scale = np.sqrt(np.abs(np.diag(information)))
    if not (scale > 0).all():
        return None
    if np.linalg.eigvalsh(information / np.outer(scale, scale))[0] < _TIED:
        return None
    return covariance_of(information)

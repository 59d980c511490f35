"""The board as it is: a bow and a stretch of the print, estimated if the residuals ask for them.

A board that is not flat, or a print that is longer one way, moves all corners of all views in one
pattern, and the intrinsics give way to it: a bow of 2 mm moves fx by 4 % at a low rms. Three
parameters are added to the bundle adjustment (`Board.bow`, `Board.stretch`), shared by all views; a
fourth for grids of tags, whose corners lie otherwise if the tags are larger than given.

They must be earned: each stays if it lies `EARNED` standard deviations beyond what passes for flat
and true (`FLAT`, `TRUE`), with the errors that a view's corners share (`shared_errors`). A board
that bends anew in each view, glare or a rolling shutter are such errors and do not pass for a bow.
Independent noise alone would not do: good recordings reach 6 to 12 of its standard deviations. What
is smaller than `FLAT` stays in the uncertainty: taken into the model in one half of a recording and
not in the other, it moved the halves apart (docs/uncertainty.md). What is `LIKELY` and not earned
is left out of the model, and what it would change is a doubt that the covariance contains.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag

from venus3d.engine.calibration.bundle import adjust, derivatives, one_step
from venus3d.engine.calibration.information import covariance_of
from venus3d.engine.calibration.robust_fit import RobustFit, without_outliers
from venus3d.engine.calibration.shared_errors import (
    CornerErrors,
    ViewResidual,
    corner_errors,
    robust_covariance,
)
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

EARNED = 5.0
"""Standard deviations beyond flat and true at which a parameter of the shape is kept."""
LIKELY = 3.0
"""Standard deviations beyond flat and true from which a parameter that is not kept is a doubt."""
FLAT, TRUE = 0.001, 0.002
"""A board passes for flat with a bow up to this share of its longer side, a print for true with a
stretch up to this, tags with a side that is off by this share."""
FEWEST_VIEWS = 4
"""With fewer views, a shape cannot be told from what their corners share."""
PRIOR_BOW_M, PRIOR_STRETCH, PRIOR_MARKER = 0.0005, 0.005, 0.03
"""Standard deviations of a bow, of a stretch and of a share of the tags' side before any picture is
seen."""
_NOISE_PX = 0.1
"""A corner's noise that weighs this prior: the fit's own would be the misfit of a flat board."""


@dataclass(frozen=True, eq=False)
class Uncertainty:
    """What the residuals of a fit say of its errors."""

    errors: CornerErrors
    covariance: Array
    """(q, q) of the adjusted parameters, with the errors that a view's corners share."""


def uncertainty_of(board: Board, fit: RobustFit) -> Uncertainty:
    """The corners' errors and the covariance of a fit."""
    problem, solution = fit.problem, fit.solution
    parts: list[ViewResidual] = []
    for by, errors, points, weights in zip(
        derivatives(problem, solution.parameters),
        solution.errors,
        problem.corners.points,
        problem.corners.weights,
        strict=True,
    ):
        used = weights > 0
        parts.append(ViewResidual.of(board, points[used], errors[:, used], by[:, :, used]))
    found = corner_errors(parts)
    return Uncertainty(found, robust_covariance(parts, found))


def with_shape(board: Board, flat: RobustFit) -> RobustFit:
    """A fit of the full model with the parameters of the board's shape that it earns, and with its
    doubts."""
    problem, sigma = flat.problem, flat.sigma_px
    p = problem.basis.shape[1]
    if len(problem.corners.points) < FEWEST_VIEWS:
        return flat
    deformations, prior, tolerance = _shape_of(board, problem.corners.points)
    every = block_diag(problem.basis, np.eye(len(prior)))
    whole = replace(problem, basis=every, deformations=deformations, prior=(_NOISE_PX / prior) ** 2)
    at = replace(flat.solution.parameters, shape=np.zeros(len(prior)))
    step, information = one_step(whole, replace(flat.solution, parameters=at))
    # Cheap, and hardly ever stricter: the errors that views share only add to this uncertainty.
    spread = sigma * np.sqrt(np.diag(covariance_of(information))[p:])
    if (abs(step[p:]) < EARNED * spread + 0.5 * tolerance).all():
        return flat
    fit = replace(flat, problem=whole, solution=replace(flat.solution, parameters=at))
    kept = np.ones(len(prior), dtype=bool)
    doubts: list[Array] = []
    likely: Array | None = None
    while kept.any():
        fit = _refitted(fit, basis=every[:, np.append(np.ones(p, dtype=bool), kept)])
        if likely is not None:
            doubts.append(likely - _camera(fit))
        covariance = uncertainty_of(board, fit).covariance
        shape = fit.solution.parameters.shape
        variances = np.diag(covariance)[p:]
        # Of a camera that fits nothing they may be negative, by rounding: nothing is known.
        spread = np.sqrt(np.where(variances > 0, variances, np.inf))
        beyond = (abs(shape) - tolerance)[kept] / spread
        if (beyond >= EARNED).all():
            # The views determine it: the prior would only draw a strong bow towards flat.
            return replace(_refitted(fit, prior=np.zeros(len(prior))), doubts=tuple(doubts))
        likely = _camera(fit) if beyond.min() >= LIKELY else None
        kept[np.flatnonzero(kept)[int(np.argmin(beyond))]] = False
        parameters = replace(fit.solution.parameters, shape=shape * kept)
        fit = replace(fit, solution=replace(fit.solution, parameters=parameters))
    if likely is not None:
        doubts.append(likely - _camera(flat))
    return replace(flat, doubts=tuple(doubts))


def _shape_of(board: Board, points: Array) -> tuple[Array, Array, Array]:
    """Shifts (K, ..., 3) of board points (..., 3) by each parameter, their prior standard
    deviations (K,) and what passes for flat and true (K,)."""
    longer, by_marker = max(board.width, board.height), board.of_kind.by_marker(board, points)
    deformations = board.deformations(points)
    prior = np.array([PRIOR_BOW_M, PRIOR_BOW_M, PRIOR_STRETCH])
    tolerance = np.array([FLAT * longer, FLAT * longer, TRUE])
    if by_marker is None:
        return deformations, prior, tolerance
    return (
        np.concatenate([deformations, by_marker[None]]),
        np.append(prior, PRIOR_MARKER * board.marker),
        np.append(tolerance, TRUE * board.marker),
    )


def _camera(fit: RobustFit) -> Array:
    return fit.solution.parameters.camera.parameters


def _refitted(fit: RobustFit, **changes: Array) -> RobustFit:
    """A changed problem's fit, from where this one ended, with all corners of its views."""
    corners = replace(fit.problem.corners, weights=fit.counted)
    problem = replace(fit.problem, corners=corners, **changes)
    again = without_outliers(problem, adjust(problem, fit.solution.parameters))
    return replace(again, kept=tuple(fit.kept[i] for i in again.kept))

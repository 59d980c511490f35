"""Errors that all corners of a view share, and the covariance that remains right with them.

A board that is not quite flat, glare, blur or a corner refinement drawn to one side move
neighbouring corners of a view alike. With 88 corners such a view is not 88 independent
measurements, and the covariance of independent noise (OpenCV's, Kalibr's, mrcal's) promises too
much: random halves of real recordings differ by more than 2 sigma in 30 to 60 % of their
parameters instead of 5 %.

**The model.** The errors (u and v alike) of a view's corners are

    e = n + T s,    n ~ N(0, sigma^2 I),    s ~ N(0, tau^2 I),

with the columns of T all polynomials of the board's coordinates up to the third degree, each of
unit rms over the board. sigma and tau hold for all views; tau / sigma is chosen so that the
residuals are most likely (restricted maximum likelihood, Patterson and Thompson 1971: poses and
intrinsics are projected out first). `docs/uncertainty.md` derives and measures all of this.

**The covariance.** With M_v the Jacobian of view v by the intrinsics, pose projected out, and
H = sum M_v^T M_v, the least-squares estimate has the covariance H^-1 (sum M_v^T V M_v) H^-1. For V
there are two estimates: the model's, steady with few views, and the residuals themselves with each
view as one draw (cluster-robust CR2, Bell and McCaffrey 2002), true for any error with many. They
are mixed with weights that depend on the number of views, and multiplied by the variance of
Student's t, since both were learnt from few views. Where the residuals show no shared part, the
covariance of independent noise is left as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from venus3d.engine.calibration.information import covariance_of, shared_modes
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array

SURE, UNSURE = 24.0, 8.0
"""Twice the gain in log-likelihood at which a shared part counts fully, and not at all. Independent
noise reaches 3 in 5 % of sets and 8 in less than 1 %; five real views reach 30 to 160."""
MODEL_VIEWS = 8
"""With this many views, model and cluster-robust covariance count alike."""
_LOG_RATIOS = (-6.0, 2.0)
"""Bounds of ln(tau / sigma)."""


@dataclass(frozen=True)
class CornerErrors:
    """Standard deviations of the errors of detected corners, per axis, pixels."""

    noise_px: float
    """Of the part that is independent in each corner."""
    shared_px: float = 0.0
    """Of each smooth mode that all corners of one view share; 0 if the residuals show none."""

    @property
    def ratio(self) -> float:
        """tau / sigma."""
        return self.shared_px / self.noise_px if self.noise_px > 0 else 0.0


@dataclass(frozen=True, eq=False)
class ViewResidual:
    """One view's residuals and derivatives with its own pose projected out."""

    errors: Array
    """(n,) residuals, u of all corners and then v."""
    intrinsics: Array
    """(n, p) derivatives by the intrinsics."""
    modes: Array
    """(n, k) shared modes."""

    @property
    def freedom(self) -> int:
        """Number of residuals that the pose leaves free."""
        return len(self.errors) - 6

    @classmethod
    def of(cls, board: Board, points: Array, errors: Array, by: Array) -> ViewResidual:
        """Project the pose out of a view's residuals.

        Args:
            points: (M, 3) on the board.
            errors: (2, M) observed minus projected.
            by: (6 + p, 2, M) derivatives by the pose and the intrinsics.
        """
        stacked = by.reshape(len(by), -1).T
        modes = np.kron(np.eye(2), shared_modes(board, points))
        columns = np.concatenate([errors.reshape(-1, 1), stacked[:, 6:], modes], axis=1)
        Q = np.linalg.qr(stacked[:, :6]).Q
        columns = (columns - Q @ (Q.T @ columns)).astype(np.float64)
        p = len(by) - 6
        return cls(columns[:, 0], columns[:, 1 : 1 + p], columns[:, 1 + p :])

    def gram(self, columns: Array, ratio: float) -> Array:
        """(q, q) normal matrix of columns (n, q), weighed for this `ratio` of shared to independent
        errors."""
        gram = columns.T @ columns
        if ratio > 0:
            T = self.modes
            along = T.T @ columns
            gram -= along.T @ np.linalg.solve(np.eye(T.shape[1]) / ratio**2 + T.T @ T, along)
        return np.asarray(gram, dtype=np.float64)


def corner_errors(views: Sequence[ViewResidual]) -> CornerErrors:
    """Independent and shared part of the corners' errors, from the residuals of all views.

    A shared part that the residuals hardly ask for is taken in part, or not at all.
    """
    likelihood = _Likelihood(views)
    base, noise = likelihood.at(0.0)

    def unlikely(log_ratio: float) -> float:
        return likelihood.at(float(np.exp(log_ratio)))[0]

    found: Any = minimize_scalar(
        unlikely,
        bounds=_LOG_RATIOS,
        method="bounded",
        options={"xatol": 0.01},
    )
    ratio = float(np.exp(found.x))
    weight = float(np.clip((base - found.fun - UNSURE) / (SURE - UNSURE), 0.0, 1.0))
    if weight == 0.0:
        return CornerErrors(noise)
    ratio *= weight**0.5
    noise = likelihood.at(ratio)[1]
    return CornerErrors(noise, ratio * noise)


class _Likelihood:
    """Restricted likelihood of the residuals, as a function of tau / sigma.

    The modes of each view are turned so that T^T T is diagonal, d_k. Then (I + r^2 T T^T)^-1 is
    I - sum_k t_k t_k^T / (1 / r^2 + d_k), and one ratio costs a few sums over all modes.
    """

    def __init__(self, views: Sequence[ViewResidual]) -> None:
        self._scale = 1.0 / np.sqrt(sum((v.intrinsics**2).sum(axis=0) for v in views))
        parts = [_along_modes(v, v.intrinsics * self._scale) for v in views]
        self._d = np.concatenate([d for d, _ in parts])
        self._along = np.concatenate([along for _, along in parts])
        M = np.concatenate([v.intrinsics for v in views]) * self._scale
        e = np.concatenate([v.errors for v in views])
        self._normal, self._right, self._square = M.T @ M, M.T @ e, float(e @ e)
        self._freedom = sum(v.freedom for v in views) - len(self._scale)

    def at(self, ratio: float) -> tuple[float, float]:
        """Minus twice the log-likelihood, but for a constant, and the most likely sigma."""
        loss = ratio**2 / (1 + ratio**2 * self._d)
        taken = (self._along * loss[:, None]).T @ self._along
        normal, right = self._normal - taken[1:, 1:], self._right - taken[1:, 0]
        left = self._square - taken[0, 0] - right @ np.linalg.solve(normal, right)
        sigma2 = max(float(left) / self._freedom, 1e-30)
        log_det = np.log1p(ratio**2 * self._d).sum() + np.linalg.slogdet(normal)[1]
        return self._freedom * np.log(sigma2) + float(log_det), float(np.sqrt(sigma2))


def _along_modes(view: ViewResidual, intrinsics: Array) -> tuple[Array, Array]:
    """(k,) squared lengths of the turned modes; (k, 1 + p) errors and intrinsics along them."""
    squares, turned = np.linalg.eigh(view.modes.T @ view.modes)
    both = np.concatenate([view.errors[:, None], intrinsics], axis=1)
    return np.maximum(squares, 0.0), turned.T @ (view.modes.T @ both)


def robust_covariance(views: Sequence[ViewResidual], errors: CornerErrors) -> Array:
    """(p, p) covariance of the least-squares intrinsics for these errors; see the module.

    Without a shared part it is that of independent noise. Raises numpy's `LinAlgError` if the views
    do not determine the intrinsics.
    """
    H = sum((v.intrinsics.T @ v.intrinsics for v in views), np.zeros(()))
    inverse = covariance_of(H)
    if errors.shared_px == 0.0:
        return errors.noise_px**2 * inverse
    n = len(views)
    modelled, residual = np.zeros_like(inverse), np.zeros_like(inverse)
    for v in views:
        M, shared = v.intrinsics, v.intrinsics.T @ v.modes
        modelled += errors.noise_px**2 * M.T @ M + errors.shared_px**2 * shared @ shared.T
        g = M.T @ _inflated(v, inverse)
        residual += np.outer(g, g)
    share = n / (n + MODEL_VIEWS)
    middle = share * residual + (1 - share) * modelled
    return (n + 1) / (n - 1) * inverse @ middle @ inverse


def _inflated(view: ViewResidual, inverse: Array) -> Array:
    """Residuals of the size they had before the fit took its part: (I - M H^-1 M^T)^-1/2 e.

    Only the few directions of M are changed: with the thin QR M = Q R, the matrix is I - Q K Q^T.
    """
    Q, R = np.linalg.qr(view.intrinsics)
    values, vectors = np.linalg.eigh(R @ inverse @ R.T)
    kept = 1.0 / np.sqrt(np.clip(1.0 - values, 1e-6, None)) - 1.0
    along = vectors.T @ (Q.T @ view.errors)
    return view.errors + Q @ (vectors @ (kept * along))

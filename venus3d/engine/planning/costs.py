"""Costs of candidate poses: one per name, all with the same interface.

`make_cost(...)` returns `cost(vectors (N, 6)) -> (N,)`, smaller is better, never negative. All but
"rms" come from the predicted covariance of the intrinsics (`Posterior.after`); "rms" runs a
calibration, which takes milliseconds a pose instead of microseconds. docs/costs.md derives them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import border_derivatives, projection_weight
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, rotations_of
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import COSTS, Cost

CostFunction = Callable[[Array], Array]


@dataclass(frozen=True)
class PoseCost:
    """A cost of pose vectors (N, 6) with a faster approximation."""

    exact: CostFunction
    rough: CostFunction
    """From two dozen points of the board instead of all corners (`board_nodes`): good to a fraction
    of a per cent, in three quarters of the time for the default board's 40 corners, a third for
    130.
    """

    def __call__(self, vectors: Array) -> Array:
        """(N,)"""
        return self.exact(vectors)


def make_cost(
    name: Cost,
    posterior: Posterior,
    *,
    observations: Sequence[Observation] = (),
    rng: np.random.Generator | None = None,
) -> CostFunction:
    """The cost `name` of one more view, after those of the `posterior`.

    Args:
        observations, rng: the views so far and a source of noise; only "rms" needs them.

    All but "rms" are a `PoseCost`. Raises `VenusError` for an unknown name and for "rms" without
    observations.
    """
    if name == "rms":
        return _rms_cost(posterior, observations, rng)
    if name not in COSTS:
        raise VenusError(f"There is no cost {name!r}; use one of {', '.join(COSTS)}.")
    value_of = _of_covariance(name, posterior.camera)
    return PoseCost(
        lambda vectors: value_of(posterior.after(vectors)),
        lambda vectors: value_of(posterior.after(vectors, rough=True)),
    )


def with_surcharge(cost: CostFunction, share: CostFunction) -> CostFunction:
    """The cost times one plus each vector's share; keeps a faster approximation."""
    return PoseCost(
        lambda vectors: cost(vectors) * (1 + share(vectors)),
        lambda vectors: rough_of(cost)(vectors) * (1 + share(vectors)),
    )


def rough_of(cost: CostFunction) -> CostFunction:
    """The faster approximation for ranking; the cost itself if it has none."""
    return cost.rough if isinstance(cost, PoseCost) else cost


def dispersion_scale(camera: Camera) -> Array:
    """(p,) divisor of a variance in eq. (13): |value|, or 1 where the value is exactly 0."""
    values = np.abs(camera.parameters)
    return np.where(values == 0, 1.0, values)


def index_of_dispersion(camera: Camera, covariance: ArrayLike) -> Array:
    """Eq. (13), (p,): variance over |value| of each parameter."""
    return np.diag(np.asarray(covariance, dtype=np.float64)) / dispersion_scale(camera)


def expected_distance(covariance: ArrayLike) -> Array:
    """(...,) mean length of a zero-mean Gaussian vector of covariance (..., 2, 2).

    With the larger variance a and the smaller b it is `sqrt(2 a / pi) E(1 - b / a)`, E the complete
    elliptic integral of the second kind of parameter m: the length `sqrt(a cos^2 + b sin^2)` of
    each direction, averaged over directions, times the mean `sqrt(pi / 2)` of a Rayleigh variable.
    """
    c = np.asarray(covariance, dtype=np.float64)
    xx, yy, xy = c[..., 0, 0], c[..., 1, 1], c[..., 0, 1]
    middle, half = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    large = middle + half
    with np.errstate(invalid="ignore", divide="ignore"):
        flatness = np.nan_to_num(np.clip(2 * half / large, 0.0, 1.0))
    return np.sqrt(2 / np.pi * large) * ellipe(flatness)


def _of_covariance(name: Cost, camera: Camera) -> CostFunction:
    """The cost as a function of covariances (N, p, p), to values (N,)."""
    if name in ("sum-iod", "max-iod"):
        over = dispersion_scale(camera)
        total = np.sum if name == "sum-iod" else np.max
        return lambda C: np.asarray(total(np.einsum("nii->ni", C) / over, axis=1))
    if name == "max-ere":
        moves = border_derivatives(camera)
        return lambda C: _largest_uncertainty(moves, C)
    weight = projection_weight(camera)
    if name == "projection-variance":
        return lambda C: C.reshape(len(C), -1) @ weight.ravel()
    # Mean squared pixels that one unit of a parameter moves over the image.
    px2 = np.diag(weight)
    if name == "trace":
        return lambda C: np.einsum("nii->ni", C) @ px2

    def mean_of_axes(C: Array) -> Array:
        return np.exp((np.linalg.slogdet(C)[1] + np.log(px2).sum()) / len(px2))

    return mean_of_axes


def _largest_uncertainty(moves: Array, covariances: Array) -> Array:
    """(N,) largest of the expected distances, pixels, over the rays of `border_derivatives`."""
    a, b = moves[:, 0], moves[:, 1]
    # Elements of every ray's 2 x 2 covariance as one product with the elements of C.
    pairs = np.stack([np.einsum("ki,kj->kij", p, q) for p, q in ((a, a), (a, b), (b, b))])
    elements = covariances.reshape(len(covariances), -1) @ pairs.reshape(-1, pairs[0, 0].size).T
    xx, xy, yy = np.split(elements, 3, axis=1)
    pixel = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
    return np.max(expected_distance(pixel), axis=1)


def _rms_cost(
    posterior: Posterior, observations: Sequence[Observation], rng: np.random.Generator | None
) -> CostFunction:
    """RmsErr: the rms over all views of a calibration that includes the candidate."""
    from venus3d.engine.calibration.adjustment import calibrate

    if not observations:
        raise VenusError("The cost rms calibrates really and needs the views captured so far.")
    board, camera = posterior.board, posterior.camera
    # One draw of noise for all candidates, or the search would select lucky noise.
    noise = (rng or np.random.default_rng(0)).normal(0, posterior.sigma_px, (board.corner_count, 2))
    ids = np.arange(board.corner_count)

    def rms(vectors: Array) -> Array:
        p = np.atleast_2d(vectors)
        pixels = camera.project_board(board.corners, rotations_of(p), p[:, 3:]) + noise
        costs = np.full(len(p), np.inf)
        for i, corners in enumerate(pixels):
            view = Observation(ids, corners, camera.image_size)
            try:
                costs[i] = calibrate(board, [*observations, view], start=camera).rms_px
            except CalibrationError:
                continue
        return costs

    return rms

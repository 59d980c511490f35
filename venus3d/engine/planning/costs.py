"""What a candidate pose is worth: one cost per name, all with the same interface.

`make_cost(...)` returns `cost(vectors (N, 6)) -> (N,)`, smaller is better, never negative. All but
"rms" come from the predicted covariance `sigma^2 (I + I_view)^-1` of the nine intrinsics (see
`information`); "rms" really calibrates, which takes milliseconds a pose instead of microseconds.
docs/costs.md derives each and says when it misleads.

Which pose to try next is `search`'s business, what is left of an error after the best turn
`projection_error`'s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ellipe

from venus3d.engine.calibration.corner_noise import NoiseModel
from venus3d.engine.calibration.information import normal_matrices
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import (
    GRID,
    border_moves,
    grid_pixels,
    projection_diff_px,
    projection_uncertainty_px,
    projection_weight,
)
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, rotations_of
from venus3d.engine.geometry.quadrature import board_nodes
from venus3d.engine.planning.method import COSTS, Cost

# What is told in pixels lives in `projection_error`; it is part of what a cost is about.
__all__ = [
    "GRID",
    "CostFunction",
    "PoseCost",
    "dispersion_scale",
    "expected_distance",
    "grid_pixels",
    "index_of_dispersion",
    "make_cost",
    "predicted_covariance",
    "projection_diff_px",
    "projection_uncertainty_px",
    "projection_weight",
    "rough_of",
    "with_surcharge",
]

_CHUNK = 512  # poses at a time: their Jacobians should stay in the processor's cache
CostFunction = Callable[[Array], Array]


@dataclass(frozen=True)
class PoseCost:
    """A cost of pose vectors (N, 6) that has a quicker one beside it."""

    exact: CostFunction
    rough: CostFunction
    """Of two dozen points of the board instead of all corners: three quarters of the time for the
    default board's 40, a third for 130, and good to a fraction of a per cent (`quadrature`)."""

    def __call__(self, vectors: Array) -> Array:
        """(N,)"""
        return self.exact(vectors)


def make_cost(
    name: Cost,
    *,
    board: Board,
    camera: Camera,
    information: ArrayLike,
    sigma_px: float = 1.0,
    observations: Sequence[Observation] = (),
    rng: np.random.Generator | None = None,
    noise: NoiseModel | None = None,
) -> CostFunction:
    """The cost of that name.

    Args:
        information: (9, 9) what the views so far say, for corner noise of one pixel.
        sigma_px: standard deviation of a corner coordinate, pixels.
        observations, rng: the views so far and a source of noise; only "rms" needs them.
        noise: how noise and found corners depend on the pose; None: they do not.

    All but "rms" are a `PoseCost`, with a quicker cost to rank by.

    Raises `VenusError` for an unknown name and for "rms" without observations.
    """
    if name == "rms":
        return _rms_cost(board, camera, sigma_px, observations, rng)
    if name not in COSTS:
        raise VenusError(f"There is no cost {name!r}; use one of {', '.join(COSTS)}.")
    value_of = _of_covariance(name, camera)

    def cost(vectors: Array, rough: bool = False) -> Array:
        covariance = predicted_covariance(
            board, camera, information, vectors, noise=noise, rough=rough
        )
        return value_of(sigma_px**2 * covariance)

    return PoseCost(cost, lambda vectors: cost(vectors, rough=True))


def with_surcharge(cost: CostFunction, share: CostFunction) -> CostFunction:
    """The cost times one plus the share of each vector; quicker to rank by if the cost is."""
    return PoseCost(
        lambda vectors: cost(vectors) * (1 + share(vectors)),
        lambda vectors: rough_of(cost)(vectors) * (1 + share(vectors)),
    )


def rough_of(cost: CostFunction) -> CostFunction:
    """The quicker cost to rank poses by; the cost itself if it has none."""
    return cost.rough if isinstance(cost, PoseCost) else cost


def predicted_covariance(
    board: Board,
    camera: Camera,
    information: ArrayLike,
    vectors: ArrayLike,
    *,
    noise: NoiseModel | None = None,
    rough: bool = False,
) -> Array:
    """Covariance (N, 9, 9) of the intrinsics after one more view, for each pose vector (N, 6).

    For corner noise of one pixel; the whole board is seen. With a noise model the view counts for
    as much as the noise and the corners found under that pose let it.

    The normal matrix of the view's pose and the intrinsics, with what is known of the latter added,
    is `L L^T`. The pose stands first, so the lower right block of L is the root of the marginal
    information: one Cholesky factor does what the Schur complement and a second one would do.

    Raises numpy's `LinAlgError` if all together leave some parameter undetermined.
    """
    p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
    known = np.asarray(information, dtype=np.float64)
    points, weights = board_nodes(board) if rough else (board.corners, None)
    covariances = np.empty((len(p), 9, 9))
    for first in range(0, len(p), _CHUNK):
        part = p[first : first + _CHUNK]
        normal = normal_matrices(camera, points, rotations_of(part), part[:, 3:], weights)
        if noise is not None:
            normal *= noise.weight(camera, board, part)[:, None, None]
        normal[:, 6:, 6:] += known
        root = np.linalg.inv(np.linalg.cholesky(normal)[:, 6:, 6:])
        np.matmul(np.swapaxes(root, 1, 2), root, out=covariances[first : first + _CHUNK])
    return covariances


def dispersion_scale(camera: Camera) -> Array:
    """(9,) what eq. (13) divides a variance by: |value|, and 1 where the value is exactly 0."""
    values = np.abs(camera.parameters)
    return np.where(values == 0, 1.0, values)


def index_of_dispersion(camera: Camera, covariance: ArrayLike) -> Array:
    """Eq. (13), (9,): variance over |value| of each parameter."""
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
    """From covariances (N, 9, 9) to values (N,)."""
    if name in ("sum-iod", "max-iod"):
        over = dispersion_scale(camera)
        total = np.sum if name == "sum-iod" else np.max
        return lambda C: np.asarray(total(np.einsum("nii->ni", C) / over, axis=1))
    if name == "max-ere":
        moves = border_moves(camera)
        return lambda C: _largest_expected_error(moves, C)
    weight = projection_weight(camera)
    if name == "projection-variance":
        return lambda C: C.reshape(-1, 81) @ weight.ravel()
    # The pixels that a parameter moves on average in the image, squared, for one unit of it.
    px2 = np.diag(weight)
    if name == "trace":
        return lambda C: np.einsum("nii->ni", C) @ px2

    def mean_of_axes(C: Array) -> Array:
        return np.exp((np.linalg.slogdet(C)[1] + np.log(px2).sum()) / 9)

    return mean_of_axes


def _largest_expected_error(moves: Array, covariances: Array) -> Array:
    """(N,) largest of the expected distances, pixels, over the rays of `border_moves`."""
    a, b = moves[:, 0], moves[:, 1]
    # Elements of every ray's 2 x 2 covariance as one product with the 81 elements of C.
    pairs = np.stack([np.einsum("ki,kj->kij", p, q) for p, q in ((a, a), (a, b), (b, b))])
    elements = covariances.reshape(-1, 81) @ pairs.reshape(-1, 81).T
    xx, xy, yy = np.split(elements, 3, axis=1)
    pixel = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], -2)
    return np.max(expected_distance(pixel), axis=1)


def _rms_cost(
    board: Board,
    camera: Camera,
    sigma_px: float,
    observations: Sequence[Observation],
    rng: np.random.Generator | None,
) -> CostFunction:
    """RmsErr: the rms over all views of a real calibration that includes the candidate."""
    from venus3d.engine.calibration.adjustment import calibrate

    if not observations:
        raise VenusError("The cost rms calibrates really and needs the views captured so far.")
    # One draw of noise for all candidates, or the search would hunt for lucky noise.
    noise = (rng or np.random.default_rng(0)).normal(0, sigma_px, (board.corner_count, 2))
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

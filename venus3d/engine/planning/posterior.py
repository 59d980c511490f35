"""The posterior of the intrinsics after some views, and after one more.
Made once per calibration for all planning: targets, alternatives, forecast, usefulness of a
view."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.corner_noise import RENDERED, NoiseModel
from venus3d.engine.calibration.information import (
    covariance_of,
    information_of,
    normal_matrices,
    prior_information,
    shared_share,
)
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera, planning_camera
from venus3d.engine.geometry.pose import Array, Pose, rotations_of

LEAST_SIGMA_PX = 0.01
"""Lower bound of the corner noise, so that predictions stay finite if residuals vanish."""
_CHUNK = 512  # poses at a time: their Jacobians should fit into the processor's cache
NODES = (6, 4)
"""Number of nodes along the longer and the shorter side of the board."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """The information gathered so far, with the camera to plan with."""

    board: Board
    camera: Camera
    information: Array
    """(p, p) for corner noise of one pixel; never singular."""
    sigma_px: float = 1.0
    """Standard deviation of a corner coordinate, pixels."""
    noise: NoiseModel | None = None
    """How noise and found corners depend on the pose; None: they do not."""
    settled: bool = True
    """Whether the views alone determine the camera; otherwise a wide prior is included."""
    shared_ratio: float = 0.0
    """Error that a view's corners share over their independent noise (`CornerErrors.ratio`)."""

    @classmethod
    def of(
        cls,
        board: Board,
        camera: Camera,
        information: ArrayLike,
        sigma_px: float,
        noise: NoiseModel | None = None,
        shared_ratio: float = 0.0,
        known: Array | None = None,
    ) -> Posterior:
        """The posterior after views of this `information`, (p, p).
        While the views alone contain less, `prior_information` is added, and what is `known` from
        before: (p, p) inverse of a covariance."""
        gathered = np.asarray(information, dtype=np.float64)
        prior = prior_information(camera, sigma_px)
        settled = _settled(gathered, prior, sigma_px)
        if not settled:
            gathered = gathered + prior + (0 if known is None else sigma_px**2 * known)
        return cls(board, planning_camera(camera), gathered, sigma_px, noise, settled, shared_ratio)

    @classmethod
    def of_calibration(
        cls,
        calibration: Calibration,
        noise: NoiseModel | None = RENDERED,
        known: Array | None = None,
    ) -> Posterior:
        """The posterior after a calibration's views; the noise model is made relative to them.
        `known`: see `of`."""
        c = calibration
        if noise is not None:
            vectors = np.array([view.pose.vector() for view in c.views])
            noise = noise.relative_to(c.camera, c.board, vectors)
        errors = c.corner_errors
        sigma, ratio = max(errors.noise_px, LEAST_SIGMA_PX), errors.ratio
        if c.knows_less_than_views:
            # The covariance has what no sum of the views' informations shows.
            information = covariance_of(c.covariance / errors.noise_px**2)
        else:
            seen = [information_of(c.camera, c.board, v.observation, v.pose) for v in c.views]
            information = np.sum(seen, axis=0)
        return cls.of(c.board, c.camera, information, sigma, noise, ratio, known)

    @cached_property
    def covariance(self) -> Array:
        """(p, p) current covariance of the intrinsics."""
        return covariance_of(self.information, self.sigma_px)

    @cached_property
    def uncertainty_px(self) -> float:
        """Current projection uncertainty: rms over the image, pixels, the prior included."""
        return projection_uncertainty_px(self.camera, self.covariance)

    def after(self, vectors: ArrayLike, *, rough: bool = False) -> Array:
        """(N, p, p) covariances after one more view of the whole board under pose vectors (N, 6).

        A noise model weighs the view by the noise and the corners found. `rough` takes two dozen
        points of the board instead of all corners (`board_nodes`): good to a fraction of a per
        cent.

        The normal matrix of pose and intrinsics, with the information on the latter added, is `L
        L^T`. As the pose comes first, the lower right block of L is the root of the marginal
        information: one Cholesky factor replaces the Schur complement and a second one.

        Raises numpy's `LinAlgError` if a parameter is undetermined.
        """
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        points, weights = board_nodes(self.board) if rough else (self.board.corners, None)
        shared = shared_share(self.board, points, self.shared_ratio, weights)
        covariances = np.empty((len(p), *self.information.shape))
        for first in range(0, len(p), _CHUNK):
            part = p[first : first + _CHUNK]
            R, t = rotations_of(part), part[:, 3:]
            normal = normal_matrices(self.camera, points, R, t, weights, shared)
            if self.noise is not None:
                normal *= self.noise.weight(self.camera, self.board, part)[:, None, None]
            normal[:, 6:, 6:] += self.information
            root = np.linalg.inv(np.linalg.cholesky(normal)[:, 6:, 6:])
            np.matmul(np.swapaxes(root, 1, 2), root, out=covariances[first : first + _CHUNK])
        return self.sigma_px**2 * covariances

    def with_view(self, vector: ArrayLike) -> Posterior:
        """The posterior after a view under the pose vector (6,)."""
        # The inverse of a covariance is its information.
        after = covariance_of(self.after(vector)[0] / self.sigma_px**2)
        return replace(self, information=after)

    def with_observation(self, observation: Observation, pose: Pose) -> Posterior:
        """The posterior after this observation is taken as a view, under its pose."""
        added = information_of(self.camera, self.board, observation, pose, self.shared_ratio)
        return replace(self, information=self.information + added)


def _settled(information: Array, prior: Array, sigma_px: float) -> bool:
    """Whether the views alone determine each parameter better than the prior does."""
    with np.errstate(all="ignore"):
        try:
            variance = np.diag(covariance_of(information, sigma_px))
        except np.linalg.LinAlgError:
            return False
    # A negative or zero variance: the information is singular but for rounding.
    return bool((variance > 0).all() and (variance < sigma_px**2 / np.diag(prior)).all())


@lru_cache(maxsize=8)
def board_nodes(board: Board) -> tuple[Array, Array]:
    """(K, 3) nodes on the board, metres, and (K,) weights that add up to the number of corners.

    A view's information is a sum over the corners of functions that are smooth over the board.
    Along each direction the corners are equally spaced, and such sums have Gauss rules as integrals
    do: n weighted nodes give the sum of any polynomial of degree 2n - 1 exactly (Golub and Welsch
    1969).

    On the default board 24 nodes replace 40 corners: over 1000 poses the projection variance is
    0.05 % off (rms; 0.6 % at worst) with one view known, 0.01 % with three, less with more.
    """
    across, down = board.lattice.max(axis=0) + 1
    long, short = NODES
    x, wx = _gauss(across, long if across >= down else short)
    y, wy = _gauss(down, short if across >= down else long)
    nodes = np.zeros((len(x) * len(y), 3))
    nodes[:, 0], nodes[:, 1] = np.tile(x, len(y)), np.repeat(y, len(x))
    step = np.round(np.ptp(board.of_kind.points(board), axis=0) / board.square, 9) * board.square
    nodes[:, :2] *= step / (np.array([across, down]) - 1)
    weights = np.outer(wy, wx).ravel() * (board.corner_count / (across * down))
    return nodes, np.asarray(weights, dtype=np.float64)


def _gauss(count: int, nodes: int) -> tuple[Array, Array]:
    """Nodes and weights for a sum over `count` points with unit spacing, centred at 0.

    The nodes are the eigenvalues of the Jacobi matrix of the points' orthogonal polynomials (Gram's
    discrete Chebyshev polynomials); the weights come from its eigenvectors' first components.
    """
    nodes = min(nodes, count)
    k = np.arange(1, nodes)
    beside = np.sqrt(k**2 * (count**2 - k**2) / (4 * (4 * k**2 - 1)))
    values, vectors = np.linalg.eigh(np.diag(beside, 1) + np.diag(beside, -1))
    return np.asarray(values), np.asarray(count * vectors[0] ** 2, dtype=np.float64)

"""Bundle adjustment: Levenberg-Marquardt over all views, with the poses eliminated.

One system for the intrinsics, the shape of the board and the poses of all views. Each pose touches
its own view only, so the normal equations are an arrow of 6 x 6 blocks, and the Schur complement
leaves a system as small as the shared parameters (Triggs et al. 2000, "Bundle Adjustment", 6.1):

    [ A_v  C_v ] [pose_v]   [a_v]          S = H - sum C_v^T A_v^-1 C_v
    [ C_v^T  H ] [shared] = [ g ]          S shared = g - sum C_v^T A_v^-1 a_v

S at the optimum is the information of the shared parameters: sigma^2 S^-1 is their covariance.
`scipy.optimize.least_squares` is thirty times slower: it has no arrow-shaped solver.

Damped steps creep along a valley that bends, as that of a principal point far from the middle,
which the lens and the poses make up for. So they follow its curvature (geodesic acceleration:
Transtrum and Sethna 2012, "Improvements to the Levenberg-Marquardt algorithm").
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose

_ITERATIONS = 400
_CONVERGED, _ROUNDING = 1e-12, 4e-15
"""A step ends the search if its squared length, in standard deviations, is smaller (1e-6 sigma, and
what is left after it is far less), or its share of the cost, which is then rounding."""
_EXACT_PX2 = 1e-20
"""Least variance of a coordinate, squared pixels: ends the search on corners without noise."""
_DAMPING, _LEAST_DAMPING, _LARGEST_DAMPING = 1e-6, 1e-12, 1e8
_PROBE = 0.1
"""Share of a step over which the curvature is measured."""
_MOST_BENT = 0.75
"""The curvature's share of a step; if it is more, nothing is known so far away."""


@dataclass(frozen=True, eq=False)
class Corners:
    """Corners of N views, each padded to M with copies of weight 0."""

    points: Array
    """(N, M, 3) on the board, metres."""
    pixels: Array
    """(N, 2, M)."""
    weights: Array
    """(N, M) 1 for a corner, 0 for one that does not count."""

    @staticmethod
    def of(points: Sequence[Array], pixels: Sequence[Array]) -> Corners:
        """Of each view's board points (n, 3) and pixels (n, 2)."""
        most = max(len(p) for p in points)
        index = [np.arange(most) % len(p) for p in points]
        return Corners(
            np.stack([p[i] for p, i in zip(points, index, strict=True)]),
            np.stack([p[i].T for p, i in zip(pixels, index, strict=True)]),
            np.stack([np.arange(most) < len(p) for p in points]).astype(np.float64),
        )


@dataclass(frozen=True, eq=False)
class Parameters:
    """A camera, the board's shape and a pose for each view."""

    camera: Camera
    shape: Array
    """(K,) factors of the deformations; see `Problem`."""
    R: Array
    """(N, 3, 3) of `T_camera_board`."""
    t: Array
    """(N, 3)."""

    @property
    def poses(self) -> list[Pose]:
        """The views' poses."""
        return [Pose(R, t) for R, t in zip(self.R, self.t, strict=True)]


@dataclass(frozen=True, eq=False)
class Problem:
    """What is adjusted, and to what."""

    corners: Corners
    basis: Array
    """(p + K, q) the q adjusted parameters' effect on the camera's p and the board's K: fixed ones
    are zero rows, shared ones (fx = fy) rows alike."""
    deformations: Array = field(default_factory=lambda: np.zeros((0, 1, 1, 3)))
    """(K, N, M, 3) displacement of each board point by a unit of each shape parameter."""
    prior: Array = field(default_factory=lambda: np.zeros(0))
    """(K,) weight of the squared shape parameters, squared pixels: (noise / prior sigma)^2."""
    outlier_px: float = np.inf
    """Distance from which a corner counts by its distance only, not by its square (Huber)."""


@dataclass(frozen=True, eq=False)
class Solution:
    """The optimum of a `Problem`."""

    parameters: Parameters
    cost: float
    """Sum of squared reprojection errors (beyond `outlier_px`: Huber's) and of the prior, px^2."""
    information: Array
    """(q, q) of the adjusted parameters for a noise of one pixel, poses eliminated."""
    errors: Array
    """(N, 2, M) observed minus projected corners, pixels."""
    converged: bool


def adjust(problem: Problem, start: Parameters, iterations: int = _ITERATIONS) -> Solution:
    """The parameters with the least cost near `start`.

    Raises:
        CalibrationError: a corner is behind the lens, or the views do not determine a parameter.
    """
    now, errors = start, _errors(problem, start)
    if errors is None:
        raise CalibrationError("The start of the calibration puts the board behind the lens.")
    cost, damping, converged = _cost(problem, now, errors), _DAMPING, False
    freedom = max(2 * problem.corners.weights.sum() - 6 * len(now.R) - problem.basis.shape[1], 1)
    system = _System(problem, now, errors)
    for _ in range(iterations):
        shared, poses, length = system.step(damping)
        if damping > _DAMPING:
            probe = _moved(problem, now, _PROBE * shared, _PROBE * poses)
            if probe is not None:
                shared, poses = system.bent(damping, shared, poses, errors - probe[1])
        trial = _moved(problem, now, shared, poses)
        least = max(_CONVERGED * max(cost / freedom, _EXACT_PX2), _ROUNDING * cost)
        converged = trial is not None and damping <= _DAMPING and length < least
        if trial is None or not (converged or _cost(problem, *trial) < cost):
            damping *= 10
            if damping > _LARGEST_DAMPING:
                break
            continue
        now, errors = trial
        cost, damping = _cost(problem, now, errors), max(damping / 10, _LEAST_DAMPING)
        if converged:
            break
        system = _System(problem, now, errors)
    return Solution(now, cost, system.information(), errors, converged)


class _System:
    """The normal equations at one place."""

    def __init__(self, problem: Problem, at: Parameters, errors: Array) -> None:
        J = _jacobians(problem, at)
        weights = np.sqrt(_weights(problem, errors))[:, None]
        rows = np.ascontiguousarray(J * weights[:, None]).reshape(*J.shape[:2], -1)
        right = (errors * weights).reshape(len(rows), -1, 1)
        by_pose, shared = rows[:, :6], np.matmul(problem.basis.T, rows[:, 6:])
        self._A = by_pose @ by_pose.swapaxes(1, 2)
        self._C = by_pose @ shared.swapaxes(1, 2)
        self._a = by_pose @ right
        by_shape = problem.basis[len(problem.basis) - len(problem.prior) :]
        prior = problem.prior[:, None] * by_shape
        self._H = (shared @ shared.swapaxes(1, 2)).sum(axis=0) + by_shape.T @ prior
        self._g = (shared @ right).sum(axis=0) - prior.T @ at.shape[:, None]
        self._scale = 1.0 / np.sqrt(np.maximum(np.diag(self._H), 1e-300))
        self._by_pose, self._by_shared, self._weights = by_pose, shared, weights

    def step(self, damping: float) -> tuple[Array, Array, float]:
        """Changes of the q shared parameters and of the poses (N, 6), and the step's squared length
        in pixels."""
        A = self._A.copy()
        diagonal = np.einsum("nii->ni", A)
        diagonal *= 1 + damping
        Y = _solved(A, np.concatenate([self._C, self._a], axis=2))
        S = self._H - (self._C.swapaxes(1, 2) @ Y[:, :, :-1]).sum(axis=0)
        S.flat[:: len(S) + 1] += damping * self._H.flat[:: len(S) + 1]
        right = self._g - (self._C.swapaxes(1, 2) @ Y[:, :, -1:]).sum(axis=0)
        scale = self._scale[:, None]
        shared = scale * _solved(S * scale * scale.T, scale * right)
        poses = Y[:, :, -1:] - Y[:, :, :-1] @ shared
        length = float((shared * self._g).sum() + (poses * self._a).sum())
        return shared[:, 0], poses[:, :, 0], length

    def bent(
        self, damping: float, shared: Array, poses: Array, moved: Array
    ) -> tuple[Array, Array]:
        """A step (of `step`) that follows the curvature: `moved` (N, 2, M) are the pixels by which
        the corners move with `_PROBE` of it."""
        straight = (poses[:, None] @ self._by_pose)[:, 0]
        straight += np.tensordot(self._by_shared, shared, ([1], [0]))
        weighed = (moved * self._weights).reshape(straight.shape)
        curvature = (2 / _PROBE**2) * (weighed - _PROBE * straight)[:, :, None]
        other = copy(self)
        other._a = -self._by_pose @ curvature
        other._g = -(self._by_shared @ curvature).sum(axis=0)
        more, turns, _ = other.step(damping)
        most = _MOST_BENT * np.linalg.norm(shared / self._scale)
        if not np.linalg.norm(more / self._scale) < most:
            return shared, poses
        return shared + more / 2, poses + turns / 2

    def information(self) -> Array:
        """(q, q) Schur complement S."""
        S = self._H - (self._C.swapaxes(1, 2) @ _solved(self._A, self._C)).sum(axis=0)
        return 0.5 * (S + S.T)


def derivatives(problem: Problem, at: Parameters) -> Array:
    """(N, 6 + q, 2, M) derivatives of the pixels by each view's pose and the shared parameters."""
    J = _jacobians(problem, at)
    shared = np.einsum("pq,npum->nqum", problem.basis, J[:, 6:])
    return np.concatenate([J[:, :6], shared], axis=1)


def one_step(problem: Problem, solution: Solution) -> tuple[Array, Array]:
    """(q,) change of the shared parameters by one Gauss-Newton step from a solution, and their
    (q, q) information there: what parameters would do that the solution held fixed."""
    system = _System(problem, solution.parameters, solution.errors)
    return system.step(0.0)[0], system.information()


def _jacobians(problem: Problem, at: Parameters) -> Array:
    J = at.camera.jacobians(_points(problem, at.shape), at.R, at.t)
    if not len(problem.deformations):
        return J
    return np.concatenate([J, _by_shape(problem, at, J[:, 3:6])], axis=1)


def _solved(matrix: Array, right: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError as error:
        raise CalibrationError("The views do not determine the camera.") from error


def _points(problem: Problem, shape: Array) -> Array:
    if not len(shape):
        return problem.corners.points
    return problem.corners.points + np.tensordot(shape, problem.deformations, 1)


def _by_shape(problem: Problem, at: Parameters, by_point: Array) -> Array:
    """(N, K, 2, M) derivatives by the shape, from those by the points in the camera's frame."""
    turned = np.einsum("nij,knmj->nkim", at.R, problem.deformations)
    return np.einsum("nium,nkim->nkum", by_point, turned)


def _errors(problem: Problem, at: Parameters) -> Array | None:
    """(N, 2, M) observed minus projected; None with a point behind the lens."""
    xyz = at.R @ _points(problem, at.shape).swapaxes(1, 2) + at.t[:, :, None]
    if at.camera.lens.is_perspective and not xyz[:, 2].min() > 0:
        return None
    pixels = at.camera.pixels_of(xyz.swapaxes(0, 1))
    errors = problem.corners.pixels - pixels.swapaxes(0, 1)
    return errors if np.isfinite(errors).all() else None


def _cost(problem: Problem, at: Parameters, errors: Array) -> float:
    squares = (errors**2).sum(axis=1)
    if np.isfinite(problem.outlier_px):
        k = problem.outlier_px
        squares = np.where(squares < k * k, squares, 2 * k * np.sqrt(squares) - k * k)
    return float((problem.corners.weights * squares).sum() + problem.prior @ at.shape**2)


def _weights(problem: Problem, errors: Array) -> Array:
    if not np.isfinite(problem.outlier_px):
        return problem.corners.weights
    distance = np.maximum(np.sqrt((errors**2).sum(axis=1)), 1e-12)
    return problem.corners.weights * np.minimum(1.0, problem.outlier_px / distance)


def _moved(
    problem: Problem, at: Parameters, shared: Array, poses: Array
) -> tuple[Parameters, Array] | None:
    """The parameters after a step, and their errors; None if that is no camera, or a corner is
    behind it."""
    change = problem.basis @ shared
    p = len(change) - len(at.shape)
    try:
        camera = Camera.from_parameters(
            at.camera.parameters + change[:p], at.camera.image_size, at.camera.lens
        )
    except CalibrationError:
        return None
    turns = np.asarray(Rotation.from_rotvec(poses[:, :3]).as_matrix(), dtype=np.float64)
    moved = Parameters(camera, at.shape + change[p:], turns @ at.R, at.t + poses[:, 3:])
    errors = _errors(problem, moved)
    return None if errors is None else (moved, errors)

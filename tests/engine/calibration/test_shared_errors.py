"""The covariance that remains right when a view's corners share an error: against Monte Carlo,
textbook formulas with full matrices, and the likelihood of scipy's multivariate normal."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import block_diag, sqrtm
from scipy.stats import multivariate_normal

from venus3d.engine.calibration.information import (
    shared_modes,
    shared_share,
    view_information,
)
from venus3d.engine.calibration.shared_errors import (
    MODEL_VIEWS,
    CornerErrors,
    ViewResidual,
    _Likelihood,
    corner_errors,
    robust_covariance,
)
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Array, Pose

BOARD = Board()
SIGMA = 0.1


def poses_of(count: int, rng: np.random.Generator) -> list[Pose]:
    """Tilted views in the image."""
    found: list[Pose] = []
    while len(found) < count:
        rotation = rng.uniform(-0.7, 0.7, 3)
        place = rng.uniform([-0.08, -0.05, 0.3], [0.08, 0.05, 0.45])
        pose = Pose.from_rvec_tvec(rotation, place)
        pixels = PAPER_CAMERA.project(pose.apply(BOARD.corners))
        if (pixels > 5).all() and (pixels < [1275, 715]).all():
            found.append(pose)
    return found


def jacobian_of(pose: Pose) -> Array:
    """(2M, 15), the six of the pose first."""
    J = PAPER_CAMERA.jacobians(BOARD.corners, pose.R[None], pose.t[None])[0]
    return J.reshape(15, -1).T


def all_unknowns(poses: list[Pose]) -> Array:
    """(2MN, 6N + 9) derivatives by all poses and the intrinsics."""
    stacked = [jacobian_of(pose) for pose in poses]
    return np.hstack(
        [block_diag(*(s[:, :6] for s in stacked)), np.vstack([s[:, 6:] for s in stacked])]
    )


def residuals_of(
    poses: list[Pose], shared_px: float, rng: np.random.Generator
) -> tuple[list[ViewResidual], Array]:
    """Residuals of a linear least-squares fit to drawn errors, and the error of its intrinsics."""
    T = np.kron(np.eye(2), shared_modes(BOARD, BOARD.corners))
    drawn = np.concatenate(
        [rng.normal(0, SIGMA, T.shape[0]) + T @ rng.normal(0, shared_px, T.shape[1]) for _ in poses]
    )
    full = all_unknowns(poses)
    scale = 1 / np.linalg.norm(full, axis=0)
    solution = np.linalg.lstsq(full * scale, drawn, rcond=None)[0] * scale
    views = [
        ViewResidual.of(
            BOARD,
            BOARD.corners,
            left.reshape(2, -1),
            PAPER_CAMERA.jacobians(BOARD.corners, pose.R[None], pose.t[None])[0],
        )
        for pose, left in zip(poses, np.split(drawn - full @ solution, len(poses)), strict=True)
    ]
    return views, solution[-9:]


def test_modes_have_unit_rms_and_share_is_woodbury() -> None:
    T = shared_modes(BOARD, BOARD.corners)
    assert T.shape == (40, 10)
    assert np.sqrt((T**2).mean(axis=0)) == pytest.approx(np.ones(10))
    C = shared_share(BOARD, BOARD.corners, 0.7)
    assert C is not None
    assert np.linalg.inv(np.eye(40) + 0.49 * T @ T.T) == pytest.approx(np.eye(40) - C @ C.T)
    assert shared_share(BOARD, BOARD.corners, 0.0) is None


def test_likelihood_is_that_of_the_multivariate_normal() -> None:
    """REML: the likelihood of the residuals in the space that pose and intrinsics leave."""
    rng = np.random.default_rng(3)
    shown = poses_of(4, rng)
    views, _ = residuals_of(shown, 0.05, rng)
    full = all_unknowns(shown)
    full /= np.linalg.norm(full, axis=0)
    rest = np.linalg.qr(full, mode="complete").Q[:, full.shape[1] :].T
    e = rest @ np.concatenate([v.errors for v in views])
    T = block_diag(*[np.kron(np.eye(2), shared_modes(BOARD, BOARD.corners))] * 4)

    def loss(ratio: float) -> float:
        shape = rest @ (np.eye(len(T)) + ratio**2 * T @ T.T) @ rest.T
        sigma2 = e @ np.linalg.solve(shape, e) / len(e)
        return -2 * multivariate_normal(cov=sigma2 * shape).logpdf(e)

    likelihood = _Likelihood(views)
    ours = [likelihood.at(ratio)[0] - likelihood.at(0.1)[0] for ratio in (0.0, 0.3, 1.0)]
    assert ours == pytest.approx([loss(ratio) - loss(0.1) for ratio in (0.0, 0.3, 1.0)], abs=1e-6)


def test_parts_are_found_and_independent_noise_stays_independent() -> None:
    rng = np.random.default_rng(0)
    poses = poses_of(12, rng)
    shared = [corner_errors(residuals_of(poses, 0.05, rng)[0]) for _ in range(20)]
    assert np.mean([e.noise_px for e in shared]) == pytest.approx(SIGMA, rel=0.02)
    assert np.mean([e.shared_px for e in shared]) == pytest.approx(0.05, rel=0.1)
    alone = [corner_errors(residuals_of(poses, 0.0, rng)[0]) for _ in range(40)]
    assert sum(e.shared_px > 0 for e in alone) <= 6
    assert np.mean([e.noise_px for e in alone]) == pytest.approx(SIGMA, rel=0.02)


def test_covariance_of_independent_noise_is_opencvs() -> None:
    rng = np.random.default_rng(1)
    views, _ = residuals_of(poses_of(6, rng), 0.0, rng)
    M = np.vstack([v.intrinsics for v in views])
    assert robust_covariance(views, CornerErrors(SIGMA)) == pytest.approx(
        SIGMA**2 * np.linalg.inv(M.T @ M), rel=1e-6
    )


def test_covariance_is_the_mixture_of_model_and_bell_and_mccaffreys() -> None:
    """CR2 with the full matrix (I - M H^-1 M^T)^(-1/2), as in Bell and McCaffrey (2002)."""
    rng = np.random.default_rng(2)
    views, _ = residuals_of(poses_of(6, rng), 0.05, rng)
    errors = CornerErrors(0.1, 0.05)
    M = np.vstack([v.intrinsics for v in views])
    inverse = np.linalg.inv(M.T @ M)
    residual, modelled = np.zeros((9, 9)), np.zeros((9, 9))
    for v in views:
        root = np.linalg.inv(
            np.real(sqrtm(np.eye(len(v.errors)) - v.intrinsics @ inverse @ v.intrinsics.T))
        )
        g = v.intrinsics.T @ root @ v.errors
        residual += np.outer(g, g)
        V = 0.01 * np.eye(len(v.errors)) + 0.0025 * v.modes @ v.modes.T
        modelled += v.intrinsics.T @ V @ v.intrinsics
    share = 6 / (6 + MODEL_VIEWS)
    expected = 7 / 5 * inverse @ (share * residual + (1 - share) * modelled) @ inverse
    got = robust_covariance(views, errors)
    scale = np.sqrt(np.diag(expected))
    assert got / np.outer(scale, scale) == pytest.approx(
        expected / np.outer(scale, scale), abs=1e-6
    )


def test_sigmas_are_right_where_corners_share_an_error() -> None:
    """Monte Carlo: of the estimates' errors 68 % and 95 % lie within 1 and 2 sigma; with the
    covariance of independent noise it would be far fewer."""
    rng = np.random.default_rng(5)
    z, promised_by_noise = [], []
    for _ in range(40):
        views, off = residuals_of(poses_of(8, rng), 0.06, rng)
        errors = corner_errors(views)
        z.append(off / np.sqrt(np.diag(robust_covariance(views, errors))))
        M = np.vstack([v.intrinsics for v in views])
        naive = np.std(np.concatenate([v.errors for v in views])) * np.sqrt(
            np.diag(np.linalg.inv(M.T @ M))
        )
        promised_by_noise.append(off / naive)
    assert 0.0 < np.mean(np.abs(z) > 2) < 0.07
    assert 0.6 < np.std(z) < 1.1
    assert np.mean(np.abs(promised_by_noise) > 2) > 0.2


def test_information_of_a_view_saturates() -> None:
    """The Schur complement of J^T V^-1 J with the full matrix V; many corners say no more than the
    shared error lets them."""
    pose = poses_of(1, np.random.default_rng(7))[0]
    J, T = jacobian_of(pose), np.kron(np.eye(2), shared_modes(BOARD, BOARD.corners))
    V = np.eye(len(J)) + 0.25 * T @ T.T
    normal = J.T @ np.linalg.solve(V, J)
    expected = normal[6:, 6:] - normal[6:, :6] @ np.linalg.solve(normal[:6, :6], normal[:6, 6:])
    R, t = pose.R[None], pose.t[None]
    shared = shared_share(BOARD, BOARD.corners, 0.5)
    got = view_information(PAPER_CAMERA, BOARD.corners, R, t, shared=shared)[0]
    scale = np.sqrt(np.diag(expected))
    assert got / np.outer(scale, scale) == pytest.approx(
        expected / np.outer(scale, scale), abs=1e-7
    )
    alone = view_information(PAPER_CAMERA, BOARD.corners, R, t)[0]
    assert (np.diag(got) < np.diag(alone)).all()

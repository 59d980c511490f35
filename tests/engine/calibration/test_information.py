"""The information of a view against really calibrating with it."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.engine.calibration.test_adjustment import GOOD, NOISE_PX, observe
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.information import (
    covariance_of,
    prior_information,
    view_information,
)
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose, rotations_of
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.posterior import Posterior, board_nodes

NEXT = [-15, 35, 45, 0.1, 0.05, 0.5]


def information_at(camera: Camera, board: Board, vectors: list[list[float]]) -> np.ndarray:
    """(9, 9), added up over views of which some show a part of the board only."""
    total = np.zeros((9, 9))
    for vector in vectors:
        pose = Pose.from_vector(vector)
        total += view_information(camera, board.corners, pose.R[None], pose.t[None])[0]
    return total


def test_marginal_information_is_the_block_of_the_full_inverse(
    paper_camera: Camera, default_board: Board
) -> None:
    """All unknowns at once, by OpenCV's Jacobians: the same covariance of the intrinsics."""
    J = np.zeros((len(GOOD) * 80, 9 + 6 * len(GOOD)))
    for index, vector in enumerate(GOOD):
        pose = Pose.from_vector(vector)
        _, full = cv2.projectPoints(
            default_board.corners, pose.rvec, pose.t, paper_camera.K, paper_camera.distortion
        )
        rows = slice(80 * index, 80 * index + 80)
        J[rows, :9] = np.asarray(full)[:, 6:15]
        J[rows, 9 + 6 * index : 15 + 6 * index] = np.asarray(full)[:, :6]
    scale = 1 / np.linalg.norm(J, axis=0)
    inverse = np.linalg.inv((J * scale).T @ (J * scale)) * np.outer(scale, scale)
    ours = covariance_of(information_at(paper_camera, default_board, GOOD))
    deviation = np.sqrt(np.diag(inverse[:9, :9]))
    np.testing.assert_allclose(
        ours / np.outer(deviation, deviation),
        inverse[:9, :9] / np.outer(deviation, deviation),
        atol=1e-6,
    )


def schur_by_opencv(camera: Camera, points: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """(9, 9) plain Schur complement of the Jacobians that `cv2.projectPoints` gives."""
    pose = Pose.from_vector(vector)
    _, full = cv2.projectPoints(points, pose.rvec, pose.t, camera.K, camera.distortion)
    J = np.asarray(full, dtype=np.float64)
    Je, Ji = J[:, :6], J[:, 6:15]
    # By the QR factor of the pose's columns: no normal matrix, so no digits lost.
    Q, _ = np.linalg.qr(Je)
    left = Ji - Q @ (Q.T @ Ji)
    return left.T @ left


def test_the_fast_information_is_the_plain_schur_complement(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    space = Space(default_board, paper_camera, Limits())
    vectors = np.array([random_pose(space, rng) for _ in range(40)])
    fast = view_information(
        paper_camera, default_board.corners, rotations_of(vectors), vectors[:, 3:]
    )
    for one, vector in zip(fast, vectors, strict=True):
        plain = schur_by_opencv(paper_camera, default_board.corners, vector)
        scale = np.sqrt(np.diag(plain))
        np.testing.assert_allclose(
            one / np.outer(scale, scale), plain / np.outer(scale, scale), atol=1e-7
        )


def test_the_predicted_covariance_is_that_of_the_plain_sum(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """One Cholesky factor against adding, scaling and inverting; more poses than a chunk."""
    space = Space(default_board, paper_camera, Limits())
    vectors = np.array([random_pose(space, rng) for _ in range(10)] * 60)
    known = information_at(paper_camera, default_board, GOOD)
    predicted = Posterior(default_board, paper_camera, known).after(vectors)
    for index in (*range(10), 511, 512, 599):
        plain = schur_by_opencv(paper_camera, default_board.corners, vectors[index])
        expected = covariance_of(known + plain)
        deviation = np.sqrt(np.diag(expected))
        np.testing.assert_allclose(
            predicted[index] / np.outer(deviation, deviation),
            expected / np.outer(deviation, deviation),
            atol=1e-7,
        )


@pytest.mark.parametrize(("columns", "rows"), [(9, 6), (6, 9), (4, 4), (14, 11)])
def test_few_nodes_stand_for_all_corners(
    columns: int, rows: int, paper_camera: Camera, rng: np.random.Generator
) -> None:
    """Sums of polynomials over the corners exactly; a view's information nearly."""
    board = Board(columns=columns, rows=rows)
    nodes, weights = board_nodes(board)
    assert len(nodes) <= 24
    x, y = (nodes[:, :2] / board.width).T
    X, Y = (board.corners[:, :2] / board.width).T
    along_x, along_y = (11, 7) if columns >= rows else (7, 11)
    for i in range(along_x + 1):
        for j in range(along_y + 1):
            exact = np.sum(X**i * Y**j)
            assert np.sum(weights * x**i * y**j) == pytest.approx(exact, abs=1e-12)
    limits = Limits.for_board(board, paper_camera)
    vectors = np.array([random_pose(Space(board, paper_camera, limits), rng) for _ in range(100)])
    known = information_at(paper_camera, Board(), GOOD)
    exact, rough = (
        np.einsum("nii->ni", Posterior(board, paper_camera, known).after(vectors, rough=quick))
        for quick in (False, True)
    )
    # A board of 130 corners can fill the picture's edge with detail that 24 points do not see.
    assert np.median(np.abs(rough / exact - 1)) < 2e-3


def test_a_batch_is_the_views_one_by_one(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    poses = [Pose.from_vector(v) for v in GOOD]
    batch = view_information(
        paper_camera,
        default_board.corners,
        np.array([p.R for p in poses]),
        np.array([p.t for p in poses]),
    )
    for one, vector in zip(batch, GOOD, strict=True):
        alone = information_at(paper_camera, default_board, [vector])
        np.testing.assert_allclose(one, alone, rtol=1e-9, atol=1e-9 * np.abs(alone).max())
        eigenvalues = np.linalg.eigvalsh(one)
        assert eigenvalues.min() > -1e-9 * eigenvalues.max(), "no view takes information away"


def test_one_view_alone_leaves_parameters_undetermined_and_the_prior_mends_it(
    paper_camera: Camera, default_board: Board
) -> None:
    one = information_at(paper_camera, default_board, GOOD[:1])
    known = covariance_of(one + prior_information(paper_camera, NOISE_PX), NOISE_PX)
    believed = np.sqrt(np.diag(np.linalg.inv(prior_information(paper_camera))))
    sigma = np.sqrt(np.diag(known))
    assert np.isfinite(sigma).all() and (sigma <= believed * (1 + 1e-9)).all()
    # Where views determine everything, the prior is nearly nothing.
    six = information_at(paper_camera, default_board, GOOD)
    with_prior = covariance_of(six + prior_information(paper_camera, NOISE_PX), NOISE_PX)
    ratio = np.diag(with_prior) / np.diag(covariance_of(six, NOISE_PX))
    # k1, k2, k3 hardly act alone on views that leave the image's corners empty.
    assert ratio[[0, 1, 2, 3, 6, 7]].min() > 0.98 and ratio.max() <= 1


@pytest.mark.slow
def test_prediction_of_a_view_is_what_calibrating_with_it_brings(
    paper_camera: Camera, default_board: Board
) -> None:
    """Predicted from three views and one hypothetical; found by calibrating 150 times with four."""
    rng = np.random.default_rng(11)
    three, four = GOOD[:3], [*GOOD[:3], NEXT]
    predicted = np.sqrt(
        np.diag(covariance_of(information_at(paper_camera, default_board, four), NOISE_PX))
    )
    before = np.sqrt(
        np.diag(covariance_of(information_at(paper_camera, default_board, three), NOISE_PX))
    )
    estimates = [
        calibrate(
            default_board,
            [observe(paper_camera, default_board, v, rng) for v in four],
            start=paper_camera,
        ).camera.parameters
        for _ in range(150)
    ]
    spread = np.std(estimates, axis=0, ddof=1)
    # The standard error of a spread of 150 is 6 %: three of them.
    np.testing.assert_allclose(predicted / spread, 1, atol=0.18)
    assert (before > predicted).all() and (before > 1.1 * predicted).any()


def test_prediction_from_one_calibration_agrees_with_the_next(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """As the session does it: everything evaluated at the estimate, nothing at the truth."""
    seen = [observe(paper_camera, default_board, v, rng) for v in GOOD]
    now = calibrate(default_board, seen)
    total = sum(
        view_information(
            now.camera, default_board.points_of(v.observation.ids), v.pose.R[None], v.pose.t[None]
        )[0]
        for v in now.views
    )
    np.testing.assert_allclose(
        covariance_of(total, now.residual_sigma_px), now.covariance, rtol=1e-6, atol=1e-12
    )
    extra = Pose.from_vector(NEXT)
    more = view_information(now.camera, default_board.corners, extra.R[None], extra.t[None])[0]
    predicted = np.sqrt(np.diag(covariance_of(total + more, now.residual_sigma_px)))
    after = calibrate(default_board, [*seen, observe(paper_camera, default_board, NEXT, rng)])
    np.testing.assert_allclose(predicted, after.sigma, rtol=0.15)

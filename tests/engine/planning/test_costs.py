"""Costs and projection errors, against Monte Carlo, matrix algebra and real calibrations."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.optimize import least_squares, minimize
from scipy.spatial.transform import Rotation

from venus3d.engine.calibration.corner_noise import RENDERED
from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import (
    GRID,
    grid_pixels,
    projection_diff_px,
    projection_uncertainty_px,
)
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Array, Pose, rotations_of
from venus3d.engine.planning.costs import PoseCost, expected_distance, make_cost, with_surcharge
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import COSTS, Cost

VIEWS = np.array(
    [
        [45, 0, 0, 0, 0, 0.4],
        [-30, 20, 10, 0.05, 0, 0.4],
        [10, -40, -20, -0.05, 0.03, 0.45],
        [0, 10, 5, 0.1, 0.05, 0.5],
        [-20, -20, 0, -0.1, -0.05, 0.5],
    ]
)

PARAMETERS = PAPER_CAMERA.parameter_names
SIGMA = float(np.sqrt(0.1))


def information_of_views(camera: Camera, board: Board, views: Array = VIEWS) -> Array:
    return view_information(camera, board.corners, rotations_of(views), views[:, 3:]).sum(axis=0)


def after_views(camera: Camera, board: Board) -> Posterior:
    return Posterior(board, camera, information_of_views(camera, board), SIGMA)


def test_projection_variance_by_monte_carlo(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """Cameras drawn from the covariance, the best common rotation found by least squares."""
    covariance = covariance_of(information_of_views(paper_camera, default_board), 0.1)
    drawn = rng.multivariate_normal(paper_camera.parameters, covariance, size=300)
    squares = [
        projection_diff_px(paper_camera, Camera.from_parameters(p, paper_camera.image_size)) ** 2
        for p in drawn
    ]
    # The mean of 300 such squares, of about three effective degrees of freedom, is good to 5 %.
    assert projection_uncertainty_px(paper_camera, covariance) ** 2 == pytest.approx(
        np.mean(squares), rel=0.15
    )


def test_mean_projection_error_against_another_minimiser(paper_camera: Camera) -> None:
    other = Camera(1280, 720, 1075, 1079, 640, 350, 0.01, -0.19, -0.002, -0.004, 0.2)
    rays = paper_camera.unproject(grid_pixels(paper_camera.image_size))

    def mean_square(rotvec: Array) -> float:
        turned = Rotation.from_rotvec(rotvec).apply(rays)
        return float(np.mean(np.sum((other.project(turned) - paper_camera.project(rays)) ** 2, 1)))

    best = minimize(
        mean_square, np.zeros(3), method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12}
    )
    assert projection_diff_px(paper_camera, other) == pytest.approx(np.sqrt(best.fun), rel=1e-5)


def test_a_turned_camera_and_a_shifted_principal_point_are_nearly_the_same(
    paper_camera: Camera,
) -> None:
    """3 px of principal point are mostly a turn: what is left is a small part of it."""
    assert projection_diff_px(paper_camera, paper_camera) < 1e-9
    shifted = replace(paper_camera, cx=paper_camera.cx + 3)
    assert projection_diff_px(paper_camera, shifted) < 1.0
    longer = replace(paper_camera, fx=paper_camera.fx * 1.01, fy=paper_camera.fy * 1.01)
    assert projection_diff_px(paper_camera, longer) > 2.0
    with pytest.raises(CalibrationError, match="same size"):
        projection_diff_px(paper_camera, paper_camera.scaled((640, 360)))


def test_the_grid_is_the_centres_of_equal_cells() -> None:
    pixels = grid_pixels((1280, 720))
    assert pixels.shape == (GRID[0] * GRID[1], 2)
    # Pixel centres are integers, so the image reaches from -0.5 to 1279.5.
    np.testing.assert_allclose(pixels.mean(axis=0), [639.5, 359.5])
    assert pixels[0, 0] - -0.5 == pytest.approx((pixels[1, 0] - pixels[0, 0]) / 2)


def test_dispersion_costs_by_plain_inversion(paper_camera: Camera, default_board: Board) -> None:
    """Eqs (13), (14) from the inverse of the whole normal matrix, poses included."""
    candidate = np.array([[20.0, -25, 5, 0.02, 0.01, 0.4], [0, 30, 0, 0, 0, 0.5]])
    information = information_of_views(paper_camera, default_board)
    for row, vector in enumerate(candidate):
        views = np.vstack([VIEWS, vector])
        _, Ji, Je = paper_camera.project_with_jacobians(
            default_board.corners, rotations_of(views), views[:, 3:]
        )
        J = np.zeros((len(views) * 80, 9 + 6 * len(views)))
        for i in range(len(views)):
            J[80 * i : 80 * i + 80, :9] = Ji[i].reshape(80, 9)
            J[80 * i : 80 * i + 80, 9 + 6 * i : 15 + 6 * i] = Je[i].reshape(80, 6)
        scale = np.linalg.norm(J, axis=0)
        pseudo = np.linalg.pinv(J / scale)
        variance = SIGMA**2 * (np.sum(pseudo**2, axis=1) / scale**2)[:9]
        iod = variance / np.abs(paper_camera.parameters)
        for name, expected in (("sum-iod", iod.sum()), ("max-iod", iod.max())):
            cost = make_cost(
                name,  # type: ignore[arg-type]
                Posterior(default_board, paper_camera, information, SIGMA),
            )
            assert cost(candidate)[row] == pytest.approx(expected, rel=1e-6)


def covariance_by_opencv(camera: Camera, board: Board, views: Array) -> Array:
    """(9, 9) for noise of one pixel: the block of the whole inverse, poses included."""
    count = 2 * board.corner_count
    J = np.zeros((len(views) * count, 9 + 6 * len(views)))
    for i, vector in enumerate(views):
        pose = Pose.from_vector(vector)
        _, full = cv2.projectPoints(board.corners, pose.rvec, pose.t, camera.K, camera.distortion)
        rows = slice(count * i, count * (i + 1))
        J[rows, :9] = np.asarray(full)[:, 6:15]
        J[rows, 9 + 6 * i : 15 + 6 * i] = np.asarray(full)[:, :6]
    scale = np.linalg.norm(J, axis=0)
    pseudo = np.linalg.pinv(J / scale) / scale[:, None]
    return (pseudo @ pseudo.T)[:9, :9]


def test_trace_and_log_det_by_opencvs_jacobians(paper_camera: Camera, default_board: Board) -> None:
    """In units of the pixels that each parameter moves, after a turn found by least squares."""
    step = np.array([1, 1, 1, 1, 0.01, 0.01, 1e-3, 1e-3, 0.01])
    moved = [
        projection_diff_px(
            paper_camera,
            Camera.from_parameters(
                paper_camera.parameters + step[i] * np.eye(9)[i], paper_camera.image_size
            ),
        )
        for i in range(9)
    ]
    px = np.array(moved) / step
    candidate = np.array([[20.0, -25, 5, 0.02, 0.01, 0.4]])
    covariance = SIGMA**2 * covariance_by_opencv(
        paper_camera, default_board, np.vstack([VIEWS, candidate])
    )
    in_px = covariance * np.outer(px, px)
    expected = {
        "trace": np.trace(in_px),
        "log-det": np.exp(np.linalg.slogdet(in_px)[1] / 9),
    }
    for name, value in expected.items():
        cost = make_cost(
            name,  # type: ignore[arg-type]
            Posterior(
                default_board,
                paper_camera,
                information_of_views(paper_camera, default_board),
                SIGMA,
            ),
        )
        assert cost(candidate)[0] == pytest.approx(value, rel=0.02)


def test_max_ere_by_monte_carlo(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """Cameras drawn from the covariance; the best turn of each by least squares over 5 x 5 rays."""
    candidate = np.array([[20.0, -25, 5, 0.02, 0.01, 0.4]])
    covariance = SIGMA**2 * covariance_by_opencv(
        paper_camera, default_board, np.vstack([VIEWS, candidate])
    )
    u, v = np.meshgrid(np.linspace(0, 1279, 5), np.linspace(0, 719, 5))
    pixels = np.stack([u.ravel(), v.ravel()], axis=1)
    rays = paper_camera.unproject(pixels)
    distances: list[Array] = []
    for parameters in rng.multivariate_normal(paper_camera.parameters, covariance, size=400):
        drawn = Camera.from_parameters(parameters, paper_camera.image_size)

        def miss(rotvec: Array, drawn: Camera = drawn) -> Array:
            turned = np.asarray(Rotation.from_rotvec(rotvec).apply(rays))
            seen = drawn.distort(turned[:, :2] / turned[:, 2:]) * [drawn.fx, drawn.fy]
            return (seen + np.array([drawn.cx, drawn.cy]) - pixels).ravel()

        best = least_squares(miss, np.zeros(3)).x
        distances.append(np.linalg.norm(miss(best).reshape(-1, 2), axis=1))
    expected = np.mean(distances, axis=0).max()
    cost = make_cost(
        "max-ere",
        Posterior(
            default_board, paper_camera, information_of_views(paper_camera, default_board), SIGMA
        ),
    )
    # The mean of 400 lengths is good to 3 %, the largest of 25 such means is a little too large.
    assert cost(candidate)[0] == pytest.approx(expected, rel=0.1)


def test_the_mean_length_of_a_gaussian(rng: np.random.Generator) -> None:
    covariances = np.array([np.eye(2), [[4, 0], [0, 0]], [[2, 1.2], [1.2, 1]], np.zeros((2, 2))])
    for covariance, found in zip(covariances, expected_distance(covariances), strict=True):
        drawn = rng.multivariate_normal([0, 0], covariance, size=200_000)
        mean = np.linalg.norm(drawn, axis=1).mean()
        assert found == pytest.approx(mean, rel=0.01, abs=1e-12)
    assert expected_distance(np.eye(2)) == pytest.approx(np.sqrt(np.pi / 2)), "Rayleigh"


@pytest.mark.parametrize("name", [name for name in COSTS if name != "rms"])
def test_every_cost_is_positive_falls_with_a_view_and_is_quick(
    name: Cost, paper_camera: Camera, default_board: Board
) -> None:
    posterior = after_views(paper_camera, default_board)
    cost = make_cost(name, posterior)
    added = information_of_views(paper_camera, default_board, VIEWS[:1])
    more = make_cost(name, replace(posterior, information=posterior.information + added))
    values = cost(VIEWS)
    assert values.shape == (5,) and (values > 0).all() and (more(VIEWS) < values).all()
    assert isinstance(cost, PoseCost)
    np.testing.assert_allclose(cost.rough(VIEWS), values, rtol=5e-3)
    dearer = with_surcharge(cost, lambda vectors: np.full(len(vectors), 0.5))
    np.testing.assert_allclose(dearer(VIEWS), 1.5 * values)
    assert isinstance(dearer, PoseCost)
    np.testing.assert_allclose(dearer.rough(VIEWS), 1.5 * cost.rough(VIEWS))
    noisy = make_cost(name, replace(posterior, noise=RENDERED))
    assert (noisy(VIEWS) != values).all()


def test_a_value_of_exactly_zero_divides_by_one(default_board: Board) -> None:
    plain = Camera(1280, 720, 1000, 1000, 640, 360)
    information = information_of_views(plain, default_board)
    cost = make_cost("max-iod", Posterior(default_board, plain, information))
    after = covariance_of(information + information_of_views(plain, default_board, VIEWS[:1]))
    values = [1000, 1000, 640, 360, 1, 1, 1, 1, 1]
    assert cost(VIEWS[:1])[0] == pytest.approx(np.max(np.diag(after) / values))


def test_projection_variance_falls_with_every_view(
    paper_camera: Camera, default_board: Board
) -> None:
    few = information_of_views(paper_camera, default_board, VIEWS[:3])
    cost = make_cost(
        "projection-variance",
        Posterior(default_board, paper_camera, few, 2.0),
    )
    now = projection_uncertainty_px(paper_camera, covariance_of(few, 2.0)) ** 2
    assert (cost(VIEWS) < now).all()
    expected = projection_uncertainty_px(
        paper_camera,
        covariance_of(few + information_of_views(paper_camera, default_board, VIEWS[3:4]), 2.0),
    )
    assert cost(VIEWS[3:4])[0] == pytest.approx(expected**2, rel=1e-9)


def test_rms_really_calibrates(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    observations: list[Observation] = []
    ids = np.arange(default_board.corner_count)
    for vector in VIEWS:
        pixels = paper_camera.project(Pose.from_vector(vector).apply(default_board.corners))
        noisy = pixels + rng.normal(0, SIGMA, pixels.shape)
        observations.append(Observation(ids, noisy, paper_camera.image_size))
    cost = make_cost(
        "rms",
        Posterior(default_board, paper_camera, np.eye(9), SIGMA),
        observations=observations,
        rng=rng,
    )
    values = cost(VIEWS[:2] + 1e-3)
    # 480 coordinates less 45 unknowns: the rms distance is about sigma sqrt(2 (1 - 45 / 480)).
    np.testing.assert_allclose(values, SIGMA * np.sqrt(2 * (1 - 45 / 480)), rtol=0.12)


def test_costs_that_do_not_exist(paper_camera: Camera, default_board: Board) -> None:
    with pytest.raises(VenusError, match="no cost 'beauty'; use one of projection-variance"):
        make_cost("beauty", Posterior(default_board, paper_camera, np.eye(9)))  # type: ignore[arg-type]
    with pytest.raises(VenusError, match="needs the views"):
        make_cost("rms", Posterior(default_board, paper_camera, np.eye(9)))
    assert len(PARAMETERS) == 9

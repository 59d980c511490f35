"""The bundle adjustment against OpenCV, scipy and finite differences."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.engine.calibration.test_adjustment import GOOD, observe, tilted
from venus3d.engine.calibration.bundle import Corners, Parameters, Problem, adjust, derivatives
from venus3d.engine.calibration.initial_values import focal_of, homographies, initial_parameters
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.robust_fit import from_several_starts
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-12)


def single(values: Array) -> Array:
    """Rounded to single precision, as OpenCV takes them."""
    return values.astype(np.float32).astype(np.float64)


def corners_of(board: Board, views: list[Observation]) -> Corners:
    return Corners.of(
        [single(board.points_of(v.ids)) for v in views], [single(v.corners) for v in views]
    )


@pytest.mark.parametrize("count", [4, 12, 40])
def test_the_optimum_is_opencvs(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator, count: int
) -> None:
    views = [
        observe(paper_camera, default_board, vector, rng, keep=0.9)
        for vector in tilted(rng, 10, 45, count)
    ]
    problem = Problem(corners_of(default_board, views), np.eye(9))
    found = from_several_starts(problem, paper_camera.image_size)
    rms, K, distortion, *_ = cv2.calibrateCamera(
        [default_board.points_of(v.ids).astype(np.float32).reshape(-1, 1, 3) for v in views],
        [v.corners.astype(np.float32).reshape(-1, 1, 2) for v in views],
        paper_camera.image_size,
        Camera.guess(paper_camera.image_size).K,
        np.zeros(5),
        criteria=CRITERIA,
    )
    theirs = Camera.from_opencv(K, distortion, paper_camera.image_size).parameters
    total = sum(v.count for v in views)
    variance = found.cost / (2 * total - 6 * count - 9)
    sigma = np.sqrt(variance * np.diag(np.linalg.inv(found.information)))
    assert found.converged
    assert np.sqrt(found.cost / total) == pytest.approx(rms, rel=1e-9)
    assert (abs(found.parameters.camera.parameters - theirs) < 1e-6 * sigma).all()


@pytest.mark.parametrize("seed", range(4))
def test_the_optimum_of_a_crop_is_far_along_a_valley(default_board: Board, seed: int) -> None:
    """cx, p2 and the radial terms trade for each other: sixty steps end half-way."""
    camera = Camera(900, 700, 1000, 1000, -60, 300, -0.25)
    rng, views = np.random.default_rng(seed), list[Observation]()
    while len(views) < 8:
        turns = [*rng.uniform(-40, 40, 2), rng.uniform(-20, 20)]
        place = [rng.uniform(0.15, 0.3), rng.uniform(-0.05, 0.1), rng.uniform(0.35, 0.6)]
        seen = observe(camera, default_board, [*turns, *place], rng, noise=0.05)
        if seen.count >= 20:
            views.append(seen)
    problem = Problem(corners_of(default_board, views), np.eye(9))
    for start in initial_parameters(problem.corners, camera.image_size):
        found = adjust(problem, start)
        assert found.converged
        assert found.parameters.camera.cx == pytest.approx(-60, abs=4)


def faced(camera: Camera, board: Board, count: int, rng: np.random.Generator) -> list[Observation]:
    """Views of the whole board, tilted, anywhere in the picture, with a noise of 0.05 px."""
    views = list[Observation]()
    while len(views) < count:
        at = camera.unproject(rng.uniform([100, 80], np.array(camera.image_size) - [100, 80]))
        place = at / at[2] * rng.uniform(0.42, 0.7)
        vector = tilted(rng, 12, 36, 1)[0]
        seen = observe(camera, board, [*vector[:3], *place], rng, noise=0.05)
        if seen.count == board.corner_count:
            views.append(seen)
    return views


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 7, 9])
def test_a_principal_point_near_the_edge_is_reached(default_board: Board, seed: int) -> None:
    """A bent valley: 400 steps crept along it and ended 6 to 218 sigma from the optimum, and that
    was given as the result. With the seed 3 the start that leads ends beside it, with 0.85 px."""
    camera = Camera(1280, 720, 1000, 1000, 25, 352, k1=-0.2, k2=0.04)
    assert_found(camera, faced(camera, default_board, 11, np.random.default_rng(seed)))


@pytest.mark.parametrize("seed", [1, 4, 8, 12])
def test_a_principal_point_is_looked_for_near_the_edge(default_board: Board, seed: int) -> None:
    """From the middle all starts ended with 1.0 to 1.6 px, hundreds of sigma away."""
    camera = Camera(1280, 720, 666, 664, 18, 235, k1=0.034, k2=0.026)
    assert_found(camera, faced(camera, default_board, 9, np.random.default_rng(seed)))


def assert_found(camera: Camera, views: list[Observation]) -> None:
    """The camera is the optimum, within 4 sigma of a noise of 0.05 px."""
    problem = Problem(corners_of(Board(), views), np.eye(9))
    found = from_several_starts(problem, camera.image_size)
    sigma = 0.05 * np.sqrt(np.diag(np.linalg.inv(found.information)))
    assert found.converged
    assert (abs(found.parameters.camera.parameters - camera.parameters) < 4 * sigma).all()


def bent_problem(
    camera: Camera, board: Board, rng: np.random.Generator, **settings: object
) -> tuple[Problem, Parameters]:
    """A problem with a bow and a stretch, and a start near its optimum."""
    bent = replace(board, bow=(0.002, -0.001), stretch=0.01)
    views = [observe(camera, bent, vector, rng) for vector in GOOD]
    corners = corners_of(board, views)
    problem = Problem(
        corners,
        np.eye(12),
        board.deformations(corners.points),
        prior=np.array([4.0, 4.0, 2.0]) * 1e5,
        **settings,  # type: ignore[arg-type]
    )
    start = next(initial_parameters(corners, camera.image_size))
    return problem, replace(start, shape=np.zeros(3))


def residuals(problem: Problem, x: Array, size: tuple[int, int]) -> Array:
    """Of all views by OpenCV's projection, and of the prior."""
    camera, shape = Camera.from_parameters(x[:9], size), x[9:12]
    found: list[Array] = []
    for view, pose in enumerate(x[12:].reshape(-1, 6)):
        c = problem.corners
        points = c.points[view] + np.tensordot(shape, problem.deformations[:, view], 1)
        pixels, _ = cv2.projectPoints(points, pose[:3], pose[3:], camera.K, camera.distortion)
        errors = c.pixels[view].T - pixels.reshape(-1, 2)
        found.append((errors * np.sqrt(c.weights[view])[:, None]).ravel())
    return np.concatenate([*found, np.sqrt(problem.prior) * shape])


def stacked(at: Parameters) -> Array:
    poses = [np.append(pose.rvec, pose.t) for pose in at.poses]
    return np.concatenate([at.camera.parameters, at.shape, *poses])


def test_shape_and_prior_reach_scipys_optimum(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    problem, start = bent_problem(paper_camera, default_board, rng)
    ours = adjust(problem, start)
    scale = np.maximum(abs(stacked(ours.parameters)), 1e-3)
    theirs = least_squares(
        lambda x: residuals(problem, x, paper_camera.image_size),
        stacked(ours.parameters) * (1 + 1e-4 * rng.normal(size=len(scale))),
        x_scale=scale,
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    assert ours.cost == pytest.approx(2 * theirs.cost, rel=1e-9)
    sigma = np.sqrt(np.diag(np.linalg.inv(ours.information)))
    found = stacked(ours.parameters)[:12]
    assert (abs(found - theirs.x[:12]) < 1e-3 * sigma).all()


def test_derivatives_are_finite_differences(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    problem, start = bent_problem(paper_camera, default_board, rng)
    at = replace(start, shape=np.array([0.001, 0.002, 0.01]), camera=paper_camera)
    by = derivatives(problem, at)

    def pixels(camera: Array, shape: Array, pose: Array) -> Array:
        points = problem.corners.points[0] + np.tensordot(shape, problem.deformations[:, 0], 1)
        R = Rotation.from_rotvec(pose[:3]).as_matrix() @ at.R[0]
        model = Camera.from_parameters(camera, paper_camera.image_size)
        rvec = Rotation.from_matrix(R).as_rotvec()
        found, _ = cv2.projectPoints(points, rvec, at.t[0] + pose[3:], model.K, model.distortion)
        return found.reshape(-1, 2).T

    values = [at.camera.parameters, at.shape, np.zeros(6)]
    steps = [np.maximum(abs(values[0]), 1e-2) * 1e-5, np.full(3, 1e-6), np.full(6, 1e-6)]
    row = 6
    for kind in (0, 1, 2):
        for index in range(len(values[kind])):
            up, down = [v.copy() for v in values], [v.copy() for v in values]
            up[kind][index] += steps[kind][index]
            down[kind][index] -= steps[kind][index]
            slope = (pixels(*up) - pixels(*down)) / (2 * steps[kind][index])
            ours = by[0, index if kind == 2 else row]
            np.testing.assert_allclose(ours, slope, atol=1e-5 * abs(slope).max() + 1e-6)
            row += kind != 2


def test_shared_and_fixed_parameters(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """fx = fy, no tangential distortion, k3 = 0: OpenCV's flags."""
    views = [observe(paper_camera, default_board, vector, rng) for vector in GOOD]
    basis = np.zeros((9, 5))
    basis[[0, 1, 2, 3, 4, 5], [0, 0, 1, 2, 3, 4]] = 1.0
    found = from_several_starts(
        Problem(corners_of(default_board, views), basis), paper_camera.image_size
    )
    _, K, distortion, *_ = cv2.calibrateCamera(
        [default_board.points_of(v.ids).astype(np.float32).reshape(-1, 1, 3) for v in views],
        [v.corners.astype(np.float32).reshape(-1, 1, 2) for v in views],
        paper_camera.image_size,
        Camera.guess(paper_camera.image_size).K,
        np.zeros(5),
        flags=cv2.CALIB_FIX_ASPECT_RATIO
        | cv2.CALIB_ZERO_TANGENT_DIST
        | cv2.CALIB_FIX_K3
        | cv2.CALIB_USE_INTRINSIC_GUESS,
        criteria=CRITERIA,
    )
    theirs = Camera.from_opencv(K, distortion, paper_camera.image_size).parameters
    np.testing.assert_allclose(found.parameters.camera.parameters, theirs, rtol=1e-6, atol=1e-7)


def test_robust_loss_is_hubers(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """The gradient of Huber's loss of distances is zero at the optimum: by finite differences."""
    problem, start = bent_problem(paper_camera, default_board, rng, outlier_px=0.4)
    problem.corners.pixels[2, :, 5] += [9.0, -4.0]
    found = adjust(problem, start)

    def huber(x: Array) -> float:
        all_of = residuals(problem, x, paper_camera.image_size)
        prior = float(all_of[-3:] @ all_of[-3:])
        r = np.linalg.norm(all_of[:-3].reshape(-1, 2), axis=1)
        return prior + float(np.where(r < 0.4, r**2, 0.8 * r - 0.16).sum())

    x = stacked(found.parameters)
    assert found.cost == pytest.approx(huber(x), rel=1e-9)
    sigma = np.sqrt(np.diag(np.linalg.inv(found.information)))
    for index, step in enumerate(1e-4 * sigma):
        moved = x.copy()
        moved[index] += step
        back = x.copy()
        back[index] -= step
        # One sigma away the slope would be 2 per sigma, and far more as one parameter moves alone.
        assert abs(huber(moved) - huber(back)) / 2e-4 < 0.05


def test_homographies_and_focal_length_of_exact_views(
    default_board: Board, rng: np.random.Generator
) -> None:
    camera = Camera.guess((1280, 720), 50.0)
    views = [observe(camera, default_board, vector, rng, noise=0.0) for vector in GOOD]
    corners = Corners.of(
        [default_board.points_of(v.ids) for v in views], [v.corners for v in views]
    )
    H = homographies(corners, 1280.0, np.array([camera.cx, camera.cy]))
    for view, found in zip(views, H, strict=True):
        theirs, _ = cv2.findHomography(
            default_board.points_of(view.ids)[:, :2],
            (view.corners - [camera.cx, camera.cy]) / 1280,
        )
        np.testing.assert_allclose(found / found[2, 2], theirs, rtol=1e-6, atol=1e-6)
    assert focal_of(H) * 1280 == pytest.approx(camera.fx, rel=1e-6)


def test_a_board_behind_the_lens_is_no_start(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    views = [observe(paper_camera, default_board, vector, rng) for vector in GOOD]
    corners = corners_of(default_board, views)
    start = next(initial_parameters(corners, paper_camera.image_size))
    with pytest.raises(CalibrationError, match="behind"):
        adjust(Problem(corners, np.eye(9)), replace(start, t=-start.t))

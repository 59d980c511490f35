"""What is told about a calibration beforehand, against calibrations and errors as they come out."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import cv2
import numpy as np
import pytest

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import (
    GRID,
    grid_pixels,
    projection_uncertainty_px,
    uncertainty_map,
)
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.guidance.work import Work
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.search_trace import SearchRecorder, SearchStep
from venus3d.engine.planning.uncertainty import (
    MAP,
    ProjectionUncertainty,
    influences,
    projection_uncertainty,
)

POSES = (
    [30, 5, 0, 0, 0, 0.45],
    [-25, 20, 10, 0.05, 0.02, 0.4],
    [10, -35, -20, -0.08, -0.03, 0.5],
    [-30, -15, 90, 0.08, -0.04, 0.42],
    [5, 40, 45, -0.04, 0.05, 0.38],
    [25, 25, -60, 0.1, 0.05, 0.55],
    [0, 0, 0, -0.12, -0.06, 0.4],
    [-20, -20, 30, 0.13, 0.06, 0.4],
    [20, -30, 180, -0.13, 0.07, 0.45],
    [-15, 30, -90, 0.12, -0.07, 0.45],
)
NOISE_PX = 0.3


def observe(
    camera: Camera, board: Board, vector: list[float], rng: np.random.Generator
) -> Observation:
    pixels = camera.project(Pose.from_vector(vector).apply(board.corners))
    pixels = pixels + rng.normal(0, NOISE_PX, pixels.shape)
    inside = ((pixels > 0) & (pixels < np.array(camera.image_size) - 1)).all(axis=1)
    return Observation(np.flatnonzero(inside), pixels[inside], camera.image_size)


@pytest.fixture
def observations(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> list[Observation]:
    return [observe(paper_camera, default_board, vector, rng) for vector in POSES]


@pytest.fixture
def known(default_board: Board, observations: list[Observation]) -> Calibration:
    return calibrate(default_board, observations)


def test_map_is_the_expected_error_spread_over_the_image(known: Calibration) -> None:
    """On the rays that the one figure is made of, its root mean square is that figure."""
    figure = projection_uncertainty_px(known.camera, known.covariance)
    coarse = uncertainty_map(known.camera, known.covariance, GRID)
    assert coarse.shape == (8, 12)
    assert np.sqrt(np.mean(coarse**2)) == pytest.approx(figure, rel=1e-12)
    fine = uncertainty_map(known.camera, known.covariance, MAP)
    assert fine.shape == (24, 36)
    # Three cells of the map in each direction for one ray of the figure's: the middle one is it.
    assert np.sqrt(np.mean(fine[1::3, 1::3] ** 2)) == pytest.approx(figure, rel=1e-12)


def test_map_is_what_cameras_drawn_from_the_covariance_do(
    known: Calibration, rng: np.random.Generator
) -> None:
    """Monte Carlo with OpenCV's projection; the common turn is taken out by a plain least squares
    of finite differences."""
    camera, size = known.camera, known.camera.image_size
    pixels = grid_pixels(size)
    rays = camera.unproject(pixels)

    def opencv(parameters: Array, rotvec: Array) -> Array:
        fx, fy, cx, cy, *d = parameters
        K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        return cv2.projectPoints(rays, rotvec, np.zeros(3), K, np.array(d))[0].reshape(-1)

    x, still = camera.parameters, np.zeros(3)
    turns = np.stack([(opencv(x, h) - opencv(x, -h)) / 2e-6 for h in 1e-6 * np.eye(3)], axis=1)
    # A hundredth of the spread: what is compared is the slope.
    drawn = rng.multivariate_normal(still.repeat(3), known.covariance, 3000) / 100
    moves = np.stack([opencv(x + d, still) for d in drawn], axis=1) - opencv(x, still)[:, None]
    moves -= turns @ np.linalg.lstsq(turns, moves, rcond=None)[0]
    seen = 100 * np.sqrt((moves.reshape(-1, 2, 3000) ** 2).sum(axis=1).mean(axis=1))
    told = uncertainty_map(camera, known.covariance, GRID).reshape(-1)
    np.testing.assert_allclose(told, seen, rtol=0.08)


def test_pixels_that_no_ray_reaches_are_gaps_in_the_map() -> None:
    """This lens folds back before the image's corners."""
    camera = Camera(1280, 720, 640, 640, 639.5, 359.5, k1=-0.4)
    assert camera.radius_limit < np.hypot(1, 0.56)
    errors = uncertainty_map(camera, np.diag([1.0, 1, 1, 1, 0, 0, 0, 0, 0]), MAP)
    assert np.isnan(errors[0, 0]) and np.isfinite(errors[12, 18])


@pytest.mark.parametrize("dropped", range(len(POSES)))
def test_without_a_view_is_what_a_calibration_without_it_says(
    known: Calibration, default_board: Board, observations: list[Observation], dropped: int
) -> None:
    """Told beforehand to first order; when OpenCV does it, it is the same but for two percent."""
    told = influences(known)[dropped]
    assert told.number == dropped + 1
    done = calibrate(default_board, [o for i, o in enumerate(observations) if i != dropped])
    error = projection_uncertainty_px(done.camera, done.covariance)
    assert told.uncertainty_px == pytest.approx(error, rel=0.02)
    assert told.rms_px == pytest.approx(done.rms_px, rel=1e-3)
    np.testing.assert_allclose(told.sigma[:4], done.sigma[:4], rtol=0.02)
    # The estimate moves as foretold: by far less than it is uncertain, and in that direction.
    moved = done.camera.parameters - known.camera.parameters
    expected = told.parameters - known.camera.parameters
    assert np.all(np.abs(moved - expected)[:4] < 0.1 * done.sigma[:4])


def test_leaving_out_a_bad_view_is_foretold_to_help(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """One view with corners four times as noisy spoils all sigmas; without it they are small."""
    good = [observe(paper_camera, default_board, vector, rng) for vector in POSES]
    shaken = replace(good[2], corners=good[2].corners + rng.normal(0, 1.2, good[2].corners.shape))
    spoilt = calibrate(default_board, [*good[:2], shaken, *good[3:]])
    told = influences(spoilt)
    done = calibrate(default_board, [*good[:2], *good[3:]])
    now = projection_uncertainty_px(spoilt.camera, spoilt.covariance)
    assert told[2].uncertainty_px < 0.7 * now
    assert told[2].uncertainty_px == pytest.approx(
        projection_uncertainty_px(done.camera, done.covariance), rel=0.05
    )
    assert told[2].rms_px == pytest.approx(done.rms_px, rel=0.01)
    assert all(left.uncertainty_px > 0.9 * now for left in told if left.number != 3)


def test_without_one_of_two_views_nothing_is_promised(
    default_board: Board, observations: list[Observation]
) -> None:
    """A single view does not determine nine parameters."""
    two = calibrate(default_board, observations[:2])
    for left in influences(two):
        assert np.isnan(
            left.uncertainty_px
        ) or left.uncertainty_px > 10 * projection_uncertainty_px(two.camera, two.covariance)


def session_after(
    camera: Camera, board: Board, observations: list[Observation], settings: Settings
) -> Snapshot:
    session = Session(board, camera.image_size, settings)
    for seen in observations:
        session.observe(seen)
        session.capture()
        session.run_pending()
    return session.snapshot()


def test_snapshot_knows_before_and_after_for_target_and_alternatives(
    paper_camera: Camera, default_board: Board, observations: list[Observation]
) -> None:
    snapshot = session_after(paper_camera, default_board, observations[:4], Settings())
    known, target = snapshot.uncertainty, snapshot.target
    assert isinstance(known, ProjectionUncertainty) and target is not None
    assert known.uncertainty_px == pytest.approx(snapshot.history[-1].uncertainty_px)
    for aim in (target, *target.alternatives):
        after = known.predicted_at(aim.pose)
        assert after is not None
        # One map for each, made of the very covariance that the figure shown is made of.
        middles = after[1::3, 1::3]
        assert np.sqrt(np.mean(middles**2)) == pytest.approx(aim.predicted_uncertainty_px, rel=1e-9)
        assert np.mean(after) < np.mean(known.uncertainty_map)
    assert known.predicted_at(Pose.identity()) is None
    assert [left.number for left in known.influences] == [1, 2, 3, 4]
    assert known.without(9) is None
    first = session_after(paper_camera, default_board, observations[:1], Settings())
    assert first.uncertainty is None, "one view does not show nine parameters"


def test_global_search_is_recorded_with_all_its_candidates(
    paper_camera: Camera, default_board: Board, observations: list[Observation]
) -> None:
    snapshot = session_after(paper_camera, default_board, observations[:3], Settings())
    walk, target = snapshot.search_trace, snapshot.target
    assert walk is not None and target is not None and walk.is_batched
    poses = np.concatenate([move.candidates for move in walk.steps])
    costs = np.concatenate([move.candidate_costs for move in walk.steps])
    assert len(poses) == len(costs) == target.evaluated == walk.steps[-1].evaluated
    bests = np.array([move.best_cost for move in walk.steps])
    assert (np.diff(bests) <= 0).all() and bests[-1] == costs.min()
    np.testing.assert_allclose(walk.end, target.pose.vector(), atol=1e-9)
    assert len(np.unique(poses, axis=0)) > 0.9 * len(poses), "no batch was written over"


def test_annealing_is_recorded_move_by_move(
    paper_camera: Camera, default_board: Board, observations: list[Observation]
) -> None:
    settings = Settings(method="venus")
    snapshot = session_after(paper_camera, default_board, observations[:3], settings)
    walk = snapshot.search_trace
    assert walk is not None and not walk.is_batched
    assert 60 <= len(walk.steps) <= 70
    taken = [move for move in walk.steps if move.accepted]
    # As printed, the walk ends on the pose it took last, not on its best one.
    np.testing.assert_allclose(walk.end, taken[-1].vector, atol=1e-9)
    # Algorithm 1 changes one element at a time, from the last pose taken.
    for before, after in pairwise(taken):
        assert np.count_nonzero(before.vector != after.vector) == 1
    by_rule = session_after(
        paper_camera, default_board, observations[:3], Settings(method="pose-selection")
    )
    assert by_rule.search_trace is None, "a rule searches nothing"


def test_a_long_search_does_not_fill_the_memory() -> None:
    recorder = SearchRecorder()
    move = SearchStep(np.zeros(6), 1.0, True, np.zeros(6), 1.0, 1)
    for _ in range(3 * SearchRecorder.AT_MOST):
        recorder(move)
    walk = recorder.trace(np.zeros(6))
    assert walk is not None and len(walk.steps) == SearchRecorder.AT_MOST


def test_watching_changes_no_target(
    paper_camera: Camera, default_board: Board, observations: list[Observation]
) -> None:
    """What is asked for does not depend on whether anybody looks, and a watcher sees every move."""
    session = Session(default_board, paper_camera.image_size, Settings())
    for seen in observations[:3]:
        session.observe(seen)
        session.capture()
        work = session.pending
        assert isinstance(work, Work)
        told: list[SearchStep] = []
        watched, alone = work.run(on_step=told.append), work.run()
        assert watched.suggestion is not None and alone.suggestion is not None
        # OpenCV's threads add up in no fixed order: the calibrations agree to rounding.
        np.testing.assert_allclose(
            watched.suggestion.target.pose.matrix, alone.suggestion.target.pose.matrix, atol=1e-5
        )
        assert watched.search_trace is not None and tuple(told) == watched.search_trace.steps
        session.apply(watched)


def test_no_maps_are_promised_while_the_views_alone_do_not_say_enough(
    known: Calibration, default_board: Board
) -> None:
    information = 1e-9 * np.linalg.inv(known.covariance / known.residual_sigma_px**2)
    posterior = Posterior.of(default_board, known.camera, information, known.residual_sigma_px)
    assert not posterior.settled
    knows = projection_uncertainty(known, posterior, None)
    assert knows is not None and knows.predicted == ()

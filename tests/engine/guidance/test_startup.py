"""Start-up (3.1): what single views of a moving board show, with known truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.calibration.test_adjustment import observe
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.startup import Startup

SIZE = (1280, 720)


@pytest.fixture
def startup(default_board: Board) -> Startup:
    return Startup(default_board, SIZE)


def test_before_any_view_there_is_a_guess(startup: Startup) -> None:
    assert startup.camera == Camera.guess(SIZE)
    assert startup.best is None and startup.distance is None
    np.testing.assert_allclose(startup.target.vector()[:5], [45, 0, 0, 0, 0], atol=1e-9)


@pytest.mark.parametrize("noise", [0.0, 0.1, 0.5])
def test_a_frontal_view_fits_any_focal_length_and_is_not_believed(
    startup: Startup,
    paper_camera: Camera,
    default_board: Board,
    rng: np.random.Generator,
    noise: float,
) -> None:
    for z in (0.3, 0.4, 0.6):
        for tilt in (0, 3):
            seen = observe(paper_camera, default_board, [tilt, 0, 10, 0, 0, z], rng, noise)
            assert not startup.observe(seen)
    assert startup.best is None and startup.camera == Camera.guess(SIZE)


def test_a_tilted_view_shows_the_focal_length(
    startup: Startup, paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    assert startup.observe(observe(paper_camera, default_board, [45, 0, 0, 0, 0, 0.4], rng, 0.1))
    assert startup.best is not None and 0 < startup.best.rms_px < 2
    assert startup.camera.fx == pytest.approx(1070, rel=0.05)
    assert startup.camera.fx == startup.camera.fy


def test_the_estimate_gets_better_while_the_board_is_moved_about(
    default_board: Board, paper_camera: Camera
) -> None:
    """Ten people wave the board for two seconds while they walk away from the camera."""
    ends: list[float] = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        startup = Startup(default_board, SIZE)
        shares: list[float] = []
        for k in range(60):
            turn = rng.normal([20, 0, 0], [15, 10, 10])
            vector = [*turn, *rng.normal(0, 0.03, 2), 0.25 + 0.006 * k]
            if startup.observe(observe(paper_camera, default_board, vector, rng, 0.1)):
                shares.append(startup.camera.fx)
        assert startup.best is not None
        ends.append(startup.camera.fx)
    errors = np.abs(np.array(ends) - 1070)
    assert errors.mean() < 15 and errors.max() < 40


def test_a_view_that_no_pose_fits_is_not_waited_for(
    startup: Startup, paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """The first frame with all corners may be of a wide lens, or misread: the next one counts."""
    good = observe(paper_camera, default_board, [0, 0, 0, 0, 0, 0.5], rng, 0.1)
    mixed = replace(good, corners=good.corners[rng.permutation(good.count)])
    startup.observe(mixed)
    assert startup.distance is None
    startup.observe(good)
    assert startup.distance is not None


def test_distance_is_where_all_of_the_board_was_first_seen(
    startup: Startup, paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    complete: float | None = None
    for z in np.arange(0.12, 0.5, 0.01):
        seen = observe(paper_camera, default_board, [30, 0, 0, 0, 0, z], rng, 0.1)
        startup.observe(seen)
        if complete is None:
            assert (startup.distance is None) == (seen.count < 38)
            complete = float(z) if seen.count >= 38 else None
    assert complete is not None and startup.distance is not None
    assert startup.distance == pytest.approx(complete, rel=0.05)


@pytest.mark.parametrize("size", [(1280, 720), (640, 480), (720, 1280)])
@pytest.mark.parametrize("board", [Board(), Board(5, 9, 0.04, 0.03)])
def test_the_first_target_fits_the_image_with_a_margin(board: Board, size: tuple[int, int]) -> None:
    startup = Startup(board, size)
    pixels = startup.camera.project(startup.target.apply(board.outline))
    margin = np.minimum(pixels + 0.5, np.array(size) - 0.5 - pixels) / size
    # As near as the margin lets it, since a near board shows most.
    assert 0.05 < margin.min() < 0.08


def test_the_first_target_is_near_where_the_board_is_but_not_too_far(
    startup: Startup, paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    nearest = startup.target.t[2]
    startup.observe(observe(paper_camera, default_board, [0, 0, 0, 0, 0, 0.36], rng, 0.1))
    assert startup.distance is not None
    assert startup.target.t[2] == pytest.approx(startup.distance)
    far = Startup(default_board, SIZE)
    far.observe(observe(paper_camera, default_board, [0, 0, 0, 0, 0, 1.5], rng, 0.1))
    assert far.target.t[2] == pytest.approx(1.5 * nearest)


def test_garbage_changes_nothing(startup: Startup, rng: np.random.Generator) -> None:
    line = np.stack([np.arange(12.0) * 50, np.arange(12.0) * 20], 1)
    for seen in (
        Observation.nothing(SIZE),
        Observation.nothing((640, 480)),
        Observation(np.arange(3), rng.uniform(0, 700, (3, 2)), SIZE),
        Observation(np.arange(12), line, SIZE),
        Observation(np.arange(12), np.zeros((12, 2)), SIZE),
        Observation(np.arange(12), np.full((12, 2), np.nan), SIZE),
        Observation(np.arange(8), rng.uniform(0, 700, (8, 2)), SIZE),
        *(Observation(np.arange(40), rng.uniform(0, 700, (40, 2)), SIZE) for _ in range(30)),
    ):
        assert not startup.observe(seen)
    assert startup.best is None


def test_a_board_of_which_not_all_is_read_is_moved_to_where_it_is(
    paper_camera: Camera, default_board: Board
) -> None:
    """Of a whole board that was too far away to be read it was said to be moved back."""
    session = Session(default_board, paper_camera.image_size)

    def told(pose: Pose) -> str:
        pixels = paper_camera.project(pose.apply(default_board.corners))
        inside = ((pixels > 0) & (pixels < [1279, 719])).all(axis=1)
        ids = np.flatnonzero(inside)[: default_board.corner_count - 8]
        seen = Observation(ids, pixels[ids], paper_camera.image_size)
        for _ in range(3):
            snapshot = session.observe(seen)
        assert snapshot.phase == "startup" and snapshot.target is None
        return snapshot.instruction.text("holder")

    far, cut_off = (
        Pose.from_vector([10, 5, 0, 0, 0, 1.1]),
        Pose.from_vector([0, 0, 0, 0.15, 0, 0.3]),
    )
    assert "bring it nearer" in told(far)
    assert "Move the board back" in told(cut_off)

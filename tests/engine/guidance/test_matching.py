"""The board now against the target: silhouettes, steps, motion, hysteresis."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose, turn
from venus3d.engine.guidance.matching import Tolerance, match, motion_px, silhouette_overlap
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose

TARGET = Pose.from_vector([20, -30, 10, 0.02, 0.01, 0.5])


def filled(camera: Camera, board: Board, pose: Pose) -> Array:
    """The silhouette as pixels, by OpenCV, on a canvas larger than the image."""
    outline, _ = cv2.projectPoints(board.outline, pose.rvec, pose.t, camera.K, np.zeros(5))
    canvas = np.zeros((2400, 3200), np.uint8)
    corners = np.round((outline.reshape(-1, 2) + np.array([900, 800])) * 16).astype(np.int32)
    cv2.fillConvexPoly(canvas, corners, 255, shift=4)
    return canvas > 0


def test_overlap_by_counting_pixels(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    space = Space(default_board, paper_camera, Limits())
    for i in range(12):
        one = Pose.from_vector(random_pose(space, rng))
        other = one.turned("z", 5.0 * i).turned("x", -3.0 * i).moved([0.01 * i, -0.004 * i, 0.01])
        a, b = (filled(paper_camera, default_board, p) for p in (one, other))
        counted = (a & b).sum() / (a | b).sum()
        overlap = silhouette_overlap(paper_camera, default_board, one, other)
        assert overlap == pytest.approx(counted, abs=0.015)
        assert silhouette_overlap(paper_camera, default_board, other, one) == pytest.approx(overlap)


def test_overlap_of_the_same_the_apart_and_the_invisible(
    paper_camera: Camera, default_board: Board
) -> None:
    def overlap(one: Pose, other: Pose) -> float:
        return silhouette_overlap(paper_camera, default_board, one, other)

    assert overlap(TARGET, TARGET) == pytest.approx(1)
    for tiny in (1e-12, 1e-9, 1e-6):  # where OpenCV's intersectConvexConvex goes astray
        assert overlap(TARGET, TARGET.moved([tiny, 0, 0]).turned("z", tiny)) > 0.9999
    assert overlap(TARGET, TARGET.moved([0.5, 0, 0])) == 0
    behind = Pose(TARGET.R, np.array([0, 0, -0.5]))
    assert overlap(TARGET, behind) == 0 == overlap(behind, behind)
    # Partly outside of the image, and partly behind the lens.
    outside = TARGET.moved([0.35, 0, 0])
    assert overlap(outside, outside.moved([0.002, 0, 0])) > 0.95
    through = Pose.from_vector([80, 0, 0, 0, 0, 0.05])
    assert 0 <= overlap(TARGET, through) <= 1
    facing_away = TARGET.turned("y", 180.0)
    assert 0 < overlap(TARGET, facing_away) <= 1


def test_what_remains_is_said_per_degree_of_freedom(
    paper_camera: Camera, default_board: Board
) -> None:
    rest = turn("z", 12) @ turn("y", -8) @ turn("x", 5)
    pose = Pose(rest.T @ TARGET.R, TARGET.t - [0.03, -0.02, 0.01])
    found = match(paper_camera, default_board, pose, TARGET)
    np.testing.assert_allclose(found.remaining_mm, [30, -20, 10])
    np.testing.assert_allclose(found.remaining_deg, [5, -8, 12])
    assert found.active_step == 1 and found.within == (False,) * 4
    shift = [
        cv2.projectPoints(default_board.corners, p.rvec, p.t, paper_camera.K, np.zeros(5))[0]
        for p in (pose, TARGET)
    ]
    expected = np.linalg.norm((shift[0] - shift[1]).reshape(-1, 2), axis=1).mean()
    assert found.corner_distance_px == pytest.approx(expected)


def test_the_active_step_is_the_first_that_is_not_done(
    paper_camera: Camera, default_board: Board
) -> None:
    def active(x: float, y: float, z: float, moved: float) -> int:
        rest = turn("z", z) @ turn("y", y) @ turn("x", x)
        pose = Pose(rest.T @ TARGET.R, TARGET.t - [moved, 0, 0])
        return match(paper_camera, default_board, pose, TARGET).active_step

    assert active(10, 10, 10, 0.02) == 1
    assert active(10, 10, 10, 0.005) == 2
    assert active(2, 10, 10, 0.005) == 3
    assert active(2, -2, 10, 0.005) == 4
    assert active(2, 10, 1, 0) == 3
    assert active(0, 0, 0, 0) == 4


def test_a_done_step_falls_back_only_beyond_the_hysteresis(
    paper_camera: Camera, default_board: Board
) -> None:
    tolerance = Tolerance(mm=10, deg=2, hysteresis=1.5)
    previous = None
    steps: list[int] = []
    for mm in (30, 11, 9, 11, 14, 16, 14, 9):
        pose = TARGET.moved([-mm / 1000, 0, 0]).turned("x", -20)
        previous = match(
            paper_camera, default_board, pose, TARGET, previous=previous, tolerance=tolerance
        )
        steps.append(previous.active_step)
    assert steps == [1, 1, 2, 2, 2, 1, 1, 2]


def test_motion_is_the_mean_shift_of_the_same_corners() -> None:
    before = Observation(np.array([1, 3, 5]), np.array([[10.0, 10], [20, 10], [30, 10]]), (100, 80))
    now = Observation(np.array([3, 5, 9]), np.array([[23.0, 14], [30, 10], [90, 70]]), (100, 80))
    assert motion_px(before, now) == pytest.approx(2.5)
    assert motion_px(None, now) == motion_px(before, None) == np.inf
    assert motion_px(Observation.nothing((100, 80)), now) == np.inf


def test_reached_needs_overlap_stillness_and_the_right_orientation(
    paper_camera: Camera, default_board: Board
) -> None:
    ids = np.arange(40)

    def seen(shift: float) -> Observation:
        pixels = paper_camera.project(TARGET.apply(default_board.corners))
        return Observation(ids, pixels + np.array([shift, 0]), paper_camera.image_size)

    def reached(pose: Pose, shift: float = 0.5, needed: float = 0.85) -> bool:
        return match(
            paper_camera,
            default_board,
            pose,
            TARGET,
            observation=seen(shift),
            before=seen(0),
            overlap_needed=needed,
        ).reached

    assert reached(TARGET) and reached(TARGET.moved([0.005, 0, 0]))
    assert not reached(TARGET, shift=2.5), "it moves"
    assert not reached(TARGET.moved([0.03, 0, 0]))
    assert not reached(TARGET.moved([0.005, 0, 0]), needed=0.99)
    assert not match(paper_camera, default_board, TARGET, TARGET).reached, "no frame before"
    # A silhouette looks the same upside down.
    upside_down = Pose(TARGET.R @ turn("z", 180), TARGET.t)
    assert silhouette_overlap(paper_camera, default_board, upside_down, TARGET) > 0.99
    assert not reached(upside_down)


def test_all_steps_done_means_reached(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    """Tolerances and overlap agree: at the edge of all four tolerances at once, still 98 %."""
    space = Space(default_board, paper_camera, Limits())
    tolerance = Tolerance()
    overlaps: list[float] = []
    for _ in range(40):
        target = Pose.from_vector(random_pose(space, rng))
        for _ in range(5):
            x, y, z = 0.999 * tolerance.deg * rng.choice([-1, 1], 3)
            rest = turn("z", z) @ turn("y", y) @ turn("x", x)
            away = rng.standard_normal(3)
            away *= 0.999 * tolerance.centre_mm(default_board) / 1000 / np.linalg.norm(away)
            found = match(
                paper_camera, default_board, Pose(rest.T @ target.R, target.t + away), target
            )
            assert all(found.within)
            overlaps.append(found.overlap)
    assert np.mean(np.array(overlaps) > 0.85) > 0.98


def test_senseless_tolerances_are_refused() -> None:
    for wrong in ({"mm": -1.0}, {"deg": -1.0}, {"hysteresis": 0.5}):
        with pytest.raises(ValueError, match="tolerances"):
            Tolerance(**wrong)
    assert Tolerance(mm=12).centre_mm(Board()) == 12

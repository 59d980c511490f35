"""The simulated hand: in order, within its limits, near the target, the same for the same seed."""

from __future__ import annotations

import numpy as np
import pytest

from tests.sources.targets import random_poses, target_of
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import home_pose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.target import Target
from venus3d.sources.autopilot import TOP_SPEED, TOP_TURN_DEG, Autopilot

START = Pose.from_vector([4, -6, 3, 0.03, -0.015, 0.19])
# What trembling adds to speeds: three sines per axis, at most 0.7 Hz, all at their steepest.
TREMBLING_MM_S, TREMBLING_DEG_S = 6.0, 2.4


@pytest.fixture(scope="module")
def targets(paper_camera: Camera, default_board: Board) -> list[Target]:
    poses = random_poses(paper_camera, default_board, 30)
    return [target_of(pose, paper_camera, default_board, n) for n, pose in enumerate(poses, 1)]


def hand(seed: int = 1, speed: float = 1.0, **options: float) -> Autopilot:
    return Autopilot(np.random.default_rng(seed), speed, **options)


def corner_motion_px(camera: Camera, board: Board, a: Pose, b: Pose) -> float:
    shift = camera.project(a.apply(board.corners)) - camera.project(b.apply(board.corners))
    return float(np.linalg.norm(shift, axis=1).mean())


@pytest.mark.parametrize(
    ("speed", "dt_s", "most"), [(1.0, 0.04, 460), (2.0, 0.2, 48), (3.0, 0.2, 34)]
)
def test_every_target_is_reached_and_held_still(
    targets: list[Target],
    paper_camera: Camera,
    default_board: Board,
    speed: float,
    dt_s: float,
    most: int,
):
    pilot, pose, frames, misses = hand(speed=speed), START, [], []
    for target in targets:
        count = 0
        while count == 0 or not (pilot.arrived or count == most):
            pose = pilot.advance(pose, target, dt_s)
            count += 1
        assert pilot.arrived and pilot.step == 4, f"target {target.number} after {most} frames"
        frames.append(count)
        for _ in range(10):
            before, pose = pose, pilot.advance(pose, target, dt_s)
            misses.append((pose.distance_to(target.pose), pose.angle_to_deg(target.pose)))
            motion = corner_motion_px(paper_camera, default_board, before, pose)
            assert motion < (0.5 if dt_s < 0.1 else 1.9), "the corners hold still"
    metres, degrees = np.array(misses).T
    assert metres.max() < 0.006 and degrees.max() < 2.5
    assert 0.001 < metres.mean() < 0.003 and 0.3 < degrees.mean() < 1.2, "a person, not a machine"
    assert 3 < np.mean(frames) * dt_s * speed < 11


def test_the_board_covers_its_target(
    targets: list[Target], paper_camera: Camera, default_board: Board
):
    """The silhouettes' Jaccard overlap after arrival, counted pixel by pixel."""
    import cv2

    def silhouette(pose: Pose) -> np.ndarray:
        pixels = paper_camera.without_distortion().project(pose.apply(default_board.outline))
        canvas = np.zeros((720, 1280), np.uint8)
        return cv2.fillConvexPoly(canvas, np.round(pixels).astype(np.int32), 1)

    pilot, pose = hand(speed=3.0), START
    for target in targets:
        for _ in range(40):
            pose = pilot.advance(pose, target, 0.2)
        one, other = silhouette(pose), silhouette(target.pose)
        assert (one & other).sum() / (one | other).sum() > 0.9


def test_steps_are_walked_in_order_one_turn_at_a_time(targets: list[Target]):
    """With a machine's hand each step changes only its own degree of freedom."""
    for target in targets[:10]:
        turns = Pose(target.pose.R @ START.R.T, target.pose.t).vector()[:3]
        if np.abs(turns).min() < 0.5:
            continue  # too little for a step; the next one ends with it
        pilot, pose, steps = hand(tremor=0.0), START, []
        for _ in range(400):
            before, pose = pose, pilot.advance(pose, target, 0.04)
            steps.append(pilot.step)
            if steps[-1] == 1:
                np.testing.assert_allclose(pose.R, START.R, atol=1e-9)
            if len(steps) > 1 and steps[-2] == steps[-1] > 1 and not pilot.arrived:
                turn = Pose(pose.R @ before.R.T, np.zeros(3)).rvec
                others = np.delete(turn, steps[-1] - 2)
                assert np.abs(others).max() < 1e-9 and pose.distance_to(before) < 1e-9
        assert pilot.arrived and steps == sorted(steps) and set(steps) == {1, 2, 3, 4}
        np.testing.assert_allclose(pose.matrix, target.pose.matrix, atol=1e-9)


@pytest.mark.parametrize("speed", [1.0, 3.0])
@pytest.mark.parametrize("dt_s", [0.02, 0.2])
def test_the_hand_never_jumps(targets: list[Target], speed: float, dt_s: float):
    """Targets change in the middle of motions as well: the hand goes on from where it is."""
    pilot, pose = hand(2, speed), START
    for number, target in enumerate(targets[:10]):
        for _ in range(int((2.0 if number % 2 else 9.0) / speed / dt_s)):
            before, pose = pose, pilot.advance(pose, target, dt_s)
            metres_s, degrees_s = pose.distance_to(before) / dt_s, pose.angle_to_deg(before) / dt_s
            assert metres_s < TOP_SPEED * speed + TREMBLING_MM_S / 1000
            assert degrees_s < TOP_TURN_DEG * speed + TREMBLING_DEG_S


def test_a_large_motion_goes_too_far_and_comes_back(targets: list[Target]):
    target = max(targets, key=lambda t: abs(t.steps[1].angle_deg))
    wanted = target.steps[1].angle_deg

    def farthest(overshoot: float) -> float:
        pilot, pose, most = hand(tremor=0.0, overshoot=overshoot), home_pose(), 0.0
        while not pilot.arrived:
            pose = pilot.advance(pose, target, 0.02)
            if pilot.step == 2:
                most = max(most, pose.vector()[0] / wanted)
        return most

    assert farthest(0.0) == pytest.approx(1.0, abs=1e-6)
    assert 1.005 < farthest(1.0) < 1.2


def test_a_seed_repeats_the_motion(targets: list[Target]):
    def path(seed: int) -> np.ndarray:
        pilot, pose, poses = hand(seed), START, []
        for n in range(300):
            pose = pilot.advance(pose, targets[n // 150], 0.04)
            poses.append(pose.matrix)
        return np.array(poses)

    np.testing.assert_array_equal(path(5), path(5))
    assert np.abs(path(5) - path(6)).max() > 1e-4


def test_without_a_target_the_board_is_drawn_back_slowly_then_held():
    pilot, pose, away = hand(), START, []
    for _ in range(300):
        before, pose = pose, pilot.advance(pose, None, 0.04)
        away.append(pose.t[2])
        assert pose.distance_to(before) / 0.04 < 0.6 * TOP_SPEED
    assert away[0] < 0.2 and away[-1] == pytest.approx(0.5, abs=0.01)
    assert np.hypot(*pose.t[:2]) < 0.01


def test_without_a_target_after_the_first_the_board_is_held(targets: list[Target]):
    pilot, pose = hand(tremor=0.0), START
    for _ in range(400):
        pose = pilot.advance(pose, targets[0], 0.04)
    for _ in range(100):
        pose = pilot.advance(pose, None, 0.04)
    assert pose.distance_to(targets[0].pose) < 1e-9
    for _ in range(400):
        pose = pilot.advance(pose, targets[1], 0.04)
    assert pose.distance_to(targets[1].pose) < 1e-9


def test_a_new_session_brings_the_board_back_into_view(targets: list[Target]) -> None:
    """It has no target until the whole board is seen, which the hand held out of sight for good."""
    autopilot, pose = hand(tremor=0.0), Pose.from_vector([0, 0, 0, 0.3, 0.2, 0.4])
    for _ in range(50):
        pose = autopilot.advance(pose, targets[0], 0.04)
    autopilot.forget_target()
    for _ in range(400):
        pose = autopilot.advance(pose, None, 0.04)
    assert pose.distance_to(home_pose()) < 0.005


def test_a_target_that_only_shifts_does_not_start_the_steps_anew(
    paper_camera: Camera, default_board: Board
):
    """The first target moves away while the start-up estimate settles: the tilt must go on."""
    pilot, pose, steps = hand(), START, []
    for n in range(400):
        z = 0.45 + 0.02 * min(n // 50, 4)
        aim = Pose.from_vector([45, 0, 0, 0, 0, z])
        pose = pilot.advance(pose, target_of(aim, paper_camera, default_board), 0.04)
        steps.append(pilot.step)
    assert steps == sorted(steps) and pilot.arrived
    assert pose.distance_to(aim) < 0.006 and pose.angle_to_deg(aim) < 2.5


def test_a_board_that_somebody_took_is_carried_on_from_there(targets: list[Target]):
    pilot, pose = hand(), START
    for _ in range(120):
        pose = pilot.advance(pose, targets[0], 0.04)
    assert pilot.step > 1
    taken = Pose.from_vector([0, 40, -100, -0.1, 0.05, 0.6])
    pose = pilot.advance(taken, targets[0], 0.04)
    assert pilot.step == 1 and pose.distance_to(taken) < 0.003
    for _ in range(400):
        pose = pilot.advance(pose, targets[0], 0.04)
    assert pilot.arrived and pose.distance_to(targets[0].pose) < 0.006


def test_what_the_screen_shows_to_be_off_is_mended(targets: list[Target]):
    """The estimated focal length is 6 % too long: all boards seem 6 % farther away and turned."""
    estimate = Pose.from_vector([1.0, -2.0, 0.5, 0.004, -0.003, 0.0])

    def seen_of(pose: Pose) -> Pose:
        return Pose(estimate.R @ pose.R, estimate.t + pose.t * [1.0, 1.0, 1.06])

    pilot, pose = hand(speed=3.0), START
    for target in targets[:8]:
        for _ in range(80):
            pose = pilot.advance(pose, target, 0.2, seen=seen_of(pose))
        assert seen_of(pose).distance_to(target.pose) < 0.008
        assert seen_of(pose).angle_to_deg(target.pose) < 2.5


def test_a_hand_that_was_misled_brings_a_board_back_that_is_no_longer_seen(
    paper_camera: Camera, default_board: Board
) -> None:
    """On a busy machine the pictures came late: the hand, at its target, mended all 45 degrees of
    the way once more, nothing was seen any more, and the session stood still for ever."""
    target = target_of(Pose.from_vector([45, 0, 0, 0, 0, 0.45]), paper_camera, default_board)
    pilot, pose = hand(speed=5.0), START
    while not pilot.arrived:
        pose = pilot.advance(pose, target, 0.1)
    old = Pose.from_vector([5, 0, 0, 0, 0, 0.45])
    while pose.angle_to_deg(target.pose) < 30:
        pose = pilot.advance(pose, target, 0.1, seen=old)
    for _ in range(60):
        pose = pilot.advance(pose, target, 0.1)
    assert pilot.arrived and pose.angle_to_deg(target.pose) < 2.5

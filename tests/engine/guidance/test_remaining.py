"""What remains to be done, and whether a board is still on the way that was shown."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.remaining import has_left_the_way, remaining_steps
from venus3d.engine.guidance.snapshot import pose_snapshot

TARGET = Pose.from_vector([25, -30, 20, 0.04, -0.02, 0.52])
NEAR = {"mm": 30.0, "deg": 10.0}


@pytest.fixture(scope="module")
def steps(paper_camera: Camera, default_board: Board) -> Steps:
    start = Pose.from_vector([-20, 15, 100, 0.1, 0.05, 0.8])
    return decompose(TARGET, paper_camera, default_board, start=start)


def test_they_count_from_the_board_now_or_from_upright(
    paper_camera: Camera, default_board: Board
) -> None:
    now = Pose.from_vector([25, -30, 0, 0.04, -0.02, 0.52])
    seen = pose_snapshot(default_board, paper_camera, now, TARGET)
    assert seen.remaining is not None and not seen.remaining.from_upright
    assert seen.remaining.start is now and seen.remaining.active == 4
    assert seen.remaining.done == (True, True, True, False)
    assert seen.remaining.step(4).prompt is not None
    assert seen.remaining.current == ("Step 4 of 4", seen.instruction)
    lost = pose_snapshot(default_board, paper_camera, None, TARGET, seen)
    assert lost.remaining is not None and lost.target is not None and lost.remaining.from_upright
    assert lost.remaining.steps == lost.target.steps and lost.remaining.active == 1
    np.testing.assert_array_equal(lost.remaining.start.R, np.eye(3))
    assert lost.remaining.done == (False,) * 4


@pytest.mark.parametrize("phase", ["captured", "converged", "finished"])
def test_nothing_is_to_be_done_while_the_next_pose_is_searched(
    phase: str, paper_camera: Camera, default_board: Board
) -> None:
    target = pose_snapshot(default_board, paper_camera, None, TARGET).target
    assert remaining_steps(phase, target, None) is None  # type: ignore[arg-type]
    assert remaining_steps("guiding", None, None) is None


def test_every_pose_of_the_way_is_on_it(steps: Steps) -> None:
    rng = np.random.default_rng(4)
    for step in steps:
        for share in rng.uniform(0, 1, 20):
            pose = step.before.moved(share * step.translation)
            if step.axis is not None:
                pose = pose.turned(step.axis, share * step.angle_deg)
            assert not has_left_the_way(steps, pose, mm=0.1, deg=0.01)
            shift, tilt = rng.standard_normal(3), rng.standard_normal(3)
            shift *= 0.029 / np.linalg.norm(shift)
            tilt *= np.radians(9.9) / np.linalg.norm(tilt)
            beside = Pose(Rotation.from_rotvec(tilt).as_matrix() @ pose.R, pose.t + shift)
            assert not has_left_the_way(steps, beside, **NEAR)


def test_it_agrees_with_the_nearest_of_many_poses(steps: Steps) -> None:
    """Against the way cut into small pieces, away from the limits themselves."""
    rng = np.random.default_rng(5)
    way = [
        (step.before.moved(s * step.translation)).turned(step.axis or "x", s * step.angle_deg)
        for step in steps
        for s in np.linspace(0, 1, 101)
    ]
    for _ in range(150):
        base = way[rng.integers(len(way))]
        off = Rotation.from_rotvec(np.radians(rng.uniform(-14, 14, 3))).as_matrix()
        pose = Pose(off @ base.R, base.t + rng.uniform(-0.03, 0.03, 3))
        near = [max(1000 * pose.distance_to(p) / 30, pose.angle_to_deg(p) / 10) for p in way]
        if abs(min(near) - 1) > 0.1:
            assert has_left_the_way(steps, pose, **NEAR) == (min(near) > 1)


def test_a_board_that_covers_its_target_has_nothing_left_to_do(
    paper_camera: Camera, default_board: Board
) -> None:
    """The silhouettes agree though one turn is beyond its tolerance: "Hold still" and "6° to go"
    would contradict each other."""
    now = TARGET.turned("z", -4)
    first = pose_snapshot(default_board, paper_camera, now, TARGET)
    assert first.remaining is not None and not first.remaining.is_over  # it may be passing by
    still = pose_snapshot(default_board, paper_camera, now, TARGET, first)
    assert still.match is not None and still.match.reached and not all(still.match.within)
    assert still.remaining is not None and still.remaining.done == (True,) * 4
    assert still.headline == still.remaining.current[0] == "Hold still"

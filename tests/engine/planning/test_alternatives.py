"""Other poses that would do: nearly as good, clearly different, and told in words that are true.

Oracles: scipy's rotations for how different two poses are, corners projected by OpenCV for words.
"""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.engine.planning.suggestions import suggestion
from venus3d.engine.calibration.corner_noise import RENDERED
from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.suggest import AT_MOST, NEARLY, clearly_different
from venus3d.engine.planning.target import Target, held_in_words

SIGMA = float(np.sqrt(0.1))
SEEN = ([45, 0, 0, 0, 0, 0.4], [-20, 25, 0, 0.05, 0, 0.4], [10, -35, 10, -0.05, 0, 0.45])


def told_by(camera: Camera, board: Board, pose: Pose) -> Array:
    return view_information(camera, board.corners, pose.R[None], pose.t[None])[0]


@pytest.fixture(scope="module")
def targets(paper_camera: Camera, default_board: Board) -> list[tuple[Array, Target]]:
    """What was known, and the target then, for one to three views and several seeds."""
    found: list[tuple[Array, Target]] = []
    for count in (1, 2, 3):
        poses = [Pose.from_vector(vector) for vector in SEEN[:count]]
        known = sum((told_by(paper_camera, default_board, p) for p in poses), np.zeros((9, 9)))
        for seed in range(3):
            made = suggestion(
                default_board,
                paper_camera,
                known,
                SIGMA,
                rng=np.random.default_rng(seed),
                number=count + 1,
            )
            found.append((known, made.target))
    return found


def test_alternatives_are_offered_and_complete(
    targets: list[tuple[Array, Target]], paper_camera: Camera, default_board: Board
) -> None:
    assert sum(len(target.alternatives) > 0 for _, target in targets) >= 4
    for known, target in targets:
        assert len(target.alternatives) <= AT_MOST
        for other in target.alternatives:
            assert Limits().accepts(paper_camera, default_board, other.pose.vector())[0]
            assert other.number == target.number and not other.alternatives
            assert other.reason.endswith(".") and other.serves and other.held
            np.testing.assert_array_equal(other.steps[3].after.matrix, other.pose.matrix)
            # What it promises, computed anew by the Schur complement instead of a Cholesky factor.
            if np.isfinite(target.uncertainty_px):
                after = known + told_by(paper_camera, default_board, other.pose)
                error = projection_uncertainty_px(paper_camera, covariance_of(after, SIGMA))
                assert other.predicted_uncertainty_px == pytest.approx(error, rel=1e-6)


def test_alternatives_are_nearly_as_good_and_clearly_different(
    targets: list[tuple[Array, Target]],
) -> None:
    for _, target in targets:
        all_poses = [target, *target.alternatives]
        behind = [
            other.predicted_uncertainty_px / target.predicted_uncertainty_px
            for other in all_poses[1:]
        ]
        assert behind == sorted(behind) and all(share <= 1 + NEARLY for share in behind)
        if np.isfinite(target.gain_px):
            assert all(other.gain_px >= (1 - NEARLY) * target.gain_px for other in all_poses)
        for i, one in enumerate(all_poses):
            for other in all_poses[:i]:
                turn = Rotation.from_matrix(one.pose.R.T @ other.pose.R).magnitude()
                apart = np.linalg.norm(one.pose.t - other.pose.t)
                assert np.degrees(turn) >= 20 or apart >= 0.2 * min(one.pose.t[2], other.pose.t[2])


def test_clearly_different_is_turned_or_elsewhere() -> None:
    pose = Pose.from_vector([20, 10, 0, 0.05, 0, 0.5])
    assert not clearly_different(pose, pose.turned("z", 19.9))
    assert clearly_different(pose, pose.turned("z", 20.1))
    assert not clearly_different(pose, pose.moved([0.09, 0, 0]))
    assert clearly_different(pose, pose.moved([0, 0.11, 0]))
    assert clearly_different(pose.moved([0, 0, 0.11]), pose)


def test_a_noise_model_changes_the_promise(paper_camera: Camera, default_board: Board) -> None:
    """A view counts for what its corners are worth: more noise everywhere, less promised."""
    poor = replace(RENDERED, reference_px=4 * RENDERED.reference_px)
    known = sum(told_by(paper_camera, default_board, Pose.from_vector(v)) for v in SEEN)

    def promised(**options: object) -> float:
        rng = np.random.default_rng(0)
        made = suggestion(
            default_board,
            paper_camera,
            known,  # type: ignore[arg-type]
            SIGMA,
            rng=rng,
            number=4,
            **options,  # type: ignore[arg-type]
        )
        return made.target.predicted_uncertainty_px

    assert promised(noise=poor) > 1.1 * promised(noise=RENDERED)


@pytest.mark.parametrize(
    ("vector", "words"),
    [
        ([0, 0, 0, 0, 0, 0.5], "upright, in the middle, facing the camera, 50 cm away"),
        ([30, 0, 0, 0, 0, 0.4], "upright, in the middle, top edge 30° nearer, 40 cm away"),
        ([0, -25, 0, 0, 0, 0.4], "upright, in the middle, left edge 25° nearer, 40 cm away"),
        ([0, -30, 40, -0.15, 0, 0.6], "turned 40° clockwise, on the left, top left corner"),
        ([0, 0, -10, 0.2, 0.12, 0.7], "turned 10° counter-clockwise, at the lower right"),
    ],
)
def test_how_the_board_is_held(vector: list[float], words: str, paper_camera: Camera) -> None:
    assert held_in_words(Pose.from_vector(vector), paper_camera).startswith(words)


def test_the_edge_named_as_nearer_is_nearer_and_on_that_side_of_the_picture(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    for _ in range(200):
        vector = [*rng.uniform(-40, 40, 3), *rng.uniform(-0.05, 0.05, 2), rng.uniform(0.4, 0.8)]
        pose = Pose.from_vector(vector)
        words = held_in_words(pose, paper_camera)
        if "nearer" not in words:
            continue
        side = words.split(", ")[2]
        # A disc around the board's centre: its nearest point, in the picture, seen from the centre.
        around = np.linspace(0, 2 * np.pi, 720, endpoint=False)
        disc = 0.01 * np.column_stack([np.cos(around), np.sin(around), 0 * around])
        points = pose.apply(disc)
        distance = np.linalg.norm(points, axis=1)
        nearest = points[int(np.argmin(distance))] - pose.t
        pixels, _ = cv2.projectPoints(
            np.array([pose.t, pose.t + nearest]), np.zeros(3), np.zeros(3), paper_camera.K, None
        )
        x, y = (pixels[1] - pixels[0]).ravel()
        # Within the sector that the words leave, and some degrees for the perspective.
        for word, amount in (("left", -x), ("right", x), ("top", -y), ("bottom", y)):
            if word in side:
                assert amount > 0.1 * np.hypot(x, y), (words, vector)

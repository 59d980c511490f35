"""What lessons show live, against OpenCV and Monte Carlo."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.focal_uncertainty import NOISE_PX, focal_sigma, focal_words, views_like

TILTED = [30, 10, 5, 0.02, -0.01, 0.45]


def pictures(camera: Camera, board: Board, pose: Pose) -> tuple[list[Any], list[Any]]:
    """Board points and pixels of the views by OpenCV alone."""
    points = [board.corners.astype(np.float32)] * 4
    pixels = []
    for view in views_like(pose):
        rvec = Rotation.from_matrix(view.R).as_rotvec()
        xy, _ = cv2.projectPoints(board.corners, rvec, view.t, camera.K, camera.distortion)
        pixels.append(np.asarray(xy).reshape(-1, 2))
    return points, pixels


def calibrated(camera: Camera, points: list[Any], pixels: list[Any]) -> Any:
    return cv2.calibrateCameraExtended(
        points,
        [xy.astype(np.float32) for xy in pixels],
        camera.image_size,
        camera.K.copy(),
        camera.distortion.copy(),
        flags=cv2.CALIB_USE_INTRINSIC_GUESS,
    )


def test_the_sigma_is_what_opencv_says_and_what_repeated_calibrations_show(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    pose = Pose.from_vector(TILTED)
    expected = focal_sigma(paper_camera, default_board, pose)
    points, pixels = pictures(paper_camera, default_board, pose)
    unknowns, equations = 9 + 4 * 6, 2 * 4 * default_board.corner_count
    found, stated = [], []
    for _ in range(60):
        noisy = [xy + rng.normal(0, NOISE_PX, xy.shape) for xy in pixels]
        rms, K, _, _, _, deviations, *_ = calibrated(paper_camera, points, noisy)
        found.append(K[0, 0])
        # OpenCV estimates the noise from what is left over: take that out again.
        noise = rms / np.sqrt(2) * np.sqrt(equations / (equations - unknowns))
        stated.append(float(deviations[0, 0]) / noise * NOISE_PX)
    assert expected == pytest.approx(np.mean(stated), rel=0.02)
    assert expected == pytest.approx(np.std(found), rel=0.25)


def test_a_frontal_board_says_nothing_and_tilt_helps(
    paper_camera: Camera, default_board: Board
) -> None:
    def sigma(tilt: float) -> float:
        return focal_sigma(paper_camera, default_board, Pose.from_vector([tilt, 0, 0, 0, 0, 0.45]))

    assert sigma(0) == np.inf
    tilts = [sigma(angle) for angle in (3, 8, 15, 30, 45)]
    assert tilts == sorted(tilts, reverse=True)
    assert tilts[0] > 20 * tilts[-1]
    assert sigma(90) == sigma(180) == np.inf  # edge on; from behind
    behind = Pose.from_vector([30, 0, 0, 0, 0, -0.45])
    assert focal_sigma(paper_camera, default_board, behind) == np.inf
    # Rolled in its plane or moved sideways, a flat board is no wiser.
    for vector in ([0, 0, 40, 0, 0, 0.45], [0, 0, 0, 0.1, -0.05, 0.6]):
        assert focal_sigma(paper_camera, default_board, Pose.from_vector(vector)) == np.inf


def test_like_views_keep_the_tilt_and_lean_in_all_directions() -> None:
    pose = Pose.from_vector(TILTED)
    normals = np.stack([view.R[:, 2] for view in views_like(pose)])
    np.testing.assert_allclose(normals[:, 2], pose.R[2, 2])
    np.testing.assert_allclose(normals[:, :2].sum(axis=0), 0, atol=1e-12)
    assert all((view.t == pose.t).all() for view in views_like(pose))


def test_words_say_a_figure_or_that_there_is_none(paper_camera: Camera) -> None:
    assert "± 3.9 px of 1068 (0.4 %)" in focal_words(3.9, paper_camera)
    assert "± 125 px of 1068 (12 %)" in focal_words(125.0, paper_camera)
    assert "say nothing" in focal_words(float("inf"), paper_camera)

"""Lengths on the board's plane: exact without errors, and their sigma against Monte Carlo."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.engine.calibration.test_verification import calibrated
from venus3d.engine.calibration.measurement import MeasuringCamera, measure, on_plane
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Array, Pose

BOARD = Board()
POSE = Pose.from_vector([25, -15, 10, 0.03, 0.01, 0.5])
ENDS = np.array([[-0.11, 0.02, 0.0], [0.09, -0.05, 0.0]])
LENGTH = float(np.linalg.norm(ENDS[1] - ENDS[0]))


def corners(camera: Camera, rng: np.random.Generator | None = None) -> Array:
    pixels = camera.project(POSE.apply(BOARD.corners))
    return pixels if rng is None else pixels + rng.normal(0, 0.2, pixels.shape)


def seen(pixels: Array) -> Observation:
    return Observation(np.arange(len(pixels)), pixels, PAPER_CAMERA.image_size)


def pose_by_opencv(camera: Camera, pixels: Array) -> Pose:
    _, rvec, tvec = cv2.solvePnP(
        BOARD.corners, pixels, camera.K, camera.distortion, flags=cv2.SOLVEPNP_IPPE
    )
    rvec, tvec = cv2.solvePnPRefineLM(
        BOARD.corners, pixels, camera.K, camera.distortion, rvec, tvec
    )
    return Pose.from_rvec_tvec(rvec, tvec)


def test_the_length_is_exact_and_points_are_in_the_boards_frame() -> None:
    pixels = PAPER_CAMERA.project(POSE.apply(ENDS))
    np.testing.assert_allclose(on_plane(PAPER_CAMERA, POSE, pixels), ENDS[:, :2], atol=1e-9)
    found = measure(
        MeasuringCamera(PAPER_CAMERA), BOARD, seen(corners(PAPER_CAMERA)), POSE, pixels, 0.5
    )
    assert found.length_m == pytest.approx(LENGTH, abs=1e-9)


def test_a_ray_beside_the_plane_is_no_length() -> None:
    edge_on = Pose.from_vector([80, 0, 0, 0, 0.3, 0.5])
    above = np.array([[640.0, 10.0], [640.0, 700.0]])
    assert np.isnan(on_plane(PAPER_CAMERA, edge_on, above)).any()


@pytest.mark.parametrize("source", ["clicks", "corners", "camera"])
def test_sigma_is_what_monte_carlo_gives(source: str) -> None:
    rng = np.random.default_rng(5)
    known = calibrated(3, views=6)
    exact = PAPER_CAMERA.project(POSE.apply(ENDS))
    drawn: list[float] = []
    for _ in range(400):
        camera, pixels, clicks = PAPER_CAMERA, corners(PAPER_CAMERA), exact
        if source == "clicks":
            clicks = exact + rng.normal(0, 0.7, exact.shape)
        elif source == "corners":
            pixels = corners(PAPER_CAMERA, rng)
        else:
            wrong = rng.multivariate_normal(PAPER_CAMERA.parameters, known.covariance)
            camera = Camera.from_parameters(wrong, PAPER_CAMERA.image_size)
        a, b = on_plane(camera, pose_by_opencv(camera, pixels), clicks)
        drawn.append(float(np.linalg.norm(b - a)))
    by = MeasuringCamera(
        PAPER_CAMERA,
        known.covariance if source == "camera" else None,
        0.2 if source == "corners" else 0.0,
    )
    found = measure(
        by, BOARD, seen(corners(PAPER_CAMERA)), POSE, exact, 0.7 if source == "clicks" else 0.0
    )
    assert np.mean(drawn) == pytest.approx(LENGTH, abs=4 * found.sigma_m / 20 + 1e-7)
    assert found.sigma_m == pytest.approx(np.std(drawn), rel=0.15)

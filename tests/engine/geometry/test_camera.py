"""The camera model against OpenCV and against finite differences."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Pose

CAMERA = st.builds(
    Camera,
    st.just(1280),
    st.just(720),
    st.floats(400, 3000),
    st.floats(400, 3000),
    st.floats(500, 800),
    st.floats(250, 450),
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.3),
    st.floats(-0.01, 0.01),
    st.floats(-0.01, 0.01),
    st.floats(-0.3, 0.3),
)
VECTOR = st.tuples(
    st.floats(-50, 50),
    st.floats(-50, 50),
    st.floats(-180, 180),
    st.floats(-0.05, 0.05),
    st.floats(-0.05, 0.05),
    st.floats(0.5, 1.2),
)

PARAMETERS = PAPER_CAMERA.parameter_names


@given(CAMERA, VECTOR)
def test_projection_is_opencvs(camera: Camera, p: tuple[float, ...]) -> None:
    board, pose = Board(), Pose.from_vector(p)
    expected, _ = cv2.projectPoints(board.corners, pose.rvec, pose.t, camera.K, camera.distortion)
    pixels = camera.project(pose.apply(board.corners))
    seen = np.isfinite(pixels).all(axis=1)
    assert seen.any()
    np.testing.assert_allclose(pixels[seen], expected.reshape(-1, 2)[seen], atol=1e-9)
    batch = camera.project_board(board.corners, pose.R[None], pose.t[None])[0]
    np.testing.assert_allclose(batch, pixels, atol=1e-9)


@given(CAMERA, VECTOR)
@settings(max_examples=40)
def test_jacobians_by_the_intrinsics_are_opencvs(camera: Camera, p: tuple[float, ...]) -> None:
    board, pose = Board(), Pose.from_vector(p)
    expected, J = cv2.projectPoints(board.corners, pose.rvec, pose.t, camera.K, camera.distortion)
    pixels, intrinsic, by_pose = camera.project_with_jacobians(
        board.corners, pose.R[None], pose.t[None]
    )
    np.testing.assert_allclose(pixels[0], expected.reshape(-1, 2), atol=1e-9)
    # OpenCV's columns: rotation vector 3, translation 3, focal lengths 2, centre 2, distortion 5.
    J = np.asarray(J).reshape(-1, 2, 15)
    np.testing.assert_allclose(intrinsic[0], J[..., 6:], rtol=1e-9, atol=1e-8)
    np.testing.assert_allclose(by_pose[0][..., 3:], J[..., 3:6], rtol=1e-9, atol=1e-7)


def test_jacobians_are_the_slopes_of_the_projection_for_many_poses_at_once(
    paper_camera: Camera, default_board: Board, rng: np.random.Generator
) -> None:
    vectors = rng.uniform([-45, -45, -90, -0.1, -0.05, 0.4], [45, 45, 90, 0.1, 0.05, 0.9], (20, 6))
    poses = [Pose.from_vector(v) for v in vectors]
    R, t = np.array([p.R for p in poses]), np.array([p.t for p in poses])
    _, intrinsic, by_pose = paper_camera.project_with_jacobians(default_board.corners, R, t)
    for column in range(9):
        h = 1e-4 * max(1.0, abs(paper_camera.parameters[column]))
        step = h * np.eye(9)[column]
        high, low = (
            Camera.from_parameters(paper_camera.parameters + s * step, (1280, 720)).project_board(
                default_board.corners, R, t
            )
            for s in (1, -1)
        )
        slope = (high - low) / (2 * h)
        np.testing.assert_allclose(intrinsic[..., column], slope, rtol=1e-6, atol=1e-6)
    for column in range(6):
        h = 1e-6
        w = h * np.eye(6)[column]
        ends: list[np.ndarray] = []
        for sign in (1, -1):
            turned = cv2.Rodrigues(sign * w[:3])[0] @ R
            ends.append(paper_camera.project_board(default_board.corners, turned, t + sign * w[3:]))
        slope = (ends[0] - ends[1]) / (2 * h)
        np.testing.assert_allclose(by_pose[..., column], slope, rtol=1e-5, atol=1e-3)


@given(st.floats(0, 1279), st.floats(0, 719))
def test_unproject_is_the_inverse_of_project(u: float, v: float) -> None:
    camera = Camera(1280, 720, 1068, 1073, 635, 355, -0.0031, -0.2059, -0.0028, -0.0038, 0.2478)
    ray = camera.unproject([u, v])
    assert np.isfinite(ray).all()
    assert np.linalg.norm(ray) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(camera.project(ray), [u, v], atol=1e-8)
    np.testing.assert_allclose(camera.project(3 * ray), [u, v], atol=1e-8)


def test_unproject_keeps_its_shape(paper_camera: Camera) -> None:
    grid = np.stack(np.meshgrid(np.arange(0, 1280, 160), np.arange(0, 720, 120)), -1)
    assert paper_camera.unproject(grid).shape == (*grid.shape[:-1], 3)


def test_points_behind_the_lens_or_beyond_the_fold_are_not_seen(paper_camera: Camera) -> None:
    assert np.isnan(paper_camera.project([0, 0, -1])).all()
    assert np.isnan(paper_camera.project([0, 0, 0])).all()
    barrel = Camera(1280, 720, 800, 800, 640, 360, k1=-0.3)
    # r (1 - 0.3 r^2) grows up to r = 1 / sqrt(0.9).
    assert barrel.radius_limit == pytest.approx(1 / np.sqrt(0.9))
    assert np.isfinite(barrel.project([1.0, 0, 1])).all()
    assert np.isnan(barrel.project([1.1, 0, 1])).all()
    assert Camera(10, 10, 10, 10, 5, 5, k1=0.1).radius_limit == np.inf


@given(CAMERA)
@settings(max_examples=60)
def test_radius_limit_is_where_the_radial_model_stops_growing(camera: Camera) -> None:
    r = np.linspace(0, min(camera.radius_limit, 3.0), 400)
    k1, k2, _, _, k3 = camera.coefficients
    d = r * (1 + k1 * r**2 + k2 * r**4 + k3 * r**6)
    assert (np.diff(d) > -1e-12).all()


def test_scaling_keeps_the_rays_of_the_pixels_corners(paper_camera: Camera) -> None:
    half = paper_camera.scaled((640, 360))
    # The corner shared by pixels 0, 1 of the large image is the centre of pixel 0 of the small one.
    np.testing.assert_allclose(
        half.unproject([0.0, 0.0]), paper_camera.unproject([0.5, 0.5]), atol=1e-12
    )
    np.testing.assert_allclose(
        half.unproject([639.5, 359.5]), paper_camera.unproject([1279.5, 719.5]), atol=1e-12
    )
    np.testing.assert_allclose(half.scaled((1280, 720)).parameters, paper_camera.parameters)


def test_conversions_and_field_of_view(paper_camera: Camera) -> None:
    again = Camera.from_opencv(paper_camera.K, paper_camera.distortion, (1280, 720))
    assert again == paper_camera
    assert Camera.from_parameters(paper_camera.parameters, (1280, 720)) == paper_camera
    assert dict(zip(PARAMETERS, paper_camera.parameters, strict=True))["k3"] == 0.2478
    assert Camera.guess((1280, 720), 60).fov_deg[0] == pytest.approx(60)
    values = cv2.calibrationMatrixValues(paper_camera.K, (1280, 720), 1, 1)
    # OpenCV measures from the principal point to both borders; here the pinhole is centred.
    assert paper_camera.fov_deg[0] == pytest.approx(values[0], abs=0.01)
    assert not paper_camera.without_distortion().distortion.any()


def test_numbers_that_are_no_camera() -> None:
    with pytest.raises(CalibrationError, match="no pixels"):
        Camera(0, 720, 1, 1, 0, 0)
    with pytest.raises(CalibrationError, match="positive focal"):
        Camera(10, 10, -1, 1, 0, 0)
    with pytest.raises(CalibrationError, match="fewer"):
        Camera.from_opencv(np.eye(3), np.ones(14), (10, 10))

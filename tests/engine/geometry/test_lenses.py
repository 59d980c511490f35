"""Every lens model against OpenCV and finite differences."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import LENSES, lens_called
from venus3d.engine.geometry.pose import Array, Pose

COEFFICIENTS: dict[str, tuple[float, ...]] = {
    "pinhole": (),
    "brown3": (-0.25, 0.08, -0.01),
    "brown4": (-0.25, 0.08, 0.002, -0.003),
    "brown5": (-0.25, 0.08, 0.002, -0.003, -0.01),
    "rational": (0.4, 0.05, 0.002, -0.003, 0.01, 0.7, 0.1, 0.005),
    "rational-thin-prism": (
        *(0.4, 0.05, 0.002, -0.003, 0.01, 0.7, 0.1, 0.005),
        *(0.003, -0.001, -0.002, 0.001),
    ),
    "equidistant": (),
    "fisheye": (0.02, -0.01, 0.003, -0.0007),
}
VECTORS = np.array([[20.0, -30, 10, 0.05, -0.04, 0.5], [-35, 5, 80, -0.2, 0.1, 0.6]])


def camera_with(name: str) -> Camera:
    lens = lens_called(name)
    values = COEFFICIENTS[name]
    return Camera(1280, 720, 620, 630, 645, 355, coefficients=values, lens=lens)


def opencv(camera: Camera, points: Array, pose: Pose) -> tuple[Array, Array]:
    """Pixels (M, 2) and their derivatives (2 M, k) by rotation, translation, f, c, coefficients."""
    rvec, t = pose.rvec, pose.t
    if camera.lens.is_perspective:
        d = {"brown3": lambda k: [k[0], k[1], 0, 0, k[2]]}.get(camera.lens.name, list)(
            camera.coefficients
        )
        pixels, J = cv2.projectPoints(points, rvec, t, camera.K, np.array(d or [0.0] * 4))
        if camera.lens.name == "brown3":
            J = np.delete(J, [12, 13], axis=1)
        return pixels.reshape(-1, 2), J[:, : 10 + len(camera.coefficients)]
    D = np.array([*camera.coefficients, *[0.0] * 4])[:4]
    pixels, J = cv2.fisheye.projectPoints(points[None], rvec, t, camera.K, D)
    # Columns: f, c, four coefficients, rotation, translation.
    order = [8, 9, 10, 11, 12, 13, 0, 1, 2, 3, *range(4, 4 + len(camera.coefficients))]
    return pixels.reshape(-1, 2), J[:, order]


@pytest.mark.parametrize("name", LENSES)
def test_projection_and_derivatives_are_opencvs(name: str) -> None:
    camera = camera_with(name)
    points = np.array([[x, y, 0.01 * x * y] for x in (-0.2, 0.03, 0.15) for y in (-0.1, 0.0, 0.2)])
    for vector in VECTORS:
        pose = Pose.from_vector(vector)
        pixels, J = opencv(camera, points, pose)
        found, intrinsic, by_pose = camera.project_with_jacobians(
            points, pose.R[None], pose.t[None]
        )
        np.testing.assert_allclose(found[0], pixels, atol=1e-9)
        np.testing.assert_allclose(camera.project(pose.apply(points)), pixels, atol=1e-9)
        p = intrinsic.shape[-1]
        np.testing.assert_allclose(intrinsic[0].reshape(-1, p), J[:, 6:], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(
            by_pose[0, ..., 3:].reshape(-1, 3), J[:, 3:6], rtol=1e-9, atol=1e-8
        )


@pytest.mark.parametrize("name", LENSES)
def test_derivatives_are_the_slopes(name: str) -> None:
    camera = camera_with(name)
    points = np.array([[0.1, -0.05, 0.3], [0.0, 0.0, 0.5], [1e-5, 0, 0.4], [-0.3, 0.2, 0.35]])
    if not camera.lens.is_perspective:
        points = np.concatenate([points, [[0.3, 0.1, 0.0], [-0.2, 0.3, -0.05]]])
    here = (np.eye(3)[None], np.zeros((1, 3)))
    _, intrinsic, by_pose = camera.project_with_jacobians(points, *here)
    for column in range(3):
        h = 1e-6 * np.eye(3)[column]
        slope = (camera.pixels_of((points + h).T) - camera.pixels_of((points - h).T)) / 2e-6
        np.testing.assert_allclose(by_pose[0, :, :, 3 + column], slope.T, rtol=1e-6, atol=2e-4)
    for column, value in enumerate(camera.parameters):
        h = 1e-6 * max(abs(value), 0.01) * np.eye(len(camera.parameters))[column]
        ends = [
            Camera.from_parameters(camera.parameters + sign * h, camera.image_size, camera.lens)
            for sign in (1, -1)
        ]
        slope = (ends[0].pixels_of(points.T) - ends[1].pixels_of(points.T)) / (2 * h.sum())
        np.testing.assert_allclose(intrinsic[0, :, :, column], slope.T, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("name", LENSES)
def test_rays_are_the_inverse_of_the_projection(name: str) -> None:
    camera = camera_with(name)
    u, v = np.meshgrid(np.linspace(0, 1279, 9), np.linspace(0, 719, 7))
    pixels = np.stack([u, v], axis=-1)
    rays = camera.unproject(pixels)
    assert rays.shape == (7, 9, 3)
    np.testing.assert_allclose(np.linalg.norm(rays, axis=-1), 1.0, atol=1e-12)
    np.testing.assert_allclose(camera.project(rays), pixels, atol=1e-8)
    np.testing.assert_allclose(camera.unproject([camera.cx, camera.cy]), [0, 0, 1], atol=1e-12)


def test_a_fisheye_sees_behind_itself() -> None:
    camera = Camera(1000, 1000, 280, 280, 499.5, 499.5, lens=lens_called("equidistant"))
    behind = np.array([np.sin(np.radians(100)), 0, np.cos(np.radians(100))])
    pixel = camera.project(behind)
    np.testing.assert_allclose(pixel, [499.5 + 280 * np.radians(100), 499.5])
    np.testing.assert_allclose(camera.unproject(pixel), behind, atol=1e-12)
    assert np.isnan(camera_with("brown5").project(behind)).all()


@pytest.mark.parametrize("name", ["rational", "fisheye"])
def test_the_limit_is_where_the_image_radius_stops_growing(name: str) -> None:
    values = {
        "rational": (-0.4, 0.02, 0, 0, 0.01, 0.1, 0.02, 0.0),
        "fisheye": (-0.1, 0.01, -0.02, 0.0),
    }[name]
    camera = Camera(1280, 720, 600, 600, 640, 360, coefficients=values, lens=lens_called(name))
    limit = camera.angle_limit
    angles = np.linspace(0, limit, 2000)
    radius = camera.pixels_of(np.stack([np.sin(angles), 0 * angles, np.cos(angles)]))[0]
    assert 0.5 < limit < 3 and (np.diff(radius) > 0).all()
    beyond = np.array([np.sin(limit + 0.01), 0, np.cos(limit + 0.01)])
    assert camera.pixels_of(beyond)[0] < radius[-1]
    assert np.isnan(camera.project(beyond)).all()
    assert np.isnan(camera.unproject([640 + 1.01 * (radius[-1] - 640), 360])).all()


def test_coefficients_by_place_and_by_name() -> None:
    lens = lens_called("fisheye")
    camera = Camera(640, 480, 300, 300, 320, 240, 0.1, 0.02, lens=lens)
    assert camera == Camera(640, 480, 300, 300, 320, 240, k1=0.1, k2=0.02, lens=lens)
    assert camera.parameter_names == ("fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4")
    assert camera.named["k2"] == 0.02 and camera.coefficients == (0.1, 0.02, 0.0, 0.0)
    with pytest.raises(CalibrationError, match="k1, k2, k3, k4"):
        Camera(640, 480, 300, 300, 320, 240, p1=0.1, lens=lens)
    with pytest.raises(CalibrationError, match="fisheye"):
        lens_called("no-lens")

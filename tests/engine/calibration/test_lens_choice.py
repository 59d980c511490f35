"""Which lens: by simulated corners of each, and the held-out prediction by real refits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.lens_choice import (
    calibrate_with_any_lens,
    held_out_squares,
)
from venus3d.engine.calibration.observation import Observation, reprojection_errors
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.field_of_view import fields_of_view_deg
from venus3d.engine.geometry.lenses import BROWN5, FISHEYE, RATIONAL
from venus3d.engine.geometry.pose import Pose

BOARD = Board()
BROWN = Camera(1280, 720, 620, 625, 640, 355, -0.22, 0.06, 1e-3, -5e-4, -0.006)
WIDE = Camera(1280, 720, 390, 392, 645, 352, 0.01, -0.004, 1e-3, 0, lens=FISHEYE)


def seen_by(camera: Camera, count: int, rng: np.random.Generator) -> list[Observation]:
    """Views of the whole board all over the image, tilted in all directions."""
    found: list[Observation] = []
    while len(found) < count:
        uv = rng.uniform(0, 1, 2) * camera.image_size
        ray = camera.unproject(uv)
        tilt = rng.uniform(-40, 40, 3)
        turn = Pose.from_vector([*tilt, 0, 0, 0])
        # About the line of sight, so that a board beside the camera is seen from the front.
        angle = np.arccos(ray[2])
        axis = np.array([-ray[1], ray[0], 0]) / max(np.hypot(ray[0], ray[1]), 1e-9)
        pose = Pose(
            Pose.from_rvec_tvec(angle * axis, np.zeros(3)).R @ turn.R, rng.uniform(0.25, 0.5) * ray
        )
        pixels = camera.project(pose.apply(BOARD.corners))
        inside = ((pixels > 5) & (pixels < np.array(camera.image_size) - 6)).all(axis=1)
        if inside.all():
            noisy = pixels + rng.normal(0, 0.1, pixels.shape)
            found.append(Observation(np.arange(len(noisy)), noisy, camera.image_size))
    return found


@pytest.mark.parametrize("truth", [BROWN, WIDE])
def test_the_lens_is_found_out(truth: Camera) -> None:
    views = seen_by(truth, 12, np.random.default_rng(3))
    found = calibrate_with_any_lens(BOARD, views)
    assert found.camera.lens == truth.lens
    off = (found.camera.parameters - truth.parameters) / found.sigma
    assert np.abs(off).max() < 4
    assert bool(found.lens_reason) == (truth.lens is FISHEYE)
    if truth is WIDE:
        assert f"{fields_of_view_deg(truth)[0]:.0f}° across" in found.lens_reason


def test_a_wide_rational_lens_starts_where_no_pinhole_does() -> None:
    views = seen_by(WIDE, 12, np.random.default_rng(5))
    views = [one for one in views if np.abs(one.corners - [640, 360]).max() < 430][:12]
    found = calibrate(BOARD, views, lens=RATIONAL)
    assert found.rms_px < 0.2


def test_held_out_views_are_predicted_as_refits_do() -> None:
    views = seen_by(BROWN, 10, np.random.default_rng(4))
    found = calibrate(BOARD, views)
    told = held_out_squares(found)
    for left in (0, 4):
        others = calibrate(
            BOARD, [one for index, one in enumerate(views) if index != left], start=found.camera
        )
        pose = estimate_pose(others.camera, BOARD, views[left], found.views[left].pose)
        assert pose is not None
        errors = reprojection_errors(others.camera, BOARD, views[left], pose)
        assert told[left] == pytest.approx(float((errors**2).sum()), rel=0.02)
        assert told[left] > found.views[left].errors.size * found.views[left].rms_px ** 2 / 2


def test_a_pose_is_found_beside_the_lens() -> None:
    camera = Camera(1000, 1000, 300, 300, 499.5, 499.5, lens=FISHEYE)
    ray = np.array([np.sin(1.45), 0, np.cos(1.45)])
    pose = Pose.from_rvec_tvec([0.0, 1.3, 0.0], 0.3 * ray)
    pixels = camera.project(pose.apply(BOARD.corners))
    assert np.isfinite(pixels).all() and pose.apply(BOARD.corners)[:, 2].min() < 0
    seen = Observation(np.arange(len(pixels)), pixels, camera.image_size)
    found = estimate_pose(camera, BOARD, seen)
    assert found is not None
    np.testing.assert_allclose(found.matrix, pose.matrix, atol=1e-6)


def test_square_pixels_share_one_focal_length() -> None:
    truth = replace(WIDE, fy=WIDE.fx)
    views = seen_by(truth, 8, np.random.default_rng(6))
    found = calibrate(BOARD, views, lens=FISHEYE, square_pixels=True)
    assert found.camera.fx == found.camera.fy and found.sigma[0] == found.sigma[1] > 0
    assert abs(found.camera.fx - truth.fx) < 4 * found.sigma[0]
    assert found.sigma[0] < calibrate(BOARD, views, lens=FISHEYE).sigma[0]
    assert calibrate(BOARD, views, lens=BROWN5).rms_px > 2 * found.rms_px

"""The image circle, in real pictures behind an artificial rim, and what it bounds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.dark_rim import image_circle
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import uncertainty_map
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.image_circle import ImageCircle, common_circle
from venus3d.engine.geometry.lenses import FISHEYE
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits

CIRCLE = ImageCircle(330.0, 228.0, 300.0)
CAMERA = Camera(640, 480, 190, 190, 322, 236, lens=FISHEYE)


def behind_a_rim(image: NDArray[np.uint8], circle: ImageCircle) -> NDArray[np.uint8]:
    """The picture as a lens with this image circle shows it: a soft rim, noise in the dark."""
    h, w = image.shape[:2]
    v, u = np.mgrid[:h, :w]
    room = circle.room(np.stack([u, v]).astype(np.float64))
    shade = np.clip(room / 6 + 0.5, 0, 1)
    noise = np.random.default_rng(0).normal(5, 2, (h, w))
    rgb = image.reshape(h, w, -1) * shade[..., None] + noise[..., None]
    return np.clip(rgb, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("circle", [CIRCLE, ImageCircle(316, 243, 250), ImageCircle(320, 240, 345)])
def test_a_rim_is_found_to_a_hundredth_and_nothing_else_is_one(
    shared_data: Path, circle: ImageCircle
) -> None:
    pictures = sorted((shared_data / "checkerboard-9x6").glob("*.jpg"))
    images = [cv2.imread(str(path)) for path in pictures]
    assert len(images) > 10 and all(image_circle(np.asarray(one)) is None for one in images)
    found = [image_circle(behind_a_rim(np.asarray(one), circle)) for one in images]
    assert sum(one is not None for one in found) > 0.8 * len(images)
    together = common_circle(found)
    assert together is not None
    miss = np.hypot(together.x - circle.x, together.y - circle.y)
    assert max(miss, abs(together.radius - circle.radius)) < 0.012 * circle.radius


def test_a_circle_in_few_of_the_pictures_is_none() -> None:
    assert common_circle([CIRCLE, None]) is None and common_circle([]) is None
    assert common_circle([CIRCLE, None, CIRCLE]) == CIRCLE


def test_rays_maps_and_targets_end_at_the_rim() -> None:
    camera, board = replace(CAMERA, image_circle=CIRCLE), Board()
    inside, outside = [330.0, 228.0 + 235], [12.0, 8.0]
    assert np.isfinite(CAMERA.unproject([inside, outside])).all()
    rays = camera.unproject([inside, outside])
    np.testing.assert_allclose(rays[0], CAMERA.unproject(inside))
    assert np.isnan(rays[1]).all()
    seen = np.isfinite(uncertainty_map(camera, np.eye(8), (32, 24)))
    cells = np.stack(np.meshgrid((np.arange(32) + 0.5) * 20, (np.arange(24) + 0.5) * 20)) - 0.5
    np.testing.assert_array_equal(seen, np.hypot(*(cells - [[[330]], [[228]]])) <= 300)
    # A board that touches the dark: all of it in the picture, not all of it in the circle.
    circle = replace(CIRCLE, radius=250.0)
    camera = replace(CAMERA, image_circle=circle)
    towards = CAMERA.unproject([100.0, 66.0])
    pose = Pose.from_vector([0, 0, 0, *(0.5 * towards)])
    corners = CAMERA.project(pose.apply(board.outline))
    assert (corners > 0).all() and not circle.contains(corners).all()
    limits = Limits(max_tilt_deg=90, min_square_px=1, max_depth_ratio=9, margin=0)
    vector = pose.vector()[None]
    assert limits.accepts(CAMERA, board, vector).all()
    assert not limits.accepts(camera, board, vector).any()
    half = CAMERA.scaled((320, 240)).project(pose.apply(board.outline))
    scaled = camera.scaled((320, 240)).image_circle
    assert scaled is not None
    np.testing.assert_array_equal(scaled.contains(half), circle.contains(corners))


def test_a_calibration_has_the_circle_of_its_pictures_unless_corners_are_outside() -> None:
    board, rng = Board(), np.random.default_rng(3)
    views = []
    for _ in range(6):
        angles, place = rng.uniform(-30, 30, 3), rng.uniform(-0.06, 0.06, 2)
        pose = Pose.from_vector([*angles, *place, 0.35])
        corners = CAMERA.project(pose.apply(board.corners)) + rng.normal(0, 0.1, (40, 2))
        views.append(Observation(np.arange(40), corners, (640, 480), image_circle=CIRCLE))
    assert calibrate(board, views, lens=FISHEYE).camera.image_circle == CIRCLE
    small = [replace(view, image_circle=replace(CIRCLE, radius=60.0)) for view in views]
    assert calibrate(board, small, lens=FISHEYE).camera.image_circle is None
    unlooked = [replace(view, image_circle=None) for view in views]
    assert calibrate(board, unlooked, lens=FISHEYE).camera.image_circle is None

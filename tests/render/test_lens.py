"""The lens map against OpenCV's own distortion."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.camera import Camera
from venus3d.render.lens import lens_for


@pytest.mark.parametrize("size", [(1280, 720), (960, 540)])
def test_map_leads_to_the_ray_that_opencv_projects_there(
    paper_camera: Camera, size: tuple[int, int]
) -> None:
    camera = paper_camera.scaled(size)
    lens = lens_for(camera)
    assert lens.map_xy is not None
    v, u = np.mgrid[0 : size[1] : 37, 0 : size[0] : 41].reshape(2, -1)
    inside = lens.map_xy[v, u].astype(np.float64)
    ideal = lens.ideal
    rays = (inside - [ideal.cx, ideal.cy]) / [ideal.fx, ideal.fy]
    points = np.column_stack([rays, np.ones(len(rays))])
    pixels, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), camera.K, camera.distortion)
    np.testing.assert_allclose(pixels[:, 0], np.column_stack([u, v]), atol=2e-3)
    assert (inside > 0.5).all()
    assert (inside < np.array(ideal.image_size) - 1.5).all()


def test_a_perfect_lens_bends_nothing(paper_camera: Camera) -> None:
    lens = lens_for(paper_camera.without_distortion())
    picture = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
    assert lens.ideal == lens.camera
    assert lens.bend(picture, (0, 0, 0)) is picture


def test_pixels_that_no_ray_reaches_get_the_border(paper_camera: Camera) -> None:
    # A polynomial that folds back inside the image, as early calibrations may have.
    wild = replace(paper_camera, k1=-1.2, k2=0.0, k3=0.0, p1=0.0, p2=0.0)
    lens = lens_for(wild)
    white = np.full((lens.ideal.height, lens.ideal.width, 3), 255, dtype=np.uint8)
    bent = lens.bend(white, (9, 8, 7))
    np.testing.assert_array_equal(bent[0, 0], (9, 8, 7))
    np.testing.assert_array_equal(bent[355, 635], (255, 255, 255))


def test_a_strong_lens_keeps_the_ideal_picture_small(paper_camera: Camera) -> None:
    strong = replace(paper_camera, k1=-0.45, k2=0.0, k3=0.0, p1=0.0, p2=0.0, fx=500, fy=500)
    lens = lens_for(strong)
    assert lens.ideal.width <= 2.1 * strong.width
    assert lens.ideal.height <= 2.1 * strong.height

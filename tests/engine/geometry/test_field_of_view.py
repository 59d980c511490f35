"""How far a camera sees."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.field_of_view import fields_of_view_deg
from venus3d.engine.geometry.lenses import EQUIDISTANT, FISHEYE


def test_the_fields_of_view_are_opencvs(paper_camera: Camera) -> None:
    w, h = paper_camera.image_size
    cx, cy = paper_camera.cx, paper_camera.cy
    ends = np.array([[-0.5, cy], [w - 0.5, cy], [cx, -0.5], [cx, h - 0.5], [-0.5, -0.5]])
    ends = np.vstack([ends, [[w - 0.5, h - 0.5]]])[:, None]
    xy: Any = cv2.undistortPoints(ends, paper_camera.K, paper_camera.distortion)
    rays = np.concatenate([xy[:, 0], np.ones((6, 1))], axis=1)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    angles = [np.degrees(np.arccos(rays[i] @ rays[i + 1])) for i in (0, 2, 4)]
    np.testing.assert_allclose(fields_of_view_deg(paper_camera), angles, atol=1e-4)
    pinhole = paper_camera.without_distortion()
    left, right = (cx + 0.5) / pinhole.fx, (w - 0.5 - cx) / pinhole.fx
    expected = np.degrees(np.arctan(left) + np.arctan(right))
    assert fields_of_view_deg(pinhole)[0] == pytest.approx(expected)


def test_a_lens_that_sees_behind_itself_has_more_than_half_a_turn() -> None:
    f = 640 / np.radians(100)
    camera = Camera(1280, 720, f, f, 639.5, 359.5, lens=EQUIDISTANT)
    across, down, diagonal = fields_of_view_deg(camera)
    assert across == pytest.approx(200)
    assert down == pytest.approx(200 * 720 / 1280)
    assert diagonal == pytest.approx(200 * np.hypot(1280, 720) / 1280)


def test_an_image_circle_inside_the_picture_ends_the_field() -> None:
    f = 300 / np.radians(90)
    camera = replace(
        Camera(1280, 720, f, f, 639.5, 359.5, lens=EQUIDISTANT),
        lens=FISHEYE,
        coefficients=(-0.12, 0.0, 0.0, 0.0),
    )
    across, *_ = fields_of_view_deg(camera)
    assert across == pytest.approx(2 * np.degrees(camera.angle_limit), abs=4)

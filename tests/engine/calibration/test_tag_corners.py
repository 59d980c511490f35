"""Corners of tags: where a lens bends their edges, where they are small, where one is hidden."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.engine.board_pictures import picture_of
from tests.engine.calibration.test_legible_tags import APRILGRID, CAMERA, GRID
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

BARREL = Camera(640, 480, 420, 420, 320, 240, -0.3, 0.09)
FACING = Pose.from_vector([0, 0, 0, 0, 0, 0.19])


def outward_px(board: Board, camera: Camera, pose: Pose) -> float:
    """By how much the corners found lie farther from the principal point than they are."""
    rng = np.random.default_rng(5)
    picture = picture_of(board, camera, pose, noise=1.0, rng=rng)
    seen = Detector(board, find_layout=False).detect(picture)
    assert seen.count == board.corner_count
    truth = camera.project(pose.apply(board.points_of(seen.ids)))
    away = truth - [camera.cx, camera.cy]
    unit = away / np.linalg.norm(away, axis=1, keepdims=True)
    return float(((seen.corners - truth) * unit).sum(axis=1).mean())


def test_edges_bent_by_the_lens_are_not_taken_for_straight() -> None:
    """Lines through the middles of bent edges met too far outside: on a fisheye's
    pictures of a grid of markers the focal length was 11 sigma off."""
    assert abs(outward_px(GRID, BARREL, FACING)) < 0.03


def test_white_cells_near_an_edge_do_not_draw_it() -> None:
    """Small tags in a blurred picture were 0.2 px too wide: on a telephoto's pictures k2 was 7
    sigma off."""
    pose = Pose.from_vector([6, -6, 10, 0, 0, 900 * GRID.square / 28])
    picture = picture_of(GRID, CAMERA, pose, noise=2.0, rng=np.random.default_rng(2))
    seen = Detector(GRID, find_layout=False).detect(cv2.GaussianBlur(picture, (0, 0), 0.9))
    truth = CAMERA.project(pose.apply(GRID.points_of(seen.ids)))
    sides = [
        np.linalg.norm(np.diff(corners.reshape(-1, 4, 2), axis=1), axis=2).mean()
        for corners in (seen.corners, truth)
    ]
    assert sides[0] == pytest.approx(sides[1], abs=0.08)


@pytest.mark.parametrize("contrast", [1.0, 0.3])
def test_small_tags_are_read_by_those_around_them(contrast: float) -> None:
    """Of an AprilGrid with 31 px from tag to tag, a quarter to two thirds were lost."""
    for turn in (-20, 10, 40):
        pose = Pose.from_vector([6, -6, turn, 0, 0, 900 * APRILGRID.square / 31])
        picture = picture_of(
            APRILGRID, CAMERA, pose, noise=2.0 * contrast, rng=np.random.default_rng(turn + 20)
        )
        faint = np.rint(90 + contrast * (picture.astype(float) - 90)).clip(0, 255).astype(np.uint8)
        seen = Detector(APRILGRID, find_layout=False).detect(faint)
        assert seen.count > 0.95 * APRILGRID.corner_count
        errors = seen.corners - CAMERA.project(pose.apply(APRILGRID.points_of(seen.ids)))
        assert np.sqrt((errors**2).mean()) < 0.15


def test_a_tag_with_a_covered_corner_is_not_read() -> None:
    board = APRILGRID
    pose = Pose.from_vector([6, -6, 10, 0, 0, 900 * board.square / 50])
    picture = picture_of(board, CAMERA, pose, noise=2.0, rng=np.random.default_rng(1))
    tag = 9
    corner = CAMERA.project(pose.apply(board.points_of(np.array([4 * tag + 1]))))[0]
    cv2.circle(picture, [round(v) for v in corner.tolist()], 7, (110,), -1)
    seen = Detector(board, find_layout=False).detect(picture)
    assert not np.isin(4 * tag + np.arange(4), seen.ids).any()
    assert seen.count >= board.corner_count - 16  # its neighbours may be touched

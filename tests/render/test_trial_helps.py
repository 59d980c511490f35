"""The trial's helps in the picture, against OpenCV's own projection."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.trial_helps import (
    AXIS_COLOURS,
    OVERLAP_FILL,
    TARGET_FILL,
    draw_axes,
    draw_outline,
)

Draw = Callable[[NDArray[np.uint8], Camera, Board, Pose | None, Pose], None]
NOW = Pose.from_vector([10, -20, 5, -0.05, 0.02, 0.5])
TARGET = Pose.from_vector([-25, 30, 20, 0.06, -0.03, 0.45])


def grey(width: int = 1280) -> NDArray[np.uint8]:
    return np.full((width * 9 // 16, width, 3), 128, np.uint8)


def seen(camera: Camera, pose: Pose, points: Array) -> Array:
    pixels, _ = cv2.projectPoints(points, pose.rvec, pose.t, camera.K, camera.distortion)
    return np.asarray(pixels, np.float64).reshape(-1, 2)


def silhouette(camera: Camera, board: Board, pose: Pose) -> NDArray[np.bool_]:
    mask = np.zeros((camera.height, camera.width), np.uint8)
    ring = np.vstack([board.outline, board.outline[:1]])
    along = np.linspace(0, 1, 20)[:, None]
    around = np.concatenate([a + along * (b - a) for a, b in pairwise(ring)])
    cv2.fillPoly(mask, [np.round(seen(camera, pose, around)).astype(np.int32)], 1)
    return mask > 0


def nearest_px(rgb: NDArray[np.uint8], colour: tuple[int, int, int], place: Array) -> float:
    """How far from `place` the nearest pixel of this colour is."""
    y, x = np.nonzero(np.abs(rgb.astype(int) - colour).max(axis=2) < 12)
    return float(np.hypot(x - place[0], y - place[1]).min()) if x.size else float("inf")


def test_solid_axes_end_where_opencv_sees_their_ends(
    paper_camera: Camera, default_board: Board
) -> None:
    rgb = grey()
    draw_axes(rgb, paper_camera, default_board, NOW, TARGET)
    # As drawFrameAxes: from the board's centre along its own X, Y and Z.
    length = 0.95 * 0.6 * min(default_board.width, default_board.height)
    for axis, colour in enumerate(AXIS_COLOURS):
        tip = seen(paper_camera, NOW, length * np.eye(3)[axis : axis + 1])[0]
        assert nearest_px(rgb, colour, tip) < 4


def test_the_filled_outline_is_the_targets_silhouette(
    paper_camera: Camera, default_board: Board
) -> None:
    rgb = grey()
    draw_outline(rgb, paper_camera, default_board, None, TARGET)
    tint = np.round(0.4 * 128 + 0.6 * np.array(TARGET_FILL))
    filled = np.abs(rgb - tint).max(axis=2) <= 1
    wanted = silhouette(paper_camera, default_board, TARGET)
    # All but the line around it.
    assert (filled & ~wanted).mean() < 1e-4
    assert 0.9 < filled.sum() / wanted.sum() <= 1.0


def test_what_the_board_covers_is_told_apart(paper_camera: Camera, default_board: Board) -> None:
    rgb = grey()
    draw_outline(rgb, paper_camera, default_board, NOW, TARGET)
    tint = np.round(0.4 * 128 + 0.6 * np.array(OVERLAP_FILL))
    covered = np.abs(rgb - tint).max(axis=2) <= 1
    common = silhouette(paper_camera, default_board, TARGET)
    common &= silhouette(paper_camera, default_board, NOW)
    assert (covered & ~common).mean() < 1e-4
    assert 0.85 < covered.sum() / common.sum() <= 1.0


def test_a_smaller_picture_shows_the_same(paper_camera: Camera, default_board: Board) -> None:
    rgb = grey(640)
    draw_outline(rgb, paper_camera, default_board, None, TARGET)
    tint = np.round(0.4 * 128 + 0.6 * np.array(TARGET_FILL))
    filled = np.abs(rgb - tint).max(axis=2) <= 1
    whole = silhouette(paper_camera, default_board, TARGET).astype(np.float32)
    wanted = cv2.resize(whole, (640, 360), interpolation=cv2.INTER_AREA) > 0
    assert (filled & ~wanted).mean() < 1e-4
    assert 0.85 < filled.sum() / wanted.sum() <= 1.0


@pytest.mark.parametrize("draw", [draw_axes, draw_outline])
@pytest.mark.parametrize(
    "place",
    [[0, 0, 0, 0, 0, -0.5], [0, 85, 0, 0, 0, 0.05], [0, 0, 0, 5, 0, 0.01], [70, 0, 0, 0, 0, 0.08]],
)
def test_a_board_behind_or_beside_the_lens_breaks_nothing(
    draw: Draw, place: list[float], paper_camera: Camera, default_board: Board
) -> None:
    rgb = grey()
    with np.errstate(all="raise"):
        draw(rgb, paper_camera, default_board, Pose.from_vector(place), TARGET)

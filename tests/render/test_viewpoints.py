"""The four views: what must be seen is seen, and left and right are where a person expects them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array
from venus3d.lessons.lesson import VIEWPOINTS, Viewpoint
from venus3d.render.viewpoints import SceneCamera, between, view_abreast, view_from


def in_window(view: SceneCamera, points: Array, aspect: float) -> Array:
    """(N, 2) places in the window, -1 ... 1 to the right and down; OpenCV's projection."""
    f = 1 / np.tan(view.fov_rad / 2)
    K = np.array([[f / aspect, 0, 0], [0, f, 0], [0, 0, 1.0]])
    R = view.axes
    pixels, _ = cv2.projectPoints(points, cv2.Rodrigues(R)[0], -R @ view.position, K, None)
    return np.asarray(pixels, np.float64).reshape(-1, 2)


@pytest.mark.parametrize("viewpoint", ["outside", "holder", "above"])
@pytest.mark.parametrize("aspect", [0.7, 1.0, 2.2])
def test_all_is_seen_and_no_more_than_needed(
    viewpoint: Viewpoint, aspect: float, paper_camera: Camera, rng: np.random.Generator
) -> None:
    for _ in range(20):
        points = rng.uniform([-0.4, -0.3, 0], [0.4, 0.3, 1.2], (12, 3))
        view = view_from(viewpoint, paper_camera, points, aspect)
        window = in_window(view, points, aspect)
        assert np.abs(window).max() <= 0.881
        assert np.abs(window).max() > 0.85, "farther away than it must be"
        assert ((points - view.position) @ view.axes[2] > 0).all()


@pytest.mark.parametrize("aspect", [0.5, 1.2, 16 / 9, 2.5])
def test_through_the_camera_the_window_holds_its_picture(
    aspect: float, paper_camera: Camera
) -> None:
    view = view_from("camera", paper_camera, [[0, 0, 0.5]], aspect)
    corners = np.array([[0, 0], [1279, 0], [1279, 719], [0, 719.0]])
    rays = paper_camera.without_distortion().unproject(corners)
    window = in_window(view, rays, aspect)
    assert np.abs(window).max() < 1.0 < np.abs(window).max() + 0.08
    assert not view.position.any()


def test_right_is_where_it_belongs(paper_camera: Camera) -> None:
    points = np.array([[0.1, 0, 0.5], [-0.1, 0, 0.5], [0, 0, 0.7], [0, -0.1, 0.5]])

    def seen(viewpoint: Viewpoint) -> Array:
        return in_window(view_from(viewpoint, paper_camera, points, 1.0), points, 1.0)

    for viewpoint in ("outside", "camera", "above"):
        right, left, *_ = seen(viewpoint)
        assert right[0] > left[0], viewpoint
    right, left, *_ = seen("holder")
    assert right[0] < left[0], "the holder faces the camera"
    for viewpoint in ("outside", "camera", "holder"):
        up = seen(viewpoint)[3]
        assert up[1] < seen(viewpoint)[:2, 1].mean(), viewpoint
    assert seen("above")[2, 1] < seen("above")[0, 1], "farther from the camera is farther up"


@pytest.mark.parametrize("viewpoint", VIEWPOINTS)
@pytest.mark.parametrize("aspect", [0.48, 1.0, 2.0])
def test_equal_boards_side_by_side_look_equal(viewpoint: Viewpoint, aspect: float) -> None:
    """From nearby the one on the left shows its right side and looks like another pose."""
    flat = np.array(
        [[-0.126, -0.084, 0], [0.126, -0.084, 0], [0.126, 0.084, 0], [-0.126, 0.084, 0]]
    )
    board = flat @ cv2.Rodrigues(np.array([0.5, 0.4, 0.2]))[0].T
    row = np.array([[[side * 0.185, 0, 0.6]] for side in (-1, 1)])
    boards = (board + row).reshape(-1, 3).astype(np.float64)
    view = view_abreast(viewpoint, boards, aspect)
    left, right = in_window(view, boards, aspect).reshape(2, 4, 2) * [aspect, 1.0]
    shift = (right - left).mean(axis=0)
    assert np.abs(left + shift - right).max() < 0.06 * np.ptp(left, axis=0).max()
    right_is = -1 if viewpoint == "holder" else 1
    assert right_is * shift[0] > 0 and abs(shift[1]) < 0.02 * abs(shift[0]), "in a level row"


def test_a_flight_begins_and_ends_at_its_views_and_keeps_its_distance(
    paper_camera: Camera, rng: np.random.Generator
) -> None:
    points = rng.uniform([-0.2, -0.2, 0.3], [0.2, 0.2, 0.6], (8, 3))
    views = [view_from(v, paper_camera, points, 1.3) for v in VIEWPOINTS]
    for start in views:
        for end in views:
            np.testing.assert_allclose(between(start, end, 0).position, start.position, atol=1e-9)
            np.testing.assert_allclose(between(start, end, 1).position, end.position, atol=1e-9)
            arms = [np.linalg.norm(v.position - v.look_at) for v in (start, end)]
            for fraction in np.linspace(0, 1, 11):
                view = between(start, end, float(fraction))
                arm = np.linalg.norm(view.position - view.look_at)
                assert min(arms) - 1e-9 <= arm <= max(arms) + 1e-9

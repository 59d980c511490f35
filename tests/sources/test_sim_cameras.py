"""The simulated cameras, also those that see beside and behind the lens, against OpenCV."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.other_readings import turned_pose
from venus3d.engine.calibration.picture_quality import picture_quality
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.discs import disc_shifts
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.capture_refusal import refusal
from venus3d.render.offscreen import Offscreen
from venus3d.sources.interactive import open_interactive
from venus3d.sources.sim import Simulation
from venus3d.sources.sim_cameras import FIELD_DEG, SIM_CAMERAS, SimCamera, simulated_camera


def facing(away_deg: float, around_deg: float, distance: float) -> Pose:
    """A board that faces the lens from a direction, turned a little out of it."""
    away, around = np.radians([away_deg, around_deg])
    z = np.array([np.sin(away) * np.cos(around), np.sin(away) * np.sin(around), np.cos(away)])
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z], axis=1) @ Pose.from_vector([15, -10, 4, 0, 0, 1]).R
    return Pose(R, distance * z)


def opencv_pixels(camera: Camera, points: np.ndarray) -> np.ndarray:
    xyz = points.reshape(-1, 1, 3)
    nothing = np.zeros(3)
    if camera.lens.is_perspective:
        pixels, _ = cv2.projectPoints(xyz, nothing, nothing, camera.K, camera.distortion)
    else:
        pixels, _ = cv2.fisheye.projectPoints(xyz, nothing, nothing, camera.K, camera.distortion)
    return np.asarray(pixels).reshape(-1, 2)


@pytest.mark.parametrize("backend", ["gl", "painter"])
@pytest.mark.parametrize(("away", "around"), [(0, 0), (35, 200), (62, 10), (80, 175)])
def test_a_fisheyes_picture_shows_the_board_where_opencv_projects_it(
    backend: str, away: float, around: float
) -> None:
    camera, board, pose = SIM_CAMERAS["fisheye"], Board(), facing(away, around, 0.25)
    with Offscreen("gl" if backend == "gl" else "painter") as offscreen:
        simulation = Simulation(
            camera, board, autopilot=False, noise_sigma=0, offscreen=offscreen, start=pose,
            field_deg=FIELD_DEG["fisheye"],
        )  # fmt: skip
        frame = simulation.read()
    assert frame is not None
    seen = Detector(board).detect(frame.image)
    assert seen.count >= 24
    truth = opencv_pixels(camera, pose.apply(board.points_of(seen.ids)))
    misses = np.linalg.norm(seen.corners - truth, axis=1)
    assert np.sqrt((misses**2).mean()) < (0.15 if backend == "gl" else 0.3)


@pytest.mark.parametrize(
    ("name", "across_deg"), [("webcam", 63), ("action", 120), ("fisheye", 194), ("telephoto", 12)]
)
def test_the_cameras_see_as_far_as_they_say(name: SimCamera, across_deg: float) -> None:
    camera = SIM_CAMERAS[name]
    left, right = camera.unproject([[0, camera.cy], [camera.width - 1, camera.cy]])
    angles = [np.degrees(np.arctan2(np.hypot(*ray[:2]), ray[2])) for ray in (left, right)]
    assert sum(angles) == pytest.approx(across_deg, abs=1.5)
    ahead = np.array([[0.1, -0.05, 0.9], [-0.02, 0.03, 1.0]])
    np.testing.assert_allclose(camera.project(ahead), opencv_pixels(camera, ahead), atol=1e-8)


def test_a_fisheyes_corners_are_dark_and_its_board_may_be_held_aside() -> None:
    simulation = open_interactive(
        "sim", Board(), size=None, camera="fisheye", seed=1, headless=True, autopilot=False,
        speed=1.0,
    )  # fmt: skip
    assert isinstance(simulation, Simulation)
    try:
        aside = facing(80, 10, 0.4)
        simulation.move_to(aside)
        np.testing.assert_allclose(simulation.board_pose.t, aside.t, atol=1e-12)
        frame = simulation.read()
        assert frame is not None
        assert frame.image[[0, 0, -1, -1], [0, -1, 0, -1]].mean() < 6, "beyond the image circle"
        assert frame.image[360, 640].mean() > 60
        simulation.move_to(Pose(aside.R, np.array([0.4, 0.0, -0.3])))
        assert simulation.board_pose.t[2] > 0, "never behind the lens"
    finally:
        simulation.close()


def test_a_board_on_the_rim_of_the_image_circle_is_no_glare() -> None:
    """Corners that were not found were looked for where a homography has them: beside the board."""
    pose = facing(78, 350, 0.2)
    with Offscreen() as offscreen:
        simulation = Simulation(
            SIM_CAMERAS["fisheye"], autopilot=False, offscreen=offscreen, start=pose,
            field_deg=FIELD_DEG["fisheye"],
        )  # fmt: skip
        frame = simulation.read()
    assert frame is not None
    seen = Detector(Board()).detect(frame.image)
    assert 8 < seen.count < 40, "some are beyond the rim"
    quality = picture_quality(frame.image, Board(), seen)
    assert quality is not None and quality.washed_out == 0
    assert refusal(replace(seen, image=frame.image), Board()) is None


def test_circles_all_over_a_fisheyes_picture_are_found_and_no_glare() -> None:
    """Some are three times as large as others and three times as long as wide, and a homography
    does not say how large: no view was ever taken."""
    board = Board(9, 6, 0.028, 0.014, kind="asymmetric-circles")
    pose, truth = Pose.from_vector([-28, 17, -24, 0.059, 0.036, 0.12]), SIM_CAMERAS["fisheye"]
    with Offscreen() as offscreen:
        simulation = Simulation(
            truth, board, autopilot=False, offscreen=offscreen, start=pose,
            field_deg=FIELD_DEG["fisheye"],
        )  # fmt: skip
        frame = simulation.read()
    assert frame is not None
    seen = Detector(board).detect(frame.image)
    assert seen.count == board.corner_count and seen.centroids is not None
    quality = picture_quality(frame.image, board, seen)
    assert quality is not None and quality.washed_out == 0
    rivals = [(pose, seen.ids), (turned_pose(pose, 2), seen.ids)]  # it says no more
    off = [
        seen.centroids
        - truth.project(one.apply(board.points_of(ids)))
        - disc_shifts(truth, board, ids, one)
        for one, ids in rivals
    ]
    assert min(float(np.sqrt((part**2).sum(axis=1).mean())) for part in off) < 0.04


@pytest.mark.parametrize("name", SIM_CAMERAS)
@pytest.mark.parametrize(
    ("size", "first", "scale"),
    [((640, 480), (160, 0), 2 / 3), ((1280, 1024), (190, 0), 64 / 45), ((640, 320), (0, 40), 0.5)],
)
def test_a_picture_of_another_shape_is_the_middle_of_the_cameras_own(
    name: SimCamera, size: tuple[int, int], first: tuple[int, int], scale: float
) -> None:
    """As OpenCV projects, cut and then resized; squeezed pixels would be no camera's, and no guess
    would bring the board to its first place."""
    whole, part = SIM_CAMERAS[name], simulated_camera(name, size)
    points = np.array([[0.0, 0, 1], [0.02, -0.05, 1], [-0.06, 0.03, 1]])
    cut = (opencv_pixels(whole, points) + 0.5 - first) * scale - 0.5
    assert part.image_size == size and np.allclose(part.project(points), cut, atol=1e-9)
    assert part.fx / part.fy == pytest.approx(whole.fx / whole.fy, rel=1e-12)
    assert simulated_camera(name) == simulated_camera(name, whole.image_size) == whole

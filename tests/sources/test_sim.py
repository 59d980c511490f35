"""The simulated camera against the projection it claims to have, and against its own options."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from tests.sources.targets import random_poses, target_of
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.render.offscreen import Offscreen
from venus3d.sources.frame import Frame
from venus3d.sources.sim import NEAREST, Simulation, near_pose
from venus3d.sources.view_errors import ViewErrors


@pytest.fixture(scope="module")
def offscreen() -> Iterator[Offscreen]:
    with Offscreen() as renderer:
        yield renderer


def frame_of(simulation: Simulation) -> Frame:
    frame = simulation.read()
    assert frame is not None
    return frame


def still(offscreen: Offscreen, camera: Camera, **options: Any) -> Simulation:
    """A simulation without noise, blur and hand."""
    return Simulation(
        camera,
        autopilot=False,
        offscreen=offscreen,
        **{"noise_sigma": 0.0, "blur_sigma": 0.0, **options},
    )


def misses_px(seen: Observation, camera: Camera, board: Board, pose: Pose) -> np.ndarray:
    """(N, 2) found minus projected corners."""
    return seen.corners - camera.project(pose.apply(board.points_of(seen.ids)))


def distorted(camera: Camera) -> Camera:
    """A wide-angle lens that bends much more than the paper's."""
    return Camera(camera.width, camera.height, 800, 800, 650, 340, -0.28, 0.09, 0.001, -0.0015)


@pytest.mark.parametrize(
    ("board", "rms_px"),
    [
        (Board(kind="chessboard", columns=10, rows=7, square=0.025), 0.1),
        (Board(6, 4, 0.04, 0.03, "DICT_APRILTAG_36h11", kind="aprilgrid"), 0.1),
        (Board(6, 4, 0.04, 0.032, kind="aruco-grid"), 0.3),
    ],
)
def test_every_kind_of_board_is_printed_where_its_corners_are(
    offscreen: Offscreen, paper_camera: Camera, board: Board, rms_px: float
) -> None:
    """The picture of a tag grid is larger or smaller than its tags by the gaps between them."""
    pose = Pose.from_vector([25, -20, 8, 0.01, 0.0, 0.5])
    simulation = Simulation(
        paper_camera, board, autopilot=False, offscreen=offscreen, noise_sigma=0.0, start=pose
    )
    seen = Detector(board).detect(frame_of(simulation).image)
    assert seen.count == board.corner_count
    misses = misses_px(seen, paper_camera, board, pose)
    assert np.sqrt((misses**2).sum(axis=1).mean()) < rms_px
    assert np.abs(misses.mean(axis=0)).max() < 0.05


@pytest.mark.slow
@pytest.mark.parametrize(("lens", "rms_px"), [("paper", 0.05), ("wide", 0.06)])
def test_corners_are_where_the_camera_projects_them(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board, lens: str, rms_px: float
):
    """Per axis, over the whole range of valid poses. The wide lens shows smaller squares, from
    which corners are read a little less well, and bends some away altogether."""
    camera = paper_camera if lens == "paper" else distorted(paper_camera)
    simulation, detector = still(offscreen, camera), Detector(default_board)
    poses = random_poses(camera, default_board, 30)
    assert len(poses) >= 20
    misses = []
    for pose in poses:
        simulation.move_to(pose)
        seen = detector.detect(frame_of(simulation).image)
        assert seen.count >= 0.8 * default_board.corner_count
        misses.append(misses_px(seen, camera, default_board, pose))
    misses = np.concatenate(misses)
    assert np.sqrt((misses**2).mean(axis=0)).max() < rms_px
    assert np.abs(misses.mean(axis=0)).max() < 0.02


def test_a_board_that_leaves_the_picture_is_seen_in_part(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    simulation, detector = still(offscreen, paper_camera), Detector(default_board)
    for pose in (
        near_pose(paper_camera, default_board),
        Pose.from_vector([10, 20, 5, 0.20, 0.05, 0.35]),
        Pose.from_vector([-20, 0, 30, -0.05, -0.12, 0.3]),
    ):
        simulation.move_to(pose)
        pixels = paper_camera.project(pose.apply(default_board.corners))
        inside = ((pixels > 12) & (pixels < np.array([1280, 720]) - 12)).all(axis=1)
        seen = detector.detect(frame_of(simulation).image)
        assert 0.4 * inside.sum() < seen.count < default_board.corner_count
        assert np.sqrt((misses_px(seen, paper_camera, default_board, pose) ** 2).mean()) < 0.06


def test_the_start_is_too_near_for_the_whole_board(paper_camera: Camera, default_board: Board):
    for camera in (paper_camera, distorted(paper_camera)):
        pixels = camera.project(near_pose(camera, default_board).apply(default_board.corners))
        inside = ((pixels >= 0) & (pixels < [1280, 720])).all(axis=1)
        assert 6 < inside.sum() < default_board.corner_count


def test_noise_and_blur_are_what_was_asked_for(offscreen: Offscreen, paper_camera: Camera):
    noisy = still(offscreen, paper_camera, noise_sigma=4.0)
    difference = frame_of(noisy).image.astype(float) - frame_of(noisy).image
    assert difference.std() == pytest.approx(4.0 * np.sqrt(2), rel=0.03)
    assert abs(difference.mean()) < 0.05

    sharp, blurred = (
        frame_of(still(offscreen, paper_camera, blur_sigma=sigma)).image.astype(float)
        for sigma in (0.0, 2.0)
    )
    steepest = [np.abs(np.diff(image, axis=1)).max() for image in (sharp, blurred)]
    # A step smeared by a Gaussian falls by its height / (sigma sqrt(2 pi)) per pixel.
    height = np.ptp(sharp)
    assert steepest[0] > 0.6 * height
    assert steepest[1] == pytest.approx(height / (2.0 * np.sqrt(2 * np.pi)), rel=0.15)


def test_the_part_that_is_made_anew_has_no_seam(offscreen: Offscreen, paper_camera: Camera):
    """Room and board are blurred apart; together they are the whole sharp picture, blurred."""
    room = np.random.default_rng(0).integers(0, 255, (720, 1280, 3), np.uint8)
    for pose in ([20, 30, 40, 0.1, 0, 0.5], [0, 0, 0, 0.3, 0.2, 0.6], [0, 0, 0, 2, 0, 2.2]):
        sharp, blurred = (
            frame_of(
                Simulation(
                    paper_camera,
                    background=room,
                    noise_sigma=0,
                    blur_sigma=sigma,
                    autopilot=False,
                    start=Pose.from_vector(pose),
                    offscreen=offscreen,
                )
            ).image
            for sigma in (0.0, 1.5)
        )
        np.testing.assert_array_equal(blurred, cv2.GaussianBlur(sharp, (0, 0), 1.5))


def test_the_room_is_untouched_beside_the_board_and_paper_is_not_pure_white(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    room = np.random.default_rng(0).integers(0, 255, (720, 1280, 3), np.uint8)
    simulation = Simulation(
        paper_camera,
        background=room,
        noise_sigma=0,
        blur_sigma=0,
        light=0.8,
        autopilot=False,
        start=Pose.from_vector([0, 0, 0, 0.15, 0, 0.6]),
        offscreen=offscreen,
    )
    image = frame_of(simulation).image
    np.testing.assert_array_equal(image[:, :600], room[:, :600])
    outline = (
        paper_camera.project(simulation.board_pose.apply(default_board.outline)).round().astype(int)
    )
    (left, top), (right, bottom) = outline.min(axis=0) + 3, outline.max(axis=0) - 3
    board = image[top:bottom, left:right]
    assert np.ptp(board, axis=2).max() == 0, "no colour of the room or the key shines through"
    assert 0.7 * 255 < board.max() <= 0.8 * 255 and 5 < board.min() < 25


def test_a_seed_repeats_every_pixel(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    target = target_of(Pose.from_vector([45, 0, 0, 0, 0, 0.5]), paper_camera, default_board)

    def last_image(seed: int) -> np.ndarray:
        simulation = Simulation(seed=seed, fps=5, speed=2, offscreen=offscreen)
        for _ in range(4):
            frame = frame_of(simulation)
            simulation.follow(target)
        return frame.image

    np.testing.assert_array_equal(last_image(1), last_image(1))
    assert (last_image(1) != last_image(2)).mean() > 0.5


def test_the_hand_brings_the_board_to_the_target(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    pose = Pose.from_vector([30, -25, 15, 0.05, -0.03, 0.45])
    simulation = Simulation(fps=5, speed=2.5, offscreen=offscreen)
    simulation.follow(target_of(pose, paper_camera, default_board))
    frames = [frame_of(simulation) for _ in range(40)]
    assert (
        simulation.board_pose.distance_to(pose) < 0.006
        and simulation.board_pose.angle_to_deg(pose) < 2.5
    )
    assert simulation.step == 4
    np.testing.assert_allclose([f.time_s for f in frames], np.arange(40) / 5, atol=1e-9)
    seen = Detector(default_board).detect(frames[-1].image)
    assert seen.count == default_board.corner_count
    shift = np.linalg.norm(misses_px(seen, paper_camera, default_board, pose), axis=1)
    assert shift.mean() < 15, "what is seen is where the hand is"

    simulation.autopilot_on = False
    held = simulation.board_pose
    frame_of(simulation)
    assert simulation.board_pose is held


@pytest.mark.parametrize(
    "vector",
    [[0, 0, 0, 0, 0, -1], [70, 0, 0, 0, 0, 0.05], [0, 80, 0, 0.4, 0, 0.01], [0, 0, 0, 50, 9, 99]],
)
def test_a_dragged_board_stays_before_the_lens(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board, vector: list[float]
):
    simulation = still(offscreen, paper_camera)
    simulation.move_to(Pose.from_vector(vector))
    corners = simulation.board_pose.apply(default_board.outline)
    assert corners[:, 2].min() > NEAREST - 1e-9 and simulation.board_pose.t[2] < 3.1
    assert np.abs(simulation.board_pose.t[:2]).max() <= simulation.board_pose.t[2]
    np.testing.assert_allclose(simulation.board_pose.R, Pose.from_vector(vector).R)


def test_a_reasonable_drag_is_taken_as_it_is(offscreen: Offscreen, paper_camera: Camera):
    simulation, pose = still(offscreen, paper_camera), Pose.from_vector([30, 20, 10, 0.1, 0, 0.5])
    simulation.move_to(pose)
    np.testing.assert_array_equal(simulation.board_pose.matrix, pose.matrix)


def test_in_real_time_frames_keep_the_rate_and_a_slow_machine_skips(
    offscreen: Offscreen, monkeypatch: pytest.MonkeyPatch
):
    """The wall's clock is replaced, so that nothing here depends on how busy the machine is."""
    now = [50.0]
    monkeypatch.setattr("venus3d.sources.sim.time.monotonic", lambda: now[0])
    monkeypatch.setattr("venus3d.sources.sim.time.sleep", lambda s: now.__setitem__(0, now[0] + s))
    simulation = Simulation(fps=25, realtime=True, offscreen=offscreen)
    assert simulation.is_live
    times = [frame_of(simulation).time_s for _ in range(5)]
    # One more picture is being exposed than was handed out.
    assert now[0] == pytest.approx(50.2) and times == pytest.approx([0, 0.04, 0.08, 0.12, 0.16])
    now[0] += 0.1  # the machine was busy
    last, late, after = (frame_of(simulation).time_s for _ in range(3))
    assert last == pytest.approx(0.2)
    assert late - last == pytest.approx(0.1)
    assert after - late == pytest.approx(0.04)
    assert frame_of(simulation).name == "frame 9"
    now[0] += 2.0  # a pause: the tenth picture was exposed before it
    assert frame_of(simulation).name == "frame 11"


def test_the_painter_stands_in_for_opengl(paper_camera: Camera, default_board: Board):
    with Offscreen("painter") as painter:
        simulation, pose = still(painter, paper_camera), Pose.from_vector([25, 20, 5, 0, 0, 0.4])
        assert simulation.notes == ()
        painter.note = "OpenGL cannot be used any more."  # it may come late
        assert simulation.notes == ("OpenGL cannot be used any more.",)
        simulation.move_to(pose)
        seen = Detector(default_board).detect(frame_of(simulation).image)
    assert seen.count == default_board.corner_count
    assert np.sqrt((misses_px(seen, paper_camera, default_board, pose) ** 2).mean()) < 0.1


def test_closing_ends_the_source(paper_camera: Camera):
    simulation = Simulation(paper_camera.scaled((320, 180)))
    assert frame_of(simulation).image_size == simulation.image_size == (320, 180)
    simulation.close()
    simulation.close()
    assert simulation.read() is None


@pytest.mark.slow
def test_whatever_may_be_asked_for_can_be_read(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    """With 12 px squares the limits let through poses whose markers nobody could read, and a hand
    that had reached its target was told that the board is not seen."""
    simulation = Simulation(paper_camera, autopilot=False, offscreen=offscreen, seed=2)
    detector = Detector(default_board, find_layout=False)
    space = Space(default_board, paper_camera, Limits.for_board(default_board, paper_camera), ())
    rng = np.random.default_rng(2)
    found = []
    for _ in range(40):
        simulation.move_to(Pose.from_vector(random_pose(space, rng)))
        found.append(detector.detect(frame_of(simulation).image).count)
    assert min(found) >= 12 and np.median(found) == default_board.corner_count


def test_a_bowed_board_is_rendered_bowed(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    """The detected corners lie where OpenCV projects those of the bowed board."""
    bowed = replace(default_board, bow=(0.006, -0.003), stretch=0.02)
    pose = Pose.from_vector([35, -20, 15, 0.02, -0.01, 0.42])
    simulation = Simulation(
        paper_camera, bowed, autopilot=False, start=pose, offscreen=offscreen, noise_sigma=0
    )
    seen = Detector(default_board).detect(frame_of(simulation).image)
    assert seen.count == default_board.corner_count
    for board, most in ((bowed, 0.15), (default_board, np.inf)):
        projected, _ = cv2.projectPoints(
            board.corners, pose.rvec, pose.t, paper_camera.K, paper_camera.distortion
        )
        off = np.linalg.norm(seen.corners - projected.reshape(-1, 2), axis=1)
        assert off.max() < most
    assert off.max() > 3  # the flat board's corners lie elsewhere


@pytest.mark.parametrize(
    "errors", [ViewErrors(bow=0.003), ViewErrors(bias_px=3.0), ViewErrors(blur_px=2.0)]
)
def test_the_errors_of_a_view_are_drawn_anew_for_each_target(
    offscreen: Offscreen, default_board: Board, errors: ViewErrors
):
    pose = Pose.from_vector([30, 0, 0, 0, 0, 0.42])
    simulation = Simulation(
        board=default_board,
        autopilot=False,
        start=pose,
        offscreen=offscreen,
        noise_sigma=0,
        view_errors=errors,
    )
    pictures: list[np.ndarray] = []
    for number in (1, 1, 2):
        simulation.follow(target_of(pose, simulation.truth, default_board, number))
        pictures.append(frame_of(simulation).image)
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert cv2.absdiff(pictures[1], pictures[2]).max() > 10


def test_corners_are_drawn_aside_as_far_as_asked_and_neighbours_alike(
    offscreen: Offscreen, paper_camera: Camera, default_board: Board
):
    pose = Pose.from_vector([20, -15, 0, 0, 0, 0.45])
    errors = ViewErrors(bias_px=1.0)
    simulation, detector = (
        still(offscreen, paper_camera, start=pose, view_errors=errors),
        Detector(default_board),
    )
    misses = []
    for _ in range(40):
        simulation.draw_view_error(pose)
        seen = detector.detect(frame_of(simulation).image)
        assert seen.count == default_board.corner_count
        misses.append(misses_px(seen, paper_camera, default_board, pose))
    misses = np.array(misses)  # (views, corners, 2)
    assert np.sqrt((misses**2).mean()) == pytest.approx(1.0, abs=0.25)
    assert np.abs(misses.mean(axis=0)).max() < 0.6
    grid = misses.reshape(40, default_board.rows - 1, default_board.columns - 1, 2)
    neighbours = np.corrcoef(grid[:, :, 1:].ravel(), grid[:, :, :-1].ravel())[0, 1]
    far = np.corrcoef(grid[:, :, 0].ravel(), grid[:, :, -1].ravel())[0, 1]
    assert neighbours > 0.9 > far


def test_a_view_is_blurred_as_much_as_drawn(offscreen: Offscreen, paper_camera: Camera):
    """Blurs add as squares; a step smeared falls by its height / (sigma sqrt(2 pi)) per pixel."""
    pose = Pose.from_vector([0, 0, 0, 0, 0, 0.45])
    simulation = still(
        offscreen, paper_camera, start=pose, blur_sigma=1.0, view_errors=ViewErrors(blur_px=2.0)
    )
    sigmas = []
    for _ in range(30):
        simulation.draw_view_error(pose)
        image = frame_of(simulation).image.astype(float)[..., 1]
        sigmas.append(190 / np.abs(np.diff(image, axis=1)).max() / np.sqrt(2 * np.pi))
    assert min(sigmas) > 0.9
    assert np.sqrt(np.mean(np.square(sigmas)) - 1) == pytest.approx(2.0, rel=0.35)

"""Every kind of board: found in pictures whose truth is known, and followed through them."""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of as distorted_picture_of
from tests.engine.calibration.test_adjustment import observe, tilted
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.disc_centroids import disc_centroids
from venus3d.engine.calibration.observation import Observation, with_centres
from venus3d.engine.calibration.refinement import local_scales
from venus3d.engine.geometry.board import Board, Kind
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.discs import centres_of_discs, disc_shifts
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.board_tracker import BoardTracker
from venus3d.sources.frame import Frame
from venus3d.sources.images_calibration import calibrate_images
from venus3d.sources.sim_cameras import SIM_CAMERAS, SimCamera
from venus3d.storage.formats.plain_json import JSON
from venus3d.storage.formats.record import CameraRecord
from venus3d.storage.result import board_summary, result_json, summary_of
from venus3d.storage.result_reader import board_of

CAMERA = Camera(1280, 720, 1000, 1000, 645, 352)
POSE = Pose.from_vector([20, -25, 10, 0.01, -0.01, 0.42])
BOARDS = {
    "chessboard": Board(kind="chessboard", columns=10, rows=7, square=0.024),
    "chessboard, even": Board(kind="chessboard", columns=10, rows=6, square=0.024),
    "circles": Board(9, 6, 0.026, 0.016, kind="circles"),
    "white circles": Board(7, 6, 0.03, 0.018, kind="circles", inverted=True),
    "asymmetric circles": Board(4, 11, 0.02, 0.016, kind="asymmetric-circles"),
    "aprilgrid": Board(6, 5, 0.039, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid"),
    "aruco-grid": Board(6, 4, 0.04, 0.032, "DICT_6X6_50", first_id=3, kind="aruco-grid"),
}
EACH = pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))


def picture_of(board: Board, pose: Pose, seed: int = 0) -> NDArray[np.uint8]:
    """A picture without distortion, so that a homography warps it; four pixels in each, blurred."""
    px = 104
    paper = 0 if board.inverted else 255
    sheet = cv2.copyMakeBorder(board.texture(px), px, px, px, px, cv2.BORDER_CONSTANT, value=paper)
    # From pixels of the sheet, whose centres are whole numbers, to metres, then to the picture.
    to_board = np.array(
        [
            [board.square / px, 0, board.square / px * (0.5 - sheet.shape[1] / 2)],
            [0, board.square / px, board.square / px * (0.5 - sheet.shape[0] / 2)],
            [0, 0, 1],
        ]
    )
    double = np.array([[2.0, 0, 0.5], [0, 2.0, 0.5], [0, 0, 1]])
    H = double @ CAMERA.K @ np.column_stack([pose.R[:, :2], pose.t]) @ to_board
    fine = cv2.warpPerspective(sheet, H, (2560, 1440), borderValue=(110,))
    picture = cv2.GaussianBlur(
        cv2.resize(fine, (1280, 720), interpolation=cv2.INTER_AREA), None, 0.6
    )
    noisy = picture + np.random.default_rng(seed).normal(0, 2.0, picture.shape)
    return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)


def errors_of(board: Board, seen: Observation, pose: Pose) -> np.ndarray:
    return np.linalg.norm(
        seen.corners - CAMERA.project(pose.apply(board.points_of(seen.ids))), axis=1
    )


@EACH
def test_found_where_it_is(board: Board) -> None:
    """Each point under its own id, to 0.1 px in a picture with noise."""
    picture = picture_of(board, POSE)
    seen = Detector(board).detect(picture)
    assert seen.count == board.corner_count
    errors = errors_of(board, seen, POSE)
    assert np.sqrt((errors**2).mean()) < 0.1 and errors.max() < 0.4


@EACH
def test_followed_from_frame_to_frame(board: Board) -> None:
    """Also when it moves by half a square between two frames; each in a few
    milliseconds of the processor (8 on a machine that does nothing else)."""
    tracker, times = BoardTracker(Detector(board)), list[float]()
    for k in range(6):
        pose = Pose.from_vector([20, -25, 10 + 2 * k, 0.004 * k, 0.01, 0.5])
        picture = picture_of(board, pose, k)
        began = time.thread_time()
        seen = tracker.track(Frame(picture, 0.04 * k, str(k)))
        times.append(time.thread_time() - began)
        assert seen.count == board.corner_count
        assert errors_of(board, seen, pose).max() < 0.4
    assert np.median(times[2:]) < 0.03, times


@pytest.mark.parametrize("name", ["chessboard, even", "circles", "asymmetric circles"])
def test_a_board_that_turns_over_is_followed(name: str) -> None:
    """The half-turn symmetry: a board that is turned by 150 degrees keeps its ids, though it looks
    as if it were turned by 30 the other way."""
    board = BOARDS[name]
    detector = Detector(board)
    for turn in (0, 50, 100, 150):
        pose = Pose.from_vector([10, -15, turn, 0, 0, 0.45])
        seen = detector.detect(picture_of(board, pose))
        assert errors_of(board, seen, pose).max() < 0.4


def test_the_colours_tell_which_way_up() -> None:
    board = BOARDS["chessboard"]
    pose = Pose.from_vector([10, -15, 150, 0, 0, 0.45])
    seen = Detector(board).detect(picture_of(board, pose))
    assert errors_of(board, seen, pose).max() < 0.4


def test_a_real_checkerboard(shared_data: Path) -> None:
    """13 stills of the left camera of a stereo pair: plain OpenCV finds 13, fx 519.2 +- 1.7."""
    board = Board(kind="chessboard", columns=10, rows=7, square=0.025)
    found = calibrate_images(shared_data / "checkerboard-9x6", board)
    assert len(found.views) == 13 and found.rms_px <= 0.153
    assert abs(found.camera.fx - 519.2) < 2
    assert found.board == board


@EACH
def test_stored_with_what_its_kind_has(board: Board) -> None:
    assert board_of(board_summary(board)) == board
    content = JSON.write(CameraRecord(CAMERA, board=board))
    assert JSON.read(content).board == board


def test_real_grids_of_tags(shared_data: Path) -> None:
    """Four photographs each, of boards whose sizes are known by their proportions only: Kalibr's
    usual AprilGrid has gaps of 0.3 of a tag."""
    april = Board(6, 6, 0.04, 0.03, "DICT_APRILTAG_36H11", kind="aprilgrid")
    found = calibrate_images(shared_data / "cases" / "aprilgrid", april)
    assert found.rms_px < 0.13 and sum(view.observation.count for view in found.views) > 400
    assert found.board.marker / found.board.square == pytest.approx(1 / 1.3, abs=0.0003)
    aruco = Board(6, 4, 0.04, 0.032, "DICT_6X6_1000", kind="aruco-grid")
    found = calibrate_images(shared_data / "cases" / "aruco-gridboard", aruco)
    assert found.rms_px < 0.5 and sum(view.observation.count for view in found.views) > 370


@pytest.mark.parametrize("kind", ["aprilgrid", "aruco-grid"])
def test_opencv_finds_each_tag_where_the_drawing_has_it(kind: Kind) -> None:
    """The picture, the points and their order agree, by OpenCV's detector alone."""
    board = Board(5, 4, 0.039, 0.03, "DICT_APRILTAG_36H11", first_id=7, kind=kind)
    picture = cv2.copyMakeBorder(board.texture(104), *(4 * [52]), cv2.BORDER_CONSTANT, value=255)
    parameters = cv2.aruco.DetectorParameters()
    parameters.markerBorderBits = 2 if kind == "aprilgrid" else 1
    whole = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    quads, ids, _ = cv2.aruco.ArucoDetector(whole, parameters).detectMarkers(picture)
    assert sorted(np.ravel(ids)) == list(range(7, 27))
    for quad, number in zip(quads, np.ravel(ids), strict=True):
        points = board.points_of(4 * (number - 7) + np.arange(4))[:, :2]
        places = (points + np.array([board.width, board.height]) / 2) / board.square * 104 + 52
        assert np.abs(np.reshape(quad, (4, 2)) - places).max() < 8


@pytest.mark.parametrize("name", ["aprilgrid", "aruco-grid"])
@pytest.mark.parametrize("turn_deg", [0, 45])
def test_a_quick_search_loses_no_tag_of_the_smallest_that_it_is_for(
    name: str, turn_deg: float
) -> None:
    """Short outlines are not looked into: none may be a tag's, upright or on its corner."""
    board = BOARDS[name]
    away = CAMERA.fx * board.square / 43  # pixels that a square is wide
    picture = picture_of(board, Pose.from_vector([0, 0, turn_deg, 0, 0, away]))
    detector = Detector(board)
    everything = detector.detect(picture)
    assert 40 < detector.square_px < 44 and everything.count > 0.9 * board.corner_count
    quick = detector.detect(picture, quick=True)
    np.testing.assert_array_equal(quick.ids, everything.ids)
    assert np.abs(quick.corners - everything.corners).max() < 0.1


@pytest.mark.parametrize("name", ["circles", "asymmetric circles"])
def test_opencv_numbers_circles_as_the_board_does(name: str) -> None:
    board, px = BOARDS[name], 60
    picture = cv2.copyMakeBorder(board.texture(px), *(4 * [px]), cv2.BORDER_CONSTANT, value=255)
    layout = cv2.CALIB_CB_SYMMETRIC_GRID if name == "circles" else cv2.CALIB_CB_ASYMMETRIC_GRID
    found, centres = cv2.findCirclesGrid(picture, (board.columns, board.rows), flags=layout)
    assert found
    seen = np.reshape(centres, (-1, 2))
    seen = seen - seen.mean(axis=0)
    seen = seen if seen[0, 0] < seen[1, 0] else seen[::-1]  # from the other end
    drawn = board.corners[:, :2] - board.corners[:, :2].mean(axis=0)
    assert np.abs(seen / px * board.square - drawn).max() < 0.02 * board.square


@pytest.mark.parametrize("camera", ["webcam", "fisheye"])
def test_the_centres_of_circles_are_not_the_centroids_of_their_pictures(camera: SimCamera) -> None:
    """The centroids by integration along 720 points of each rim: taken for the centres they put fx
    off, with hardly any residual; the calibration finds the truth to 0.001 px."""
    truth, board = SIM_CAMERAS[camera], Board(9, 6, 0.028, 0.021, kind="circles")
    rng, seen = np.random.default_rng(0), list[Observation]()
    turns = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    rim = board.marker / 2 * np.column_stack([np.cos(turns), np.sin(turns), np.zeros(720)])
    away = 0.4 if camera == "webcam" else 0.2
    for _ in range(8):
        turned = rng.uniform(-40, 40, 3)
        place = [*(away * rng.uniform(-0.2, 0.2, 2)), away * rng.uniform(1, 1.4)]
        pose = Pose.from_vector([*turned, *place])
        rims = truth.project(pose.apply((board.corners[:, None] + rim).reshape(-1, 3)))
        centroids = np.array([area_centroid(one) for one in rims.reshape(-1, 720, 2)])
        centres = centres_of_discs(board.corners[:, :2], centroids, board.marker / 2)
        at = truth.project(pose.apply(board.corners))
        shift = np.linalg.norm(centroids - at, axis=1)
        assert np.sqrt(((centres - at) ** 2).mean()) < (0.06 if camera == "webcam" else 0.4) * (
            np.sqrt((shift**2).mean())
        )
        np.testing.assert_allclose(
            disc_shifts(truth, board, np.arange(54), pose), centroids - at, atol=0.02 * shift.max()
        )
        ids = np.arange(board.corner_count)
        seen.append(Observation(ids, centres, truth.image_size, centroids=centroids))
    found = calibrate(board, seen, lens=truth.lens)
    assert found.rms_px < 0.001
    assert abs(found.camera.fx - truth.fx) < 0.03
    plain = [replace(one, corners=one.centroids, centroids=None) for one in seen]
    uncorrected = calibrate(board, plain, lens=truth.lens)
    assert uncorrected.rms_px < 0.1 and uncorrected.rms_px > 10 * found.rms_px
    assert abs(uncorrected.camera.cx - truth.cx) > 10 * abs(found.camera.cx - truth.cx)
    again = calibrate(board, [view.observation for view in found.views], lens=truth.lens)
    assert again.camera.fx == pytest.approx(found.camera.fx, abs=1e-3), "not corrected twice"


def test_discs_beyond_the_reach_of_a_lens_model_keep_their_centres() -> None:
    """Of a wide lens, five coefficients are tried that fold back within the picture."""
    board, pose = BOARDS["circles"], Pose.from_vector([0, 60, 0, 0, 0, 0.08])
    at = np.tile([600.0, 300.0], (54, 1))
    seen = Observation(np.arange(54), at, (1280, 720), centroids=at + 0.1)
    corners = with_centres(CAMERA, board, seen, pose).corners
    assert np.isfinite(corners).all() and (corners == at).all(axis=1).any()


def area_centroid(polygon: np.ndarray) -> np.ndarray:
    """By Green's theorem."""
    (x, y), (u, v) = polygon.T, np.roll(polygon, -1, axis=0).T
    cross = x * v - u * y
    return np.array([((x + u) * cross).sum(), ((y + v) * cross).sum()]) / (3 * cross.sum())


@pytest.mark.parametrize("name", ["aprilgrid", "aruco-grid"])
@pytest.mark.parametrize("off", [0.8, 1.2])
def test_tags_of_another_size_than_given_are_measured(name: str, off: float) -> None:
    """The corners of such a grid were some pixels off the model, and nothing was said."""
    board = BOARDS[name]
    given = replace(board, marker=off * board.marker)
    detector = Detector(given)
    for k, tilt in enumerate((20, -25, 5)):
        pose = Pose.from_vector([tilt, 15, 40 * k, 0.01, 0, 0.45])
        seen = detector.detect(picture_of(board, pose))
    assert detector.board.marker == pytest.approx(board.marker, rel=0.006)
    assert errors_of(detector.board, seen, pose).max() < 0.4
    (said,) = detector.diagnoses
    assert said.kind == "wrong-marker-size" and f"not {1000 * given.marker:g} mm" in said.cause
    assert f"--board.marker-mm {1000 * detector.board.marker:g}" in said.cure


@pytest.mark.parametrize("noise_px", [0.05, 0.3])
@pytest.mark.parametrize("off", [1.0, 0.98, 1.03])
def test_a_calibration_finds_the_side_of_the_tags(off: float, noise_px: float) -> None:
    board, rng = BOARDS["aprilgrid"], np.random.default_rng(0)
    seen = [observe(CAMERA, board, vector, rng, noise_px) for vector in tilted(rng, 10, 40, 8)]
    found = calibrate(replace(board, marker=off * board.marker), seen)
    told = [d for d in diagnose(found) if d.kind == "wrong-marker-size"]
    assert abs(found.camera.fx - CAMERA.fx) < 4 * found.sigma[0]
    if off == 1.0:
        assert found.marker_sigma == 0 and found.board == board and not told
        return
    assert abs(found.board.marker - board.marker) < 4 * found.marker_sigma < 4e-5
    assert len(told) == 1 and f"--board.marker-mm {1000 * found.board.marker:.2f}" in told[0].cure
    assert found.rms_px < 1.1 * np.sqrt(2) * noise_px
    content = json.loads(result_json(summary_of(found), found))
    assert content["board_shape"]["marker_std_mm"] == pytest.approx(1000 * found.marker_sigma)


def test_a_sheet_whose_middle_lies_in_a_circle_is_read_as_any_other() -> None:
    """At some of the search's thresholds the whole sheet is a blob, dark in its middle: its place
    moved that circle's, and no board was found in half of the pictures in which it was small."""
    board = Board(7, 5, 0.028, 0.02, kind="circles")
    for z in (0.8, 1.0, 1.2):
        for turn in (0.0, 20.0):
            pose = Pose.from_vector([turn, -turn, turn, 0.01, 0.01, z])
            seen = Detector(board).detect(picture_of(board, pose))
            assert seen.count == board.corner_count
            assert errors_of(board, seen, pose).max() < 0.4


def test_white_circles_are_found_in_dim_light() -> None:
    """The search for dark circles ended short of their ground, seen as a negative."""
    board = BOARDS["white circles"]
    dim = np.rint(0.2 * picture_of(board, POSE)).astype(np.uint8)
    seen = Detector(board).detect(dim)
    assert seen.count == board.corner_count
    assert errors_of(board, seen, POSE).max() < 0.5


def test_a_disc_s_place_does_not_depend_on_where_it_was_looked_for() -> None:
    """Four fifths of its radius beside it, two rounds left it a quarter of a pixel off."""
    board = BOARDS["circles"]
    picture, kind = picture_of(board, POSE), board.of_kind
    places = CAMERA.project(POSE.apply(board.corners))
    scales = local_scales(board, np.arange(board.corner_count), places)
    radius = kind.radius(board)
    reach = min(kind.clearance(board), 2 * radius)
    right = disc_centroids(picture, places, scales, radius, reach)
    turns = np.random.default_rng(0).uniform(0, 2 * np.pi, len(places))
    beside = 0.8 * radius * np.column_stack([np.cos(turns), np.sin(turns)])
    start = places + np.einsum("nij,nj->ni", scales, beside)
    found = disc_centroids(picture, start, scales, radius, reach)
    assert right is not None and found is not None
    assert np.abs(found - right).max() < 0.02


@pytest.mark.parametrize(
    "pose",
    [
        [-5, -1, -20, 0, 0.017, 0.19],
        [22, -19, -105, -0.015, -0.036, 0.2],
        [-39, 33, -18, 0, 0.04, 0.245],
    ],
)
def test_few_large_tags_keep_their_corners(pose: list[float]) -> None:
    """Their outlines are pixels off here and there, and a polynomial through these bent the edges:
    corners were up to 2.6 px off, 0.5 to 1.0 px at an average."""
    board, place = (
        Board(6, 4, 0.05, 0.04, "DICT_6X6_1000", kind="aruco-grid"),
        Pose.from_vector(pose),
    )
    seen = Detector(board).detect(distorted_picture_of(board, PAPER_CAMERA, place, blur_px=0.8))
    off = seen.corners - PAPER_CAMERA.project(place.apply(board.points_of(seen.ids)))
    assert seen.count >= 20 and np.sqrt((off**2).sum(axis=1).mean()) < 0.35

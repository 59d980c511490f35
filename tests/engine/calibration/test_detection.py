"""Detection on pictures whose truth is known, and on real ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.engine.board_pictures import picture_of, settle
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.charuco_reader import QUICK_FROM_PX
from venus3d.engine.calibration.detection import Detector, search_region
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

VECTORS = (
    [0, 0, 0, 0, 0, 0.45],
    [35, -20, 15, 0.02, 0.0, 0.45],
    [-40, 30, -50, -0.05, 0.02, 0.6],
    [20, 45, 80, 0.04, -0.02, 0.5],
)
STILLS = Board(8, 8, 0.0254, 0.01905, "DICT_4X4_1000")


def errors_of(observation: Observation, board: Board, camera: Camera, vector: object) -> np.ndarray:
    pose = Pose.from_vector(vector)  # type: ignore[arg-type]
    return observation.corners - camera.project(pose.apply(board.points_of(observation.ids)))


@pytest.fixture(scope="module")
def pictures(paper_camera: Camera, default_board: Board) -> list[np.ndarray]:
    return [picture_of(default_board, paper_camera, Pose.from_vector(v)) for v in VECTORS]


def test_refinement_brings_corners_to_a_few_hundredths_of_a_pixel(
    pictures: list[np.ndarray], paper_camera: Camera, default_board: Board
) -> None:
    rms: dict[bool, float] = {}
    for refine in (False, True):
        detector = Detector(default_board, refine=refine)
        seen = [detector.detect(picture) for picture in pictures]
        assert [o.count for o in seen] == [40] * 4
        assert all((np.diff(o.ids) > 0).all() for o in seen)
        errors = np.concatenate(
            [
                errors_of(o, default_board, paper_camera, v)
                for o, v in zip(seen, VECTORS, strict=True)
            ]
        )
        rms[refine] = float(np.sqrt((errors**2).mean()))
    assert rms[True] < 0.03
    assert np.abs(errors.mean(axis=0)).max() < 0.01
    assert np.abs(errors).max() < 0.15
    assert rms[True] < rms[False]


def test_unblurred_edges_gain_most(paper_camera: Camera, default_board: Board) -> None:
    picture = picture_of(default_board, paper_camera, Pose.from_vector(VECTORS[1]), blur_px=0)
    seen = Detector(default_board).detect(picture)
    assert np.sqrt((errors_of(seen, default_board, paper_camera, VECTORS[1]) ** 2).mean()) < 0.05


def test_colour_depth_and_a_search_region_change_nothing(
    pictures: list[np.ndarray], default_board: Board
) -> None:
    grey = pictures[1]
    detector = Detector(default_board, find_layout=False)
    whole = detector.detect(grey, time_s=1.5, name="a")
    assert (whole.image_size, whole.time_s, whole.name) == ((1280, 720), 1.5, "a")
    region = search_region(whole, (1280, 720))
    assert region is not None
    for seen in (
        detector.detect(cv2.cvtColor(grey, cv2.COLOR_GRAY2BGR)),
        detector.detect(grey.astype(np.uint16) * 257),
        detector.detect(grey[..., None]),
        detector.detect(grey, region=region),
        detector.detect(grey, region=(-50, -50, 5000, 5000)),
    ):
        assert (seen.ids == whole.ids).all() and seen.image_size == (1280, 720)
        np.testing.assert_allclose(seen.corners, whole.corners, atol=0.05)


def test_a_quick_look_finds_as_much_where_squares_are_large(
    pictures: list[np.ndarray], default_board: Board
) -> None:
    detector = Detector(default_board, find_layout=False)
    quick_ones = 0
    for picture in pictures:
        full = detector.detect(picture)
        quick = detector.detect(picture, quick=True)
        quick_ones += detector.square_px >= QUICK_FROM_PX
        if detector.square_px >= QUICK_FROM_PX:
            assert (quick.ids == full.ids).all()
            np.testing.assert_allclose(quick.corners, full.corners, atol=0.05)
    assert quick_ones >= 2, "else the test shows little"


def test_markers_found_in_a_smaller_picture_give_the_same_corners(
    default_board: Board, paper_camera: Camera
) -> None:
    detector = Detector(default_board, find_layout=False)
    for vector in ((0, 0, 0, 0, 0, 0.35), (15, -25, 40, 0.0, 0, 0.4)):
        picture = picture_of(default_board, paper_camera, Pose.from_vector(vector))
        large = cv2.resize(picture, None, fx=1.5, fy=1.5, interpolation=cv2.INTER_CUBIC)
        full = detector.detect(large)
        times = int(detector.square_px // QUICK_FROM_PX)
        assert times >= 2, "else the test shows nothing"
        quick = detector.detect(large, quick=times)
        assert full.count > 30 and (quick.ids == full.ids).all()
        np.testing.assert_allclose(quick.corners, full.corners, atol=0.02)
    assert detector.detect(np.full_like(large, 127), quick=2).count == 0


def test_search_region_holds_the_board_and_stays_in_the_image() -> None:
    corners = np.array([[100.0, 50], [300, 50], [300, 200], [100, 200]])
    seen = Observation(np.arange(4), corners, (1280, 720))
    region = search_region(seen, (1280, 720))
    assert region == (30, 0, 371, 271)
    assert search_region(seen, (640, 480)) is None, "another size: nothing is known"
    assert search_region(Observation.nothing((1280, 720)), (1280, 720)) is None
    large = Observation(np.arange(4), corners * 4 - [350, 170], (1280, 720))
    assert search_region(large, (1280, 720)) is None, "nothing would be saved"


@pytest.mark.parametrize("legacy", [False, True])
@pytest.mark.parametrize("inverted", [False, True])
def test_layout_and_inversion_are_found_out_and_said(
    paper_camera: Camera, default_board: Board, legacy: bool, inverted: bool
) -> None:
    printed = replace(default_board, legacy=legacy, inverted=inverted)
    pictures = [picture_of(printed, paper_camera, Pose.from_vector(v)) for v in VECTORS[:3]]
    detector = Detector(default_board)
    assert not detector.settled
    nothing = np.full((720, 1280), 90, np.uint8)
    assert detector.detect(nothing).count == 0 and not detector.settled
    first = detector.detect(pictures[0])
    assert detector.board == printed, "one good picture is enough to believe it"
    assert first.count == 40
    assert np.abs(errors_of(first, printed, paper_camera, VECTORS[0])).max() < 0.15
    assert settle(detector, pictures[1:]) == printed
    assert detector.settled
    assert [d.kind for d in detector.diagnoses] == ["wrong-layout"] * legacy
    assert ["white on black" in note for note in detector.notes] == [True] * inverted


def test_a_layout_that_was_asked_for_is_kept_if_told_so(
    pictures: list[np.ndarray], default_board: Board
) -> None:
    detector = Detector(replace(default_board, legacy=True), find_layout=False)
    assert detector.settled
    assert detector.detect(pictures[0]).count < 40
    assert detector.board.legacy and detector.notes == ()


def test_sharpness_falls_with_blur_and_says_so_for_defocus_and_motion(
    pictures: list[np.ndarray], default_board: Board
) -> None:
    detector = Detector(default_board, find_layout=False)
    values = [
        detector.detect(picture).sharpness
        for picture in (
            pictures[1],
            cv2.GaussianBlur(pictures[1], (0, 0), 1.5),
            cv2.GaussianBlur(pictures[1], (0, 0), 3.0),
        )
    ]
    assert 1 >= values[0] > 1.5 * values[1] > 2 * values[2] > 0
    # Less light is not less sharp.
    dim = (pictures[1] // 3 + 20).astype(np.uint8)
    assert detector.detect(dim).sharpness == pytest.approx(values[0], rel=0.1)


def test_pictures_without_a_usable_board_give_nothing(default_board: Board) -> None:
    detector = Detector(default_board)
    noise = np.random.default_rng(0).integers(0, 255, (240, 320), dtype=np.uint8)
    assert detector.detect(noise).count == 0
    assert detector.detect(noise, region=(400, 300, 500, 400)).count == 0
    # Three squares high, one row of corners visible: all on one line.
    strip = cv2.copyMakeBorder(
        default_board.texture(60)[: 2 * 60 + 8], 60, 60, 60, 60, cv2.BORDER_CONSTANT, value=255
    )
    assert detector.detect(strip).count == 0


@pytest.mark.parametrize(
    "image",
    [np.zeros((10, 10)), np.zeros((10, 10, 4), np.uint8), np.zeros(5, np.uint8)],
    ids=["float", "four channels", "a row"],
)
def test_arrays_that_are_no_image(image: np.ndarray, default_board: Board) -> None:
    with pytest.raises(VenusError, match="grey or BGR"):
        Detector(default_board).detect(image)
    with pytest.raises(VenusError, match="no pixels"):
        Detector(default_board).detect(np.zeros((0, 10), np.uint8))


@pytest.mark.slow
def test_refinement_helps_on_real_stills(shared_data: Path) -> None:
    """OpenCV alone: rms 0.250 px. A focal length that moves by more than its sigma is no gain."""
    files = sorted((shared_data / "lifecam-charuco-8x8").glob("*.jpg"))
    detector = Detector(STILLS)
    seen = [detector.detect(cv2.imread(str(file)), name=file.name) for file in files]
    assert detector.settled and detector.notes == ()
    calibration = calibrate(STILLS, [o for o in seen if o.count])
    assert len(calibration.views) == 16
    assert calibration.rms_px < 0.235
    assert calibration.camera.fx == pytest.approx(1127, abs=6)
    assert calibration.camera.fy == pytest.approx(1127, abs=6)

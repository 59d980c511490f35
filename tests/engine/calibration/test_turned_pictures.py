"""Pictures turned by 180° among others are named and left out; nothing else is taken for them.

Once eight pictures with some of them turned gave cy 356.7 ± 0.5 where it was 352, and nothing was
said.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.engine.board_pictures import settle
from tests.engine.calibration.test_adjustment import observe, tilted
from venus3d.engine.calibration import turned_pictures
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.checks import Diagnoses, diagnose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.information import shared_modes
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.refusals import calibrate_or_refuse
from venus3d.engine.calibration.turned_pictures import turned, turned_views
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.sources.images_calibration import calibrate_recording

TRUTH = Camera(1280, 720, 1000, 1000, 645, 352, k1=-0.25, k2=0.05, p1=5e-4)
NOISE_PX = 0.05


def views_of(camera: Camera, vectors: list[Array], rng: np.random.Generator) -> list[Observation]:
    return [
        replace(observe(camera, Board(), vector, rng, NOISE_PX), name=f"{number}.png")
        for number, vector in enumerate(vectors, 1)
    ]


def with_turned(views: list[Observation], numbers: tuple[int, ...]) -> list[Observation]:
    return [turned(view) if n in numbers else view for n, view in enumerate(views, 1)]


def test_the_turn_is_opencvs() -> None:
    picture = np.zeros((72, 128), np.uint8)
    picture[10, 100] = 255
    row, column = np.argwhere(cv2.rotate(picture, cv2.ROTATE_180))[0]
    seen = Observation(np.zeros(1, np.intp), np.array([[100.0, 10.0]]), (128, 72))
    np.testing.assert_array_equal(turned(seen).corners, [[column, row]])


@pytest.mark.parametrize("which", [(9,), (2, 5, 12), (2, 4, 5, 6, 9, 11)])
def test_turned_pictures_are_named_and_left_out(
    rng: np.random.Generator, which: tuple[int, ...]
) -> None:
    views = views_of(TRUTH, tilted(rng, 10, 40, 12), rng)
    seen = with_turned(views, which)
    found = calibrate_or_refuse(Board(), seen)
    told = next(d for d in diagnose(found) if d.kind == "turned-pictures")
    assert told.views == which
    assert all(f"{number} ({number}.png)" in told.cause for number in which)
    camera = found.camera
    assert f"({camera.cx:.1f}, {camera.cy:.1f}) px in the others" in told.cause
    assert f"({1279 - camera.cx:.1f}, {719 - camera.cy:.1f}) px in" in told.cause
    assert [(one.number, one.reason) for one in found.left_out] == [(n, "turned") for n in which]
    rest = calibrate(Board(), [view for n, view in enumerate(views, 1) if n not in which])
    np.testing.assert_allclose(
        camera.parameters, rest.camera.parameters, atol=1e-4 * rest.sigma.min()
    )
    assert (abs(camera.parameters - TRUTH.parameters) < 4 * found.sigma).all()


def test_in_a_session_they_are_named(rng: np.random.Generator) -> None:
    """It goes on with all views: its calibration is not made anew without some."""
    seen = with_turned(views_of(TRUTH, tilted(rng, 10, 40, 12), rng), (3, 4))
    told = next(
        d for d in Diagnoses.of(calibrate(Board(), seen)).growing if d.kind == "turned-pictures"
    )
    assert told.views == (3, 4) and "the estimate of it lies in between" in told.cause


def test_one_that_fits_nothing_else_is_named(rng: np.random.Generator) -> None:
    """A principal point far off the middle: no pose fits the turned picture, which was called
    misread or blurred."""
    camera = replace(TRUTH, cx=820, cy=260)
    seen = with_turned(views_of(camera, tilted(rng, 10, 40, 10), rng), (6,))
    assert [one.reason for one in calibrate(Board(), seen).left_out] == ["misfit"]
    found = calibrate_or_refuse(Board(), seen)
    assert [(one.number, one.reason) for one in found.left_out] == [(6, "turned")]
    assert "left-out-view" not in {d.kind for d in diagnose(found)}


@pytest.mark.parametrize("seed", [6, 17])
def test_one_that_fits_only_once_the_others_have_left_is_named(seed: int) -> None:
    """Three of ten turned: with two of them gone the third fits no pose, and was called misread."""
    board = Board(11, 8, 0.02, 0.015, "DICT_5X5_250")
    camera = Camera(1440, 1080, 1700, 1700, 700, 550, k1=0.06)
    vectors = [
        [-15.9, 18.9, -9.3, -0.021, 0.004, 0.428],
        [14.6, 13.3, -4.1, 0.058, -0.012, 0.443],
        [24.1, -1.5, -28.4, -0.054, 0.021, 0.356],
        [10.8, 15.3, 16.9, -0.018, -0.031, 0.351],
        [-14.1, -9.3, -14.7, -0.035, -0.017, 0.315],
        [30.1, -13.9, -9.5, 0.011, -0.023, 0.35],
        [-0.4, -22.5, -9.1, 0.007, -0.002, 0.376],
        [-18.4, -32.3, 0.1, -0.041, 0.015, 0.384],
        [21.4, 2.4, 8.6, -0.007, -0.009, 0.334],
        [28.9, 10.4, -19.1, -0.047, -0.011, 0.344],
    ]
    rng = np.random.default_rng(seed)
    views = [observe(camera, board, vector, rng, 0.017) for vector in vectors]
    found = calibrate_or_refuse(board, with_turned(views, (1, 2, 3)))
    gone = [(one.number, one.reason) for one in found.left_out]
    assert gone == [(1, "turned"), (2, "turned"), (3, "turned")]


def test_a_board_turned_in_its_plane_is_no_turned_picture(rng: np.random.Generator) -> None:
    vectors = tilted(rng, 10, 40, 12)
    upside_down = [Pose.from_vector(v).turned("z", 180.0).vector() for v in vectors]
    views = views_of(TRUTH, [*vectors[:6], *upside_down[6:]], rng)
    assert turned_views(calibrate(Board(), views)) == ()


@pytest.mark.parametrize("kind", ["noise", "shared errors", "bent anew", "bowed", "rolling"])
def test_other_errors_are_not_taken_for_it(rng: np.random.Generator, kind: str) -> None:
    """The principal point in the middle, where a turn changes least, and a little off it."""
    for off, rolling_px in ((0.0, 2.0), (2.0, 8.0), (8.0, 20.0)):
        camera = replace(TRUTH, cx=639.5 + off, cy=359.5 - off)
        board = replace(Board(), bow=(0.003, 0.001)) if kind == "bowed" else Board()
        seen: list[Observation] = []
        for vector in tilted(rng, 5, 45, 10):
            if kind == "bent anew":
                board = replace(Board(), bow=(rng.normal(0, 1e-3), rng.normal(0, 1e-3)))
            one = observe(camera, board, vector, rng, NOISE_PX)
            if kind == "shared errors":
                T = shared_modes(board, board.points_of(one.ids))
                one = replace(
                    one, corners=one.corners + 0.1 * T @ rng.normal(0, 1, (T.shape[1], 2))
                )
            if kind == "rolling":
                late = one.corners[:, 1:] / 720
                one = replace(one, corners=one.corners + late * rng.normal(0, rolling_px, 2))
            seen.append(one)
        assert turned_views(calibrate(Board(), seen)) == ()


@pytest.mark.parametrize("which", [(0, 1, 2, 5, 6), (0, 1, 2, 4, 5, 6)])
def test_few_pictures_must_gain_more(
    shared_data: Path, which: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A phone moves its lens: signs gain 35 and 27 in these photographs, none of which is turned.
    By the limit for many views it would be told of."""
    board = Board(9, 7, 0.04, 0.02, "DICT_4X4_100")
    files = sorted((shared_data / "cases/glare").glob("*.jpg"))
    pictures = [np.asarray(cv2.imread(str(file), cv2.IMREAD_GRAYSCALE), np.uint8) for file in files]
    detector = Detector(board)
    settle(detector, pictures)
    seen = [detector.detect(picture) for picture in pictures]
    few = calibrate(detector.board, [seen[n] for n in which])
    assert turned_views(few) == ()
    monkeypatch.setattr(turned_pictures, "UNLIKELY_FEW", turned_pictures.UNLIKELY)
    assert turned_views(few) != ()


@pytest.mark.parametrize("seed", [7, 36, 40])
def test_many_pictures_need_to_gain_less(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """With shared errors signs gain 26 to 29 in nine views, which is enough; of fewer views it
    would not be."""
    rng, seen = np.random.default_rng(seed), list[Observation]()
    for off, count in ((8, 7), (8, 9), (14, 7), (14, 9), (22, 7), (22, 9)):
        camera = replace(TRUTH, cx=639.5 + off, cy=359.5 - off)
        seen.clear()
        for one in views_of(camera, tilted(rng, 5, 40, count), rng):
            T = shared_modes(Board(), Board().points_of(one.ids))
            shift = 0.08 * T @ rng.normal(0, 1, (T.shape[1], 2))
            seen.append(replace(one, corners=one.corners + shift))
    calibration = calibrate(Board(), with_turned(seen, (2, 5, 6)))
    assert turned_views(calibration) == (2, 5, 6)
    monkeypatch.setattr(turned_pictures, "UNLIKELY", turned_pictures.UNLIKELY_FEW)
    assert turned_views(calibration) == ()


@pytest.mark.parametrize("seed", [16, 24, 36, 57])
def test_a_turned_picture_is_not_taken_for_shared_errors(seed: int) -> None:
    """As long as it isn't turned back it looks like them, and with them its sign gained nothing."""
    rng, board, seen = np.random.default_rng(seed), Board(5, 4, 0.05, 0.037), list[Observation]()
    for vector in tilted(rng, 5, 40, 9):
        one = observe(replace(TRUTH, cx=700, cy=310), board, vector, rng, 0.03)
        T = shared_modes(board, board.points_of(one.ids))
        shift = 0.045 * T @ rng.normal(0, 1, (T.shape[1], 2))
        seen.append(replace(one, corners=one.corners + shift))
    assert turned_views(calibrate(board, seen)) == ()
    assert turned_views(calibrate(board, with_turned(seen, (2,)))) == (2,)


def test_real_pictures(shared_data: Path) -> None:
    """None is turned; four that are turned then are named."""
    files = sorted((shared_data / "lifecam-charuco-8x8").glob("*.[jp]*g"))
    board = Board(8, 8, 0.0254, 0.01905, "DICT_4X4_1000")
    pictures = [cv2.imread(str(file)) for file in files]
    found = calibrate_recording(pictures, board)
    assert not any(d.kind == "turned-pictures" for d in found.diagnoses)
    for index in (0, 6, 10, 14):
        pictures[index] = cv2.rotate(pictures[index], cv2.ROTATE_180)
    told = [
        d for d in calibrate_recording(pictures, board).diagnoses if d.kind == "turned-pictures"
    ]
    assert [d.views for d in told] == [(1, 7, 11, 15)]

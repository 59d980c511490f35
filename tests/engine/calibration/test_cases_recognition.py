"""Pictures of other boards than the one asked for: named as what they are, and read if possible."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.engine.board_pictures import picture_of
from venus3d.engine.calibration.board_recognition import recognise_board
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.diagnosis import Diagnosis, joined
from venus3d.engine.calibration.thin_borders import thin_border_diagnosis
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import KINDS, Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.images_calibration import calibrate_images, calibrate_recording

Picture = NDArray[np.uint8]
CAMERA = Camera(1280, 720, 1000, 1000, 640, 360)
POSE = Pose.from_vector([20, -25, 10, 0, 0, 0.45])


def grey_of(folder: Path, count: int = 3) -> list[Picture]:
    files = sorted(folder.glob("*.jpg"))[:count]
    return [np.asarray(cv2.imread(str(f), cv2.IMREAD_GRAYSCALE), np.uint8) for f in files]


def shown_in(pattern: Picture) -> Picture:
    """A pattern seen from the side."""
    height, width = pattern.shape
    flat = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float32)
    seen = np.array([[250, 120], [1000, 60], [1060, 640], [180, 600]], np.float32)
    H = cv2.getPerspectiveTransform(flat, seen)
    picture = cv2.warpPerspective(pattern, H, (1280, 720), borderValue=(110,))
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.8), np.uint8)


def tilted(pattern: Picture) -> Picture:
    """A pattern seen from the side, as long and as wide as it is."""
    height, width = pattern.shape
    flat = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float32)
    H = CAMERA.K @ np.column_stack([POSE.R[:, :2], POSE.t])
    scale = 0.22 / flat.max()
    seen = cv2.perspectiveTransform(((flat - flat.mean(axis=0)) * scale)[None], H)[0]
    back = cv2.getPerspectiveTransform(flat, seen)
    picture = cv2.warpPerspective(pattern, back, (1280, 720), borderValue=(110,))
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.8), np.uint8)


def told(picture: Picture, board: Board | None = None) -> Diagnosis:
    found = recognise_board(board or Board(), [picture])
    assert found is not None
    return found


def test_ids_from_30_are_found_said_and_read(shared_data: Path) -> None:
    """The diagnosis was "11 columns"."""
    folder = shared_data / "cases" / "ids-from-30"
    found = calibrate_recording(str(folder), Board())
    assert found.calibration.board.first_id == 30
    assert len(found.calibration.views) == 5
    assert found.calibration.rms_px < 0.08
    assert found.calibration.camera.fx == pytest.approx(1000, abs=2)
    (said,) = (d for d in found.diagnoses if d.kind == "other-first-id")
    assert "9 x 6" in said.cause and "--board.first-id 30" in said.cure
    asked = calibrate_recording(str(folder), Board(first_id=30))
    assert "other-first-id" not in [d.kind for d in asked.diagnoses]
    assert asked.calibration.camera == found.calibration.camera


@pytest.mark.parametrize("layout", [{}, {"legacy": True, "inverted": True}])
def test_another_first_id_is_read_while_pictures_come(layout: dict[str, bool]) -> None:
    printed = Board(first_id=17, **layout)
    picture = picture_of(printed, CAMERA, POSE)
    detector = Detector(Board())
    seen = [detector.detect(picture).count for _ in range(12)]
    assert seen[0] == 0 and seen[-1] == 40
    assert detector.board == printed
    assert "other-first-id" in [d.kind for d in detector.diagnoses]
    truth = CAMERA.project(POSE.apply(printed.corners))
    assert np.abs(detector.detect(picture).corners - truth).max() < 0.2
    kept = Detector(Board(), find_layout=False)
    assert [kept.detect(picture).count for _ in range(12)] == [0] * 12


def test_what_was_missed_is_explained_though_another_marker_size_was_read_since() -> None:
    """Where some ids are those of the board asked for, a few wrong corners are found, and with them
    a wrong marker size: the pictures that tell the first id were forgotten, and fx was 2 % off."""
    printed = Board(first_id=30)
    detector = Detector(Board(marker=0.012))
    missed = picture_of(printed, CAMERA, POSE)
    assert detector.detect(missed).count == 0
    assert detector.detect(picture_of(Board(), CAMERA, POSE)).count == 40
    assert detector.board.marker == pytest.approx(0.021, abs=0.0006)
    assert len(detector.missed_images) == 1
    assert "other-first-id" in [d.kind for d in detector.explain_misses()]
    assert detector.detect(missed).count == 40


def test_other_columns_and_first_id_at_once() -> None:
    said = told(picture_of(Board(8, 5, first_id=40), CAMERA, POSE))
    assert "--board.columns 8 --board.rows 5 --board.first-id 40" in said.cure


def test_mirrored_pictures_are_named_and_read_if_asked(shared_data: Path) -> None:
    folder = str(shared_data / "cases" / "mirrored")
    with pytest.raises(CalibrationError, match=r"mirrored.*--flip"):
        calibrate_images(folder, Board())
    camera = calibrate_images(folder, Board(), flip=True).camera
    assert camera.fx == pytest.approx(1000, abs=3)
    assert camera.cx == pytest.approx(645, abs=5), "the camera of the pictures as they should be"
    pictures = grey_of(Path(folder), 4)
    arrays = calibrate_images(pictures, Board(), flip=True).camera
    np.testing.assert_allclose(arrays.parameters[:4], camera.parameters[:4], atol=0.5)


@pytest.fixture(scope="module")
def six_pictures() -> list[Picture]:
    """Of the default board, none mirrored."""
    poses = [Pose.from_vector([a, b, 5, 0, 0, 0.45]) for a in (-30, 5, 30) for b in (-25, 25)]
    return [picture_of(Board(), CAMERA, pose) for pose in poses]


@pytest.mark.parametrize("mirrored", [1, 4, 6])
def test_a_few_mirrored_pictures_are_named_and_left_out(
    six_pictures: list[Picture], mirrored: int
) -> None:
    """Half of a set or fewer stayed unsaid."""
    pictures = six_pictures
    turned = [np.ascontiguousarray(picture[:, ::-1]) for picture in pictures[:mirrored]]
    found = calibrate_recording([*pictures, *turned], Board())  # pyright: ignore[reportArgumentType]
    assert len(found.calibration.views) == 6
    (said,) = (d for d in found.diagnoses if d.kind == "mirrored")
    assert said.cause.startswith("Some pictures") and "--flip" in said.cure


def test_pictures_of_which_none_is_mirrored_are_not_called_so(six_pictures: list[Picture]) -> None:
    alone = calibrate_recording(six_pictures, Board())  # pyright: ignore[reportArgumentType]
    assert "mirrored" not in [d.kind for d in alone.diagnoses]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("cases/aprilgrid", "an AprilGrid of 6 x 6 tags, 36h11"),
        ("cases/aruco-gridboard", "a grid of 6 x 4 markers of DICT_6X6_1000"),
        ("checkerboard-9x6", "a checkerboard of 9 x 6 inner corners"),
        ("fisheye-checkerboard-15x9", "a checkerboard of 15 x 9 inner corners"),
    ],
)
def test_other_patterns_are_named_as_what_they_are(
    shared_data: Path, name: str, sentence: str
) -> None:
    kind_of = {"cases/aprilgrid": "aprilgrid", "cases/aruco-gridboard": "aruco-grid"}
    kind = kind_of.get(name, "chessboard")
    pictures = grey_of(shared_data / name)
    said = recognise_board(Board(), pictures)
    assert said is not None and said.kind == "other-pattern"
    assert sentence in said.cause and "not the board asked for" in said.cause
    assert f"--board.kind {kind} " in said.cure if kind in KINDS else "is not read" in said.cure
    with pytest.raises(CalibrationError, match=sentence):
        calibrate_images(pictures, Board())


def test_circles_and_grids_of_small_markers_are_named() -> None:
    circles = np.full((700, 800), 255, np.uint8)
    for row in range(6):
        for column in range(7):
            cv2.circle(circles, (100 * column + 100, 100 * row + 100), 32, 0, -1, cv2.LINE_AA)
    assert "a grid of 7 x 6 circles" in told(shown_in(circles)).cause
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_100)
    grid = np.full((760, 560), 255, np.uint8)
    for number in range(35):
        y, x = 30 + 100 * (number // 5), 30 + 100 * (number % 5)
        grid[y : y + 77, x : x + 77] = dictionary.generateImageMarker(number, 77)
    assert "a grid of 5 x 7 markers" in told(shown_in(grid)).cause
    single = np.full((400, 400), 255, np.uint8)
    single[130:270, 130:270] = dictionary.generateImageMarker(7, 140)
    said = told(shown_in(single), Board(dictionary="DICT_6X6_100"))
    assert said.kind == "other-pattern" and "1 single markers of DICT_5X5" in said.cause


@pytest.mark.parametrize(("columns", "rows"), [(4, 11), (7, 9), (3, 7), (6, 6)])
def test_asymmetric_circles_are_named_with_the_size_that_opencv_reads_them_by(
    columns: int, rows: int
) -> None:
    """They were "a checkerboard of 10 x 7 inner corners"."""
    circles = np.full((60 * rows + 80, 120 * columns + 80), 255, np.uint8)
    for row in range(rows):
        for column in range(columns):
            centre = (70 + 120 * column + 60 * (row % 2), 70 + 60 * row)
            cv2.circle(circles, centre, 24, 0, -1, cv2.LINE_AA)
    assert cv2.findCirclesGrid(circles, (columns, rows), flags=cv2.CALIB_CB_ASYMMETRIC_GRID)[0]
    said = told(tilted(circles))
    assert said.kind == "other-pattern"
    assert f"an asymmetric grid of circles, {rows} rows of {columns}:" in said.cause


@pytest.mark.parametrize("square_px", [5, 6, 7, 9])
@pytest.mark.parametrize("asked", [None, Board(9, 6, 0.025, 0.02, kind="circles")])
def test_small_asymmetric_circles_are_no_checkerboard(square_px: int, asked: Board | None) -> None:
    """Their gaps look like one; the circles are found enlarged."""
    printed = Board(4, 9, 0.018, 0.016, kind="asymmetric-circles")
    camera = Camera(640, 360, 600, 600, 320, 180)
    pose = Pose.from_vector([15, -20, 8, 0, 0, 600 * printed.square / square_px])
    picture = picture_of(printed, camera, pose, noise=2.0, rng=np.random.default_rng(1))
    said = recognise_board(asked or printed, [picture])
    assert (said is None) if asked is None else said is not None
    assert said is None or "an asymmetric grid of circles, 9 rows of 4:" in said.cause


@pytest.mark.parametrize("square_px", [6, 8])
def test_small_checkerboards_stay_what_they_are(square_px: int) -> None:
    printed, camera = Board(10, 7, 0.024, kind="chessboard"), Camera(640, 360, 600, 600, 320, 180)
    pose = Pose.from_vector([15, -20, 8, 0, 0, 600 * printed.square / square_px])
    picture = picture_of(printed, camera, pose, noise=2.0, rng=np.random.default_rng(1))
    assert "a checkerboard of 9 x 6 inner corners" in told(picture).cause


@pytest.mark.parametrize(
    "printed",
    [Board(10, 7, 0.024, kind="chessboard"), Board(8, 6, 0.026, 0.016, kind="circles")],
    ids=lambda board: board.kind,
)
def test_a_size_given_too_large_is_named(printed: Board) -> None:
    asked = replace(printed, columns=printed.columns + 1, rows=printed.rows + 1)
    said = recognise_board(asked, [picture_of(printed, CAMERA, POSE)])
    assert said is not None
    assert f"--board.columns {printed.columns} --board.rows {printed.rows}" in said.cure


def test_a_part_of_an_asymmetric_grid_is_no_other_board() -> None:
    """Also where the part is wider than high."""
    asked = Board(4, 11, 0.02, 0.016, kind="asymmetric-circles")
    picture = picture_of(replace(asked, rows=8), CAMERA, POSE)
    assert recognise_board(asked, [picture]) is None
    larger = picture_of(replace(asked, rows=asked.rows + 2), CAMERA, POSE)
    assert recognise_board(asked, [larger]) is not None


def test_a_black_border_too_thin_to_read_is_told() -> None:
    """It was one of three guesses."""
    board = Board()
    side = 112
    drawn = board.cv_board.generateImage((9 * side, 6 * side)).copy()
    marker, cut = 84, 10  # of a border of 12 px
    for row in range(board.rows):
        for column in range(1 - row % 2, board.columns, 2):
            x, y = (side * n + (side - marker) // 2 for n in (column, row))
            inner = drawn[y + cut : y + marker - cut, x + cut : x + marker - cut].copy()
            drawn[y : y + marker, x : x + marker] = 255
            drawn[y + cut : y + marker - cut, x + cut : x + marker - cut] = inner
    picture = tilted(cv2.copyMakeBorder(drawn, 40, 40, 40, 40, cv2.BORDER_CONSTANT, value=255))
    assert Detector(board).detect(picture).count == 0
    said = told(picture)
    assert said.kind == "unread-markers" and "black border is too thin" in said.cause
    other = told(picture, Board(dictionary="DICT_6X6_100"))
    assert other.kind == "unread-markers" and "too small or blurred" in other.cause


@pytest.mark.parametrize("square_px", [12, 16, 19])
def test_squares_that_are_too_small_are_told_and_no_border(square_px: int) -> None:
    """Their markers' bits can't be told: it was called a border too thin, or blur."""
    board, camera = Board(marker=0.015), Camera(640, 480, 600, 600, 320, 240)
    pose = Pose.from_vector([5, 8, 4, 0, 0, 600 * board.square / square_px])
    said = told(picture_of(board, camera, pose, blur_px=0.8), board)
    assert said.kind == "small-board" and f"squares are {square_px} px wide" in said.cause
    assert f"{board.of_kind.legible_square_px(board):.0f} px are needed" in said.cause


def test_markers_that_nearly_fill_their_squares_are_told() -> None:
    """Their corners are found, with ten times the error."""
    board = Board(marker=0.026)
    detector = Detector(board)
    assert detector.detect(picture_of(board, CAMERA, POSE)).count > 20
    (said,) = (d for d in detector.diagnoses if d.kind == "thin-border")
    assert "only 1 mm wide, where a marker's cell is 3.7 mm" in said.cause
    # It is told before what follows from it.
    for kind in ("rolling-shutter", "poor-fit", "weak-focal-length", "folding"):
        assert joined([said], [Diagnosis(kind, "", "")])[0] is said
    for good in (Board(), Board(8, 8, 0.0254, 0.01905), Board(12, 8, 0.0180086, 0.0139954)):
        assert thin_border_diagnosis(good) is None


def test_what_is_no_pattern_is_not_named(shared_data: Path) -> None:
    rng = np.random.default_rng(0)
    for blur in (1, 3, 6):
        noise = cv2.GaussianBlur(rng.integers(0, 255, (480, 640), dtype=np.uint8), (0, 0), blur)
        stretched = cv2.normalize(noise, noise, 0, 255, cv2.NORM_MINMAX)
        assert recognise_board(Board(), [np.asarray(stretched, np.uint8)]) is None
    for size in ((1, 1), (3, 200), (40, 40)):
        assert recognise_board(Board(), [np.full(size, 90, np.uint8)]) is None
    for name in ("cases/board-too-small", "cases/fisheye-147deg"):
        assert recognise_board(Board(), grey_of(shared_data / name)) is None, "it is this board"


@pytest.mark.parametrize("given_mm", [5, 12, 18, 23, 24, 26])
def test_markers_of_another_size_than_given_are_measured(given_mm: float) -> None:
    """With 5 mm for 21 mm OpenCV finds all corners, up to 26 px from their places."""
    picture = picture_of(Board(), CAMERA, POSE)
    detector = Detector(Board(marker=given_mm / 1000))
    seen = [detector.detect(picture) for _ in range(12)][-1]
    truth = CAMERA.project(POSE.apply(Board().points_of(seen.ids)))
    assert seen.count == 40 and np.abs(seen.corners - truth).max() < 0.2
    assert detector.board.marker == pytest.approx(0.021, abs=0.0006)
    (said,) = detector.diagnoses
    assert said.kind == "wrong-marker-size" and f"not {given_mm} mm" in said.cause
    right = Detector(Board())
    right.detect(picture)
    assert right.diagnoses == () and right.board == Board()


def test_two_equal_boards_are_told() -> None:
    board = cv2.copyMakeBorder(Board().texture(40), *(4 * [40]), cv2.BORDER_CONSTANT, value=(255,))
    detector = Detector(Board())
    assert detector.detect(np.hstack([board, board])).count == 0
    assert [d.kind for d in detector.diagnoses] == ["two-boards"]
    assert "take it away" in detector.diagnoses[0].cure


def test_swapped_sides_name_both_numbers_of_squares() -> None:
    said = told(picture_of(Board(12, 8, 0.02, 0.015), CAMERA, POSE))
    assert "--board.columns 12 --board.rows 8" in said.cure
    other = replace(Board(12, 8, 0.02, 0.015), dictionary="DICT_4X4_250")
    assert (
        "--board.columns 12 --board.rows 8 --board.dictionary DICT_4X4_1000"
        in told(picture_of(other, CAMERA, POSE)).cure
    )


def grainy(picture: NDArray[np.uint8], rng: np.random.Generator, grain: float) -> Any:
    """As a small sensor takes it in a dim room."""
    noisy = 0.55 * picture + 30 + rng.normal(0, grain, picture.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


def test_squares_are_measured_by_single_markers_that_can_be_read() -> None:
    """No corner is found then: all that was said was that the board is in none of the pictures."""
    board, rng, detector = Board(), np.random.default_rng(20), Detector(Board())
    pose = Pose.from_vector([30, -30, 12, 0, 0, CAMERA.fx * board.square / 20])
    for _ in range(4):
        assert not detector.detect(
            grainy(picture_of(board, CAMERA, pose, blur_px=0.8), rng, 8)
        ).count
    (said,) = detector.explain_misses()
    narrow = 20 * np.cos(np.deg2rad(30))
    told = int(said.cause.split("squares are ")[1].split(" px")[0])
    assert said.kind == "small-board" and abs(told - narrow) <= 2


@pytest.mark.parametrize("square_px", [22, 24])
def test_a_board_at_the_limit_of_what_can_be_read_is_no_other_board(square_px: int) -> None:
    """Few of its markers are read then, and others by chance: it was called markers of DICT_4X4, a
    grid of tags or a board of another size, in 3 of these 40 noisy pictures."""
    board, rng = Board(), np.random.default_rng(square_px)
    for _ in range(20):
        turns = rng.uniform([-35, -35, -20], [35, 35, 20])
        pose = Pose.from_vector([*turns, 0, 0, CAMERA.fx * board.square / square_px])
        picture = grainy(picture_of(board, CAMERA, pose, blur_px=0.8), rng, 5)
        said = recognise_board(board, [picture])
        assert said is None or said.kind == "small-board", said

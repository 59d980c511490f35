"""Pictures of another focal length among the others are named, and nothing else is taken for that.

OpenCV projects the views, with a camera of its own for each.
"""

from __future__ import annotations

from itertools import product

import cv2
import numpy as np
import pytest

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.focal_changes import FEWEST_VIEWS, focal_change
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board

SIZE = (1280, 720)
DISTORTION = np.array([-0.15, 0.05, 0.001, -0.0005, 0.0])
BOARDS = [Board(9, 6), Board(8, 6, 0.025, kind="chessboard")]


def views(
    board: Board,
    factors: np.ndarray,
    *,
    seed: int = 0,
    noise_px: float = 0.07,
    bend_m: float = 0.0,
    roll_m: float = 0.0,
    moving: dict[int, float] | None = None,
) -> list[Observation]:
    """A view for each factor (N,) on the focal length, boards tilted by 15 to 40 degrees.

    Args:
        bend_m: each view's board is bent anew by up to this much.
        roll_m: each view's board moves by about this much while the rows are read.
        moving: the same for some views, by their indices.
    """
    rng = np.random.default_rng(seed)
    seen: list[Observation] = []
    while len(seen) < len(factors):
        tilt = np.radians(rng.uniform(15, 40)) * np.array([1, -1])[rng.integers(2, size=2)]
        around = rng.uniform(0, np.pi)
        rvec = np.array(
            [tilt[0] * np.cos(around), tilt[1] * np.sin(around), rng.uniform(-0.3, 0.3)]
        )
        tvec = np.array([*rng.uniform(-0.06, 0.06, 2), rng.uniform(0.35, 0.6)])
        f = 1000 * factors[len(seen)]
        K = np.array([[f, 0, 650], [0, 1.003 * f, 355], [0, 0, 1]])
        points = board.corners.copy()
        x, y = (points[:, :2] / np.abs(points[:, :2]).max(axis=0)).T
        points[:, 2] += bend_m * (rng.uniform(-1, 1) * x**2 + rng.uniform(-1, 1) * x * y)
        moved_m = (moving or {}).get(len(seen), roll_m)
        motion = moved_m * rng.normal(size=3)
        pixels, _ = cv2.projectPoints(points, rvec, tvec, K, DISTORTION)
        for _ in range(2 if moved_m else 0):  # where a row is read, the board is by then
            late = (pixels.reshape(-1, 2)[:, 1] / SIZE[1] - 0.5)[:, None] * motion
            R, _ = cv2.Rodrigues(rvec)
            pixels, _ = cv2.projectPoints(
                (points @ R.T + tvec + late), np.zeros(3), np.zeros(3), K, DISTORTION
            )
        pixels = pixels.reshape(-1, 2) + rng.normal(0, noise_px, (len(points), 2))
        if ((pixels > 0) & (pixels < np.array(SIZE) - 1)).all():
            seen.append(Observation(np.arange(len(points)), pixels, SIZE))
    return seen


def calibrated(board: Board, factors: np.ndarray, **how: float) -> Calibration:
    return calibrate(board, views(board, factors, **how))  # type: ignore[arg-type]


@pytest.mark.parametrize("board", BOARDS, ids=["charuco", "chessboard"])
@pytest.mark.parametrize(
    ("others", "factor"),
    [((3,), 1.05), ((3,), 0.95), *product([(0, 4, 8), (0, 2, 4, 6, 8)], [1.02, 1.05, 0.97])],
)
def test_pictures_of_another_focal_length_are_named(
    board: Board, others: tuple[int, ...], factor: float
) -> None:
    factors = np.ones(10)
    factors[list(others)] = factor
    found = calibrated(board, factors)
    change = focal_change(found)
    assert change is not None and change.is_sure
    # Of two halves the longer one.
    few = others if len(others) < 5 or factor > 1 else tuple(set(range(10)) - set(others))
    assert change.numbers == tuple(n + 1 for n in few)
    expected = factor if few is others else 1 / factor
    assert change.factor == pytest.approx(expected, abs=0.006)
    told = [one for one in diagnose(found) if one.kind == "changed-focal-length"]
    share = abs(change.factor - 1) * 100
    assert len(told) == 1 and told[0].views == change.numbers
    assert f"{share:.2g} % {'longer' if expected > 1 else 'shorter'} than" in told[0].cause
    assert not {"rolling-shutter", "poor-fit", "bent-board"} & {one.kind for one in diagnose(found)}


@pytest.mark.parametrize("board", BOARDS, ids=["charuco", "chessboard"])
def test_pictures_of_unequal_noise_are_named_too(board: Board) -> None:
    """A noisier picture looks as if an even motion explained something in it."""
    factors, noisy = np.ones(10), (0, 6)
    factors[::2] = 1.05
    quiet, loud = (views(board, factors, noise_px=noise) for noise in (0.04, 0.2))
    seen = [loud[k] if k in noisy else quiet[k] for k in range(10)]
    change = focal_change(calibrate(board, seen))
    assert change is not None and change.is_sure
    assert change.factor == pytest.approx(1.05, abs=0.006)


@pytest.mark.parametrize("board", BOARDS, ids=["charuco", "chessboard"])
def test_a_little_in_one_picture_may_be_a_motion(board: Board) -> None:
    """It is named, for what it may be."""
    factors = np.ones(10)
    factors[3] = 1.02
    found = calibrated(board, factors)
    told = [one for one in diagnose(found) if one.views == (4,)]
    assert [one.kind for one in told] == ["rolling-shutter"]
    assert "does not fit the others" in told[0].cause and "focused anew" in told[0].cause


@pytest.mark.parametrize(
    ("seed", "columns", "rows"), [(0, 6, 4), (10, 7, 5), (36, 7, 5), (57, 7, 5), (96, 5, 4)]
)
def test_a_picture_in_motion_is_not_taken_for_it(seed: int, columns: int, rows: int) -> None:
    """One of ten, on a board of few corners: each of these was, once. It is named all the same."""
    board, rng = Board(columns, rows), np.random.default_rng(seed)
    moved = int(rng.integers(10))
    seen = views(board, np.ones(10), seed=seed, moving={moved: 0.004})
    found = calibrate(board, seen)
    told = [one for one in diagnose(found) if moved + 1 in one.views]
    assert told and "changed-focal-length" not in {one.kind for one in diagnose(found)}


def test_few_views_tell_nothing() -> None:
    factors = np.ones(FEWEST_VIEWS - 1)
    factors[0] = 1.05
    assert focal_change(calibrated(BOARDS[0], factors)) is None


@pytest.mark.parametrize(
    "how",
    [{}, {"noise_px": 0.3}, {"bend_m": 0.001}, {"bend_m": 0.004}, {"roll_m": 0.002},
     {"roll_m": 0.008}],
    ids=["noise", "blur", "bent-1mm", "bent-4mm", "rolling-2mm", "rolling-8mm"],
)  # fmt: skip
@pytest.mark.parametrize("count", [6, 12])
def test_other_errors_are_not_taken_for_it(how: dict[str, float], count: int) -> None:
    """Each view's own errors, for six sets."""
    for seed in range(6):
        found = calibrated(BOARDS[seed % 2], np.ones(count), seed=seed, **how)
        assert focal_change(found) is None, seed

"""A lens model of too few coefficients is named as such, on real recordings and simulated ones."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.engine.calibration.test_adjustment import tilted
from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import (
    BROWN3,
    BROWN5,
    EQUIDISTANT,
    FISHEYE,
    PINHOLE,
    RATIONAL,
    LensModel,
)
from venus3d.engine.geometry.pose import Pose

STILLS = {
    "lifecam-charuco-8x8": Board(8, 8, 0.0254, 0.01905, "DICT_4X4_1000"),
    "sleap-charuco-8x11-top": Board(8, 11, 0.024, 0.01875, "DICT_4X4_1000"),
    "fisheye-checkerboard-15x9": Board(16, 10, 0.03, kind="chessboard"),
}


def kinds(board: Board, views: list[Observation], lens: LensModel) -> set[str]:
    return {one.kind for one in diagnose(calibrate(board, views, lens=lens))}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "too_poor", "rich"),
    [
        ("lifecam-charuco-8x8", (PINHOLE,), (BROWN3, BROWN5, RATIONAL)),
        ("sleap-charuco-8x11-top", (PINHOLE,), (BROWN3, BROWN5)),
        ("fisheye-checkerboard-15x9", (PINHOLE, BROWN3, BROWN5), (RATIONAL, FISHEYE)),
    ],
)
def test_it_is_named_on_real_pictures(
    shared_data: Path, name: str, too_poor: tuple[LensModel, ...], rich: tuple[LensModel, ...]
) -> None:
    """A board that is not flat was blamed, though the lens was (rms 9 px), or motion and blur."""
    board = STILLS[name]
    files = sorted(path for path in (shared_data / name).iterdir() if path.suffix != ".md")
    if name.startswith("fisheye"):  # where a poor lens fits nothing, each picture costs most
        files = files[::2]
    pictures = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in files]
    detector = Detector(board)
    seen = [detector.detect(picture) for picture in pictures if picture is not None]
    views = [one for one in seen if one.count >= 12]
    blamed = {"bent-board", "rolling-shutter", "poor-fit", "weak-focal-length", "folding"}
    for lens in too_poor:
        found = kinds(board, views, lens)
        assert "wrong-lens" in found and not blamed & found, (lens.name, found)
    for lens in rich:
        assert "wrong-lens" not in kinds(board, views, lens), lens.name


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("true", "coefficients", "focal", "asked"),
    [
        (BROWN3, (-0.3, 0.1, 0.0), 560, PINHOLE),
        (FISHEYE, (0.1, -0.05, 0.02, 0.0), 420, EQUIDISTANT),
    ],
    ids=["pinhole", "equidistant"],
)
def test_it_is_named_where_it_is_simulated(
    seed: int, true: LensModel, coefficients: tuple[float, ...], focal: float, asked: LensModel
) -> None:
    camera = Camera(1280, 720, focal, focal, 640, 360, coefficients=coefficients, lens=true)
    rng, board = np.random.default_rng(seed), Board()
    views: list[Observation] = []
    for vector in tilted(rng, 10, 45, 12):
        near_and_aside = Pose.from_vector(vector * [1, 1, 1, 2, 2, 0.7])
        pixels = camera.project(near_and_aside.apply(board.corners))
        pixels += rng.normal(0, 0.1, pixels.shape)
        inside = ((pixels >= 0) & (pixels <= np.array(camera.image_size) - 1)).all(axis=1)
        if inside.sum() >= 20:
            views.append(Observation(np.flatnonzero(inside), pixels[inside], camera.image_size))
    assert "wrong-lens" in kinds(board, views, asked)
    assert "wrong-lens" not in kinds(board, views, true)

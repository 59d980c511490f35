"""Real pictures out of focus are named as blurred, sharp ones and softer ones are not."""

from __future__ import annotations

from pathlib import Path

import cv2
import pytest

from venus3d.engine.calibration.checks import diagnose
from venus3d.engine.geometry.board import Board
from venus3d.sources.images_calibration import calibrate_images

LIFECAM = Board(columns=8, rows=8, square=0.0254, marker=0.01905, dictionary="DICT_4X4_1000")
CHECKERS = Board(kind="chessboard", columns=10, rows=7, square=0.025)
SETS = (("lifecam-charuco-8x8", LIFECAM), ("checkerboard-9x6", CHECKERS))


@pytest.mark.parametrize(("folder", "board"), SETS, ids=[name for name, _ in SETS])
@pytest.mark.parametrize(("blur_px", "is_told"), [(0.0, False), (1.0, False), (2.5, True)])
def test_a_set_out_of_focus(
    shared_data: Path, folder: str, board: Board, blur_px: float, is_told: bool
) -> None:
    files = sorted(file for file in (shared_data / folder).iterdir() if file.suffix != ".txt")
    pictures = [cv2.imread(str(file), cv2.IMREAD_GRAYSCALE) for file in files][:10]
    if blur_px:
        pictures = [cv2.GaussianBlur(picture, (0, 0), blur_px) for picture in pictures]
    told = [one for one in diagnose(calibrate_images(pictures, board)) if "blurred" in one.kind]
    assert bool(told) == is_told
    if is_told:
        assert "px wide, where at most 4.2 px are wanted" in told[0].cause
        assert told[0].views == ()

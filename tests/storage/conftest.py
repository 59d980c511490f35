"""A calibration, and what writes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.storage.result_folder import ResultFolder

Write = Callable[..., tuple[Path, Path]]
SUMMARY: dict[str, Any] = {"views": 4, "warnings": []}


@pytest.fixture(scope="session")
def calibration(paper_camera: Camera, default_board: Board) -> Calibration:
    """Four noisy views of the paper's camera."""
    rng = np.random.default_rng(3)
    views = []
    for p in (
        [35, 0, 0, 0, 0, 0.5],
        [0, 35, 5, 0, 0, 0.5],
        [-30, -20, 0, 0, 0, 0.5],
        [20, -30, 9, 0, 0, 0.5],
    ):
        corners = paper_camera.project(Pose.from_vector(p).apply(default_board.corners))
        noisy = corners + rng.normal(0, 0.2, corners.shape)
        views.append(Observation(np.arange(40), noisy, paper_camera.image_size, name=str(p[0])))
    return calibrate(default_board, views)


@pytest.fixture
def write(calibration: Calibration, default_board: Board) -> Write:
    """Write a result whose summary says `mark` through a session's folder."""

    def write_one(files: ResultFolder, mark: object = "", run: int = 1) -> tuple[Path, Path]:
        return files.write(calibration, {**SUMMARY, "mark": mark}, run=run)

    return write_one

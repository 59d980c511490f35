"""`venus3d study flatness`: what a board that is not flat costs, by simulated bows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import cv2
import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.settings import Settings
from venus3d.study.runner import Row
from venus3d.study.simulated import guided_calibrations, observed
from venus3d.study.text import mean_sd, table

BOWS_MM: tuple[float, ...] = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""How far the middle of the board lies behind its two ends."""
NOISE_PX = 0.1


def flatness(repeats: int, seed: int, views: int = 12) -> list[Row]:
    """A row for each bow and repeat: errors against the true camera when the board is taken as flat
    (`cv2.calibrateCamera`) and when its bow is estimated where the views ask for it. The poses are
    guided ones, the same for every bow."""

    def see(pose: Pose, rng: np.random.Generator) -> Observation:
        return observed(PAPER_CAMERA, Board(), pose, rng, NOISE_PX)

    *_, last = guided_calibrations(Settings(), views, seed=seed, repeat=0, see=see)
    rows: list[Row] = []
    for bow_mm in BOWS_MM:
        held = replace(Board(), bow=(bow_mm / 1000, 0.0))
        for repeat in range(repeats):
            rng = np.random.default_rng([seed, repeat])
            seen = [observed(PAPER_CAMERA, held, pose, rng, NOISE_PX) for pose in last.poses]
            rows.append({"bow_mm": bow_mm, "repeat": repeat, **_errors(seen)})
    return rows


def _errors(seen: Sequence[Observation]) -> Row:
    board, row = Board(), Row()
    flat = _opencv(board, seen)
    ours = calibrate(board, seen)
    for name, camera in (("flat", flat), ("bow", ours.camera)):
        row[f"{name}_diff_px"] = round(projection_diff_px(PAPER_CAMERA, camera), 5)
        row[f"{name}_fx_px"] = round(camera.fx - PAPER_CAMERA.fx, 4)
    return row | {"promised_px": round(ours.uncertainty_px, 5), "found_mm": _bow_mm(ours)}


def _bow_mm(calibration: Calibration) -> float:
    return round(1000 * calibration.board.bow[0], 4)


def _opencv(board: Board, seen: Sequence[Observation]) -> Camera:
    points: list[Any] = [board.points_of(o.ids).astype(np.float32) for o in seen]
    corners: list[Any] = [o.corners.astype(np.float32) for o in seen]
    size = seen[0].image_size
    K: Any = None
    _, K, distortion, _, _ = cv2.calibrateCamera(points, corners, size, K, K)
    return Camera.from_opencv(K, distortion, size)


def flatness_text(rows: Sequence[Row]) -> str:
    """Means and their spread over the repeats, a line for each bow."""
    lines: list[list[str]] = []
    for bow_mm in BOWS_MM:
        mine = [row for row in rows if row["bow_mm"] == bow_mm]

        def told(name: str, digits: int, of: Sequence[Row] = mine) -> str:
            return mean_sd([float(row[name]) for row in of], digits)

        lines.append(
            [
                f"{bow_mm:g} mm",
                told("flat_fx_px", 2),
                told("flat_diff_px", 3),
                told("bow_fx_px", 2),
                told("bow_diff_px", 3),
                told("promised_px", 3),
                told("found_mm", 3),
            ]
        )
    head = ["bow", "taken as flat: fx off", "error px", "estimated: fx off", "error px"]
    return table([*head, "promised px", "bow found, mm"], lines)

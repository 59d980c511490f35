"""Measures and fits the curve in `engine.calibration.corner_noise` on renders with ground truth.

    rows = measure_noise(views=500)
    fit_noise(rows)                    # -> NoiseModel

About a fifth of a second per view. docs/costs.md explains its use.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from venus3d.engine.calibration.corner_noise import NoiseModel, tilt_and_width
from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.geometry.visibility import visibility_of
from venus3d.sources.sim import Simulation

TILTS_DEG = (0.0, 65.0)
WIDTHS_PX = (12.0, 80.0)
REFERENCE_PX = 40.0
_FEW = 8  # no spread is computed from fewer corners


@dataclass(frozen=True)
class NoiseRow:
    """One rendered view."""

    tilt_deg: float
    width_px: float
    """Of a square at the board's centre, foreshortened."""
    found: float
    """Share of the corners found."""
    sigma_px: float
    """Rms error of a coordinate of the corners found; NaN if there are few."""


def measure_noise(views: int, seed: int = 0) -> tuple[NoiseRow, ...]:
    """Detect the board in renders of random poses, wholly in the image."""
    camera, board, rng = PAPER_CAMERA, Board(), np.random.default_rng(seed)
    detector = Detector(board, find_layout=False)
    simulation = Simulation(camera, board, autopilot=False, seed=seed)
    rows: list[NoiseRow] = []
    try:
        while len(rows) < views:
            wanted = _any_pose(camera, board, rng)
            if not _all_visible(camera, board, wanted):
                continue
            simulation.move_to(wanted)
            pose, frame = simulation.board_pose, simulation.read()
            assert frame is not None, "the simulation ends only when it is closed"
            seen = detector.detect(frame.image)
            truth = camera.project(pose.apply(board.points_of(seen.ids)))
            enough = seen.count >= _FEW
            sigma = float(np.sqrt(np.mean((seen.corners - truth) ** 2))) if enough else np.nan
            tilt, width = tilt_and_width(camera, board, pose.vector())
            share = seen.count / board.corner_count
            rows.append(NoiseRow(float(tilt[0]), float(width[0]), share, sigma))
    finally:
        simulation.close()
    return tuple(rows)


def fit_noise(rows: Sequence[NoiseRow]) -> NoiseModel:
    """Fit `NoiseModel`'s curve to the rows with a robust loss."""
    tilt, width, found, sigma = np.array(
        [[row.tilt_deg, row.width_px, row.found, row.sigma_px] for row in rows]
    ).T
    slope, size = -np.log(np.cos(np.radians(tilt))), np.log(width / REFERENCE_PX)
    # In a view with few corners, those found are the lucky ones.
    good = np.isfinite(sigma) & (found > 0.3)

    def noise(x: Array) -> Array:
        predicted = x[0] - x[1] * size[good] + x[2] * slope[good]
        return predicted - np.log(sigma[good])

    def share(x: Array) -> Array:
        return 1 / (1 + np.exp(-x[1] * (size - x[0] + x[2] * slope))) - found

    level = float(np.median(np.log(sigma[good])))
    _, power, tilt_power = least_squares(noise, [level, 0.5, 0.0], loss="soft_l1", f_scale=0.15).x
    at, found_power, found_tilt = least_squares(
        share, [-0.5, 10.0, 0.0], loss="soft_l1", f_scale=0.1
    ).x
    return NoiseModel(
        reference_px=REFERENCE_PX,
        noise_power=float(power),
        tilt_power=float(tilt_power),
        found_px=float(REFERENCE_PX * np.exp(at)),
        found_power=float(found_power),
        found_tilt_power=float(found_tilt),
    )


def _any_pose(camera: Camera, board: Board, rng: np.random.Generator) -> Pose:
    """Uniform tilts, log-uniform widths; random direction of tilt, roll and place."""
    tilt, azimuth = np.radians(rng.uniform(*TILTS_DEG)), rng.uniform(0, 2 * np.pi)
    width = np.exp(rng.uniform(*np.log(WIDTHS_PX)))
    z = camera.fx * board.square * np.cos(tilt) / width
    u, v = rng.uniform([0, 0], camera.image_size)
    line = np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0])
    tilted = Rotation.from_rotvec(tilt * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]))
    rolled = Rotation.from_euler("z", rng.uniform(0, 360), degrees=True)
    return Pose(np.asarray((tilted * rolled).as_matrix(), dtype=np.float64), z * line)


def _all_visible(camera: Camera, board: Board, pose: Pose) -> bool:
    sight = visibility_of(camera, board, pose.vector()[None])
    inside = (sight.low[:, 0] >= 0) & (sight.high[:, 0] <= np.array(camera.image_size) - 1)
    return bool(sight.seen[0] and inside.all())

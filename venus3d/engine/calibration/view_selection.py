"""Selects the frames of a recording to calibrate from: those that carry information.

A video shows nearly the same view many times, and every n-th frame favours where the board rested
longest. Here each frame taken adds the most information to those taken before (D-optimal, greedy).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.information import information_of, prior_information
from venus3d.engine.calibration.observation import (
    Observation,
    determines_homography,
    reprojection_errors,
    rms_distance,
)
from venus3d.engine.calibration.repeats import SAME, shift_px
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

_SHARP = 0.7  # of the median sharpness; below it a frame is blurred
_FITS = 3.0  # times the median error; above it a frame's corners do not fit this board
_FIRST_FRAMES = 20  # evenly spread, for the camera by which all frames are judged
_NOISE_PX = 0.3  # of a corner; weighs the frames against the prior


@dataclass(frozen=True, eq=False)
class _Candidate:
    index: int
    observation: Observation
    information: Array
    rms_px: float


def select_views(
    board: Board, observations: Sequence[Observation], *, limit: int = 40
) -> list[int]:
    """Indices of the observations to calibrate from, ascending; empty if none is usable.

    Args:
        board: the board in the observations.
        observations: of one image size, in order of time; those without a board, blurred ones and
            those whose corners do not fit the board are ignored.
        limit: the maximum number to take; a repeat of one taken is none.
    """
    usable = [
        i for i, o in enumerate(observations) if determines_homography(board.points_of(o.ids))
    ]
    if not usable:
        return []
    median = float(np.median([observations[i].sharpness for i in usable]))
    sharp = [i for i in usable if observations[i].sharpness >= _SHARP * median]
    camera = _first_camera(board, [observations[i] for i in sharp])
    candidates = _candidates(camera, board, observations, sharp)
    known = prior_information(camera, _NOISE_PX)
    same_px = SAME * camera.width
    chosen: list[_Candidate] = []
    while candidates and len(chosen) < limit:
        # The determinant of a covariance is its ellipsoid's squared volume: no units to weigh.
        informations = known + np.array([c.information for c in candidates])
        gains = np.linalg.slogdet(informations)[1]
        best = candidates[int(np.argmax(gains))]
        chosen.append(best)
        known = known + best.information
        candidates = [c for c in candidates if shift_px(c.observation, best.observation) >= same_px]
    return sorted(c.index for c in chosen)


def _first_camera(board: Board, observations: list[Observation]) -> Camera:
    places = np.linspace(0, len(observations) - 1, min(_FIRST_FRAMES, len(observations)))
    spread = [observations[i] for i in np.unique(np.rint(places).astype(int))]
    try:
        return calibrate(board, spread).camera
    except CalibrationError:
        # A frame's information depends on the board's pose, hardly on the exact camera; whether the
        # frames determine one is checked by the calibration that follows.
        return Camera.guess(observations[0].image_size)


def _candidates(
    camera: Camera, board: Board, observations: Sequence[Observation], indices: list[int]
) -> list[_Candidate]:
    found: list[_Candidate] = []
    for index in indices:
        observation = observations[index]
        pose = estimate_pose(camera, board, observation)
        if pose is None:
            continue
        rms = rms_distance(reprojection_errors(camera, board, observation, pose))
        information = information_of(camera, board, observation, pose)
        if np.isfinite(rms) and np.isfinite(information).all():
            found.append(_Candidate(index, observation, information, rms))
    if not found:
        return []
    worst = _FITS * float(np.median([c.rms_px for c in found])) + 1e-9
    return [c for c in found if c.rms_px <= worst]

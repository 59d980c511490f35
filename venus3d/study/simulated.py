"""Guided calibrations on simulated corners: the paper's camera and noise, targets followed exactly.

Nothing is rendered or detected: corners are projections with Gaussian noise (4.1.2). Poses are
chosen by the engine's own `Work` under its `Settings`, so the study tests what guides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.information import covariance_of, view_information
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import grid_pixels, projection_uncertainty_px
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.work import Outcome, Work
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.limits import Limits

NOISE_PX = float(np.sqrt(0.1))
"""Standard deviation of a corner coordinate: variance 0.1 px^2 (4.1.2)."""
START_DEG = 45.0
"""The first pose, [45, 0, 0, 0, 0, z] (3.1)."""


@dataclass(frozen=True, eq=False)
class SimulatedCalibration:
    """One calibration of a guided sequence."""

    outcome: Outcome
    poses: tuple[Pose, ...]
    """`T_camera_board`, the true poses of the views."""
    lost: int
    """Views so far that could not be calibrated with the others and were retaken."""


def guided_calibrations(
    settings: Settings,
    views: int,
    *,
    seed: int,
    repeat: int,
    truth: Camera = PAPER_CAMERA,
    board: Board | None = None,
    noise_px: float = NOISE_PX,
) -> Iterator[SimulatedCalibration]:
    """Calibrations with 1, 2, ... `views` views, each taken exactly at its target.

    The noise depends on the seed, the repeat and the view alone, so that methods are compared in
    pairs; the search's randomness comes from `settings.seed`.

    Raises `CalibrationError` if a view fails repeatedly.
    """
    held = board or Board()
    # These corners have uniform noise, and no forecast is needed.
    settings = replace(
        settings,
        max_views=views + 1,
        seed=_one_seed(seed, repeat),
        noise=None,
        wanted_uncertainty_px=None,
    )
    pose = first_pose(truth, held)
    work: Work | None = None
    poses: list[Pose] = []
    lost = 0
    for view in range(views):
        for attempt in range(10):
            rng = np.random.default_rng([seed, repeat, view, attempt])
            seen = observed(truth, held, pose, rng, noise_px)
            try:
                outcome = _following(work, settings, held, seen).run()
                break
            except CalibrationError:
                lost += 1
        else:
            raise CalibrationError(f"View {view + 1} failed ten times with new noise each time.")
        poses.append(pose)
        yield SimulatedCalibration(outcome, tuple(poses), lost)
        work = outcome.work
        if outcome.suggestion is not None:
            work = replace(work, heuristic_state=outcome.suggestion.state)
            pose = outcome.suggestion.target.pose
        work = replace(work, history=outcome.history)


def observed(
    truth: Camera, board: Board, pose: Pose, rng: np.random.Generator, noise_px: float = NOISE_PX
) -> Observation:
    """The board's corners within the image as seen by a detector with this noise."""
    pixels = truth.project(pose.apply(board.corners))
    pixels = pixels + rng.normal(0, noise_px, pixels.shape)
    inside = ((pixels >= 0) & (pixels < truth.image_size)).all(axis=1)
    return Observation(np.flatnonzero(inside), pixels[inside], truth.image_size)


def first_pose(truth: Camera, board: Board) -> Pose:
    """[45, 0, 0, 0, 0, z] with the smallest z at which the frontal board is wholly in the image."""
    limits = replace(Limits.for_board(board, truth), nearest=0.0, min_square_px=0.0)
    z = np.geomspace(0.05, 5.0, 2000)
    frontal = np.zeros((len(z), 6))
    frontal[:, 5] = z
    seen = np.flatnonzero(limits.accepts(truth, board, frontal))
    return Pose.from_vector([START_DEG, 0, 0, 0, 0, float(z[seen[0]])])


def _one_seed(seed: int, repeat: int) -> int:
    return int(np.random.SeedSequence([seed, repeat]).generate_state(1)[0])


def _following(before: Work | None, settings: Settings, board: Board, seen: Observation) -> Work:
    if before is None:
        return Work(
            board=board,
            settings=settings,
            observations=(seen,),
            numbers=(1,),
            history=(),
            heuristic_state=HeuristicState(),
            skipped=(),
            target_number=1,
            start=calibrate(board, [seen], model="startup").camera,
            keep_going=True,
        )
    return replace(
        before,
        observations=(*before.observations, seen),
        numbers=(*before.numbers, len(before.numbers) + 1),
        target_number=before.target_number + 1,
    )


def true_information(board: Board, poses: Sequence[Pose], truth: Camera = PAPER_CAMERA) -> Array:
    """(9, 9) true information of views under these poses, for corner noise of one pixel."""
    R = np.array([pose.R for pose in poses])
    t = np.array([pose.t for pose in poses])
    return np.asarray(view_information(truth, board.corners, R, t).sum(axis=0))


def true_error_px(board: Board, poses: Sequence[Pose], truth: Camera = PAPER_CAMERA) -> float:
    """Mean projection error over the image after views under these poses, pixels.

    From the true camera and noise, so methods are compared by their poses alone. Infinite while the
    views do not determine all nine parameters.
    """
    try:
        covariance = covariance_of(true_information(board, poses, truth), NOISE_PX)
    except np.linalg.LinAlgError:
        return float("inf")
    error = projection_uncertainty_px(truth, covariance)
    return error if (np.diag(covariance) > 0).all() else float("inf")


def points_before(truth: Camera, depth: float = 1.0) -> Array:
    """(96, 3) points that the true camera sees in a grid over its whole image, at one depth (m)."""
    xy = truth.unproject(grid_pixels(truth.image_size))
    return depth * np.concatenate([xy, np.ones((len(xy), 1))], axis=1)

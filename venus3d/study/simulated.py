"""Guided calibrations on simulated corners, by several arms, and the paper's indicators (4.1.1).

Nothing is rendered or detected: corners are projections with Gaussian noise (4.1.2), and targets
are followed exactly. Poses are chosen by the engine's own `Work` under its `Settings`, so the study
tests what guides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.information import (
    covariance_of,
    shared_modes,
    view_information,
)
from venus3d.engine.calibration.lens_choice import start_with_any_lens
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import (
    grid_pixels,
    projection_diff_px,
    projection_uncertainty_px,
)
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.geometry.lenses import lens_chosen
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.work import Outcome, Work
from venus3d.engine.planning.costs import index_of_dispersion
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.limits import Limits
from venus3d.sources.sim_cameras import SIM_CAMERAS, SimCamera
from venus3d.study.runner import Row

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
    see: Callable[[Pose, np.random.Generator], Observation] | None = None,
) -> Iterator[SimulatedCalibration]:
    """Calibrations with 1, 2, ... `views` views, each taken exactly at its target.

    The noise depends on the seed, the repeat and the view alone, so that methods are compared in
    pairs; the search's randomness comes from `settings.seed`. What is seen of the board at a pose
    is told by `see`; if None, its projected corners with the paper's noise (`observed`).

    Raises `CalibrationError` if a view fails repeatedly.
    """
    board = Board()
    # These corners have uniform noise, and no forecast is needed.
    settings = replace(
        settings,
        max_views=views + 1,
        seed=_one_seed(seed, repeat),
        noise=None,
        wanted_uncertainty_px=None,
    )
    pose = first_pose(truth, board)
    work: Work | None = None
    poses: list[Pose] = []
    lost = 0
    for view in range(views):
        for attempt in range(10):
            rng = np.random.default_rng([seed, repeat, view, attempt])
            seen = observed(truth, board, pose, rng) if see is None else see(pose, rng)
            try:
                outcome = _following(work, settings, board, seen).run()
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
    truth: Camera,
    board: Board,
    pose: Pose,
    rng: np.random.Generator,
    noise_px: float = NOISE_PX,
    shared_px: float = 0.0,
) -> Observation:
    """The board's corners within the image as seen by a detector with this noise. With a shared
    part, the view's corners also move together: a smooth draw over the board (`shared_errors`)."""
    pixels = truth.project(pose.apply(board.corners))
    pixels = pixels + rng.normal(0, noise_px, pixels.shape)
    if shared_px > 0:
        modes = shared_modes(board, board.corners)
        pixels = pixels + modes @ rng.normal(0, shared_px, (modes.shape[1], 2))
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
            start=start_with_any_lens(board, [seen], lens=lens_chosen(settings.lens)).camera,
            keep_going=True,
        )
    return replace(
        before,
        observations=(*before.observations, seen),
        numbers=(*before.numbers, len(before.numbers) + 1),
        target_number=before.target_number + 1,
    )


def true_information(board: Board, poses: Sequence[Pose], truth: Camera = PAPER_CAMERA) -> Array:
    """(p, p) true information of views under these poses, for corner noise of one pixel."""
    R = np.array([pose.R for pose in poses])
    t = np.array([pose.t for pose in poses])
    return np.asarray(view_information(truth, board.corners, R, t).sum(axis=0))


def true_error_px(board: Board, poses: Sequence[Pose], truth: Camera = PAPER_CAMERA) -> float:
    """Mean projection error over the image after views under these poses, pixels.

    From the true camera and noise, so methods are compared by their poses alone. Infinite while the
    views do not determine all parameters.
    """
    try:
        covariance = covariance_of(true_information(board, poses, truth), NOISE_PX)
    except np.linalg.LinAlgError:
        return float("inf")
    error = projection_uncertainty_px(truth, covariance)
    return error if (np.diag(covariance) > 0).all() else float("inf")


def points_before(truth: Camera) -> Array:
    """(96, 3) points that the true camera sees in a grid over its whole image, at a depth of 1 m;
    of a wide lens at that distance, those from which a ray comes."""
    rays = truth.unproject(grid_pixels(truth.image_size))
    if not truth.lens.is_perspective:
        return rays[np.isfinite(rays).all(axis=1)]
    return rays / rays[:, 2:]


@dataclass(frozen=True)
class Arm:
    """One way to choose poses."""

    label: str
    """Label of its line in a plot."""
    settings: Settings


ARMS: Mapping[str, Arm] = {
    "random": Arm("random poses", Settings(method="random")),
    "random-rms": Arm("random start, RmsErr", Settings(method="venus", start="random", cost="rms")),
    "random-max-iod": Arm(
        "random start, MaxIOD", Settings(method="venus", start="random", cost="max-iod")
    ),
    "generated-rms": Arm("generated start, RmsErr", Settings(method="venus", cost="rms")),
    "pose-selection": Arm("Pose selection", Settings(method="pose-selection")),
    "venus": Arm("Pose search", Settings(method="venus")),
    "global": Arm("global", Settings(method="global")),
}


@dataclass(frozen=True)
class ArmTrial:
    """One calibration by one arm. Trials of one repeat share the first pose and the noise."""

    arm: str
    repeat: int
    seed: int
    views: int
    camera: SimCamera = "webcam"

    @property
    def key(self) -> str:
        """`arm/repeat`."""
        return f"{self.arm}/{self.repeat}"


def run_arm(trial: ArmTrial) -> Sequence[Row]:
    """A row for each number of views. The kind of lens is known, its parameters are not."""
    truth = SIM_CAMERAS[trial.camera]
    stages = guided_calibrations(
        replace(ARMS[trial.arm].settings, lens=truth.lens.name),
        trial.views,
        seed=trial.seed,
        repeat=trial.repeat,
        truth=truth,
    )
    return [
        {
            "arm": trial.arm,
            "repeat": trial.repeat,
            "views": len(stage.poses),
            **indicators(stage.outcome.calibration, truth),
            "true_projection_error_px": true_error_px(stage.outcome.work.board, stage.poses, truth),
            "converged": int(stage.outcome.convergence.converged),
            "retaken": stage.lost,
        }
        for stage in stages
    ]


def indicators(calibration: Calibration, truth: Camera) -> Row:
    """Measures of a calibration; `sum_iod` is NaN while not all parameters are estimated."""
    full = all(calibration.free)
    iod = index_of_dispersion(calibration.camera, calibration.covariance)
    return {
        "model": "full" if full else "startup" if any(calibration.free) else "guessed",
        "sum_iod": float(iod.sum()) if full else float("nan"),
        "abs_rms_err_px": abs_rms_err_px(truth, calibration.camera),
        "abs_rms_err_rotated_px": projection_diff_px(truth, calibration.camera),
        "rms_err_px": calibration.rms_px,
        "fx_error_px": abs(calibration.camera.fx - truth.fx),
    }


def abs_rms_err_px(truth: Camera, estimate: Camera) -> float:
    """AbsRmsErr (4.1.1): rms distance of the same 3D points through true and estimated intrinsics.

    The paper does not specify the points; here they are a grid of the true image. Both cameras have
    the same pose, so a principal point off by 3 px counts as 3 px although a rotation of a tenth of
    a degree undoes it, unlike in `projection_diff_px`.
    """
    points = points_before(truth)
    # Without a radius limit: also beyond the fold of a bad estimate.
    pixels = estimate.pixels_of(np.ascontiguousarray(points.T)).T
    off = pixels - truth.project(points)
    return float(np.sqrt((off**2).sum(axis=1).mean()))

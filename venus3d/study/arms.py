"""Ways to choose poses, run on simulated corners and measured by the paper's indicators (4.1.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.calibration.result import Calibration
from venus3d.engine.geometry.camera import PAPER_CAMERA, Camera
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.costs import index_of_dispersion
from venus3d.study.runner import Value
from venus3d.study.simulated import guided_calibrations, points_before, true_error_px


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

    @property
    def key(self) -> str:
        """`arm/repeat`."""
        return f"{self.arm}/{self.repeat}"


def run_arm(trial: ArmTrial) -> Sequence[Mapping[str, Value]]:
    """A row for each number of views."""
    stages = guided_calibrations(
        ARMS[trial.arm].settings, trial.views, seed=trial.seed, repeat=trial.repeat
    )
    return [
        {
            "arm": trial.arm,
            "repeat": trial.repeat,
            "views": len(stage.poses),
            **indicators(stage.outcome.calibration, PAPER_CAMERA),
            "true_projection_error_px": true_error_px(
                stage.outcome.work.board, stage.poses, PAPER_CAMERA
            ),
            "converged": int(stage.outcome.convergence.converged),
            "retaken": stage.lost,
        }
        for stage in stages
    ]


def indicators(calibration: Calibration, truth: Camera) -> dict[str, Value]:
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
    xy = estimate.distort(points[:, :2] / points[:, 2:])
    pixels = xy * [estimate.fx, estimate.fy] + [estimate.cx, estimate.cy]
    off = pixels - truth.project(points)
    return float(np.sqrt((off**2).sum(axis=1).mean()))

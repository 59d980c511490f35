"""A calibration: the camera, its covariance and the views, as one frozen value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array


def rms_distance(errors: Array) -> float:
    """Root mean square length of vectors (N, 2)."""
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


@dataclass(frozen=True, eq=False)
class Calibration:
    """The calibrated camera with its covariance and its views."""

    board: Board
    """The board whose corners the views show."""
    camera: Camera
    covariance: Array
    """(9, 9) of the `PARAMETERS`; zero rows and columns for parameters held fixed."""
    free: tuple[bool, ...]
    """Which of the nine parameters were estimated."""
    residual_sigma_px: float
    """Standard deviation of one corner coordinate, from the residuals, pixels."""
    rms_px: float
    """Root mean square reprojection distance over all corners, pixels (OpenCV's rms)."""
    views: tuple[View, ...]

    @property
    def sigma(self) -> Array:
        """(9,) standard deviations of the `PARAMETERS`; 0 where a parameter was held fixed."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def uncertainty_px(self) -> float:
        """Projection uncertainty: expected rms error of a projected point over the image. Common
        rotations of the camera are removed. NaN unless all nine parameters were estimated."""
        if not all(self.free):
            return float("nan")
        return projection_uncertainty_px(self.camera, self.covariance)

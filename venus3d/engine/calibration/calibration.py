"""The result of a calibration: the camera with its covariance, its views, and what was left out."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from venus3d.engine.calibration.observation import Observation, View
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.calibration.shared_errors import CornerErrors
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

LeftOutReason = Literal["undetermined", "misfit", "repeat", "turned"]


@dataclass(frozen=True, eq=False)
class LeftOut:
    """A view that the calibration does without."""

    number: int
    observation: Observation
    reason: LeftOutReason
    """"undetermined": its corners fix no pose; "misfit": they fit no pose of this board; "repeat":
    they are where another view's are, and count once (see `repeats`); "turned": its picture is
    turned by 180° against the others (see `turned_pictures`)."""


@dataclass(frozen=True, eq=False)
class Calibration:
    """The calibrated camera with its covariance and its views."""

    board: Board
    """The board whose corners the views show, with the bow, the stretch and the tags' side that
    were found."""
    camera: Camera
    covariance: Array = field(repr=False)
    """(p, p) of the camera's parameters; zero rows and columns for parameters held fixed. With the
    errors that the corners of a view share."""
    covariance_noise_only: Array = field(repr=False)
    """(p, p) the same as if each corner's error were independent, as OpenCV reports it."""
    free: tuple[bool, ...] = field(repr=False)
    """Which of the parameters were estimated."""
    residual_sigma_px: float
    """Standard deviation of one corner coordinate, from the residuals, pixels."""
    corner_errors: CornerErrors
    """What of it is independent, and what a view's corners share."""
    rms_px: float
    """Root mean square reprojection distance over all corners fitted, pixels (OpenCV's rms)."""
    views: tuple[View, ...] = field(repr=False)
    left_out: tuple[LeftOut, ...] = field(default=(), repr=False)
    """Views that are not fitted, by number."""
    lens_reason: str = ""
    """Why this lens, in a sentence; empty if it was asked for, or is the usual one."""
    shape_sigma: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Standard deviations of the board's two `bow`s, metres, and of its `stretch`; 0 where the
    residuals did not ask for it."""
    marker_sigma: float = 0.0
    """Of the tags' side, metres; 0 unless the residuals asked for another one than given."""

    @property
    def sigma(self) -> Array:
        """(p,) standard deviations of the parameters; 0 where a parameter was held fixed."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def sigma_noise_only(self) -> Array:
        """(p,) the same of `covariance_noise_only`: OpenCV's `stdDeviationsIntrinsics`."""
        return np.sqrt(np.diag(self.covariance_noise_only))

    @property
    def knows_less_than_views(self) -> bool:
        """Whether the covariance is wider than a flat board and independent noise would have it: by
        errors that corners share, a shape of the board, or a doubt about it."""
        has_shape = any(self.shape_sigma) or self.marker_sigma > 0
        return has_shape or not np.array_equal(self.covariance, self.covariance_noise_only)

    @property
    def uncertainty_px(self) -> float:
        """Projection uncertainty: expected rms error of a projected point over the image. Common
        rotations of the camera are removed. NaN unless all parameters were estimated."""
        if not all(self.free):
            return float("nan")
        return projection_uncertainty_px(self.camera, self.covariance)


def largest_angle_deg(calibration: Calibration) -> float:
    """The largest angle between the normals of any two views, degrees; 0 for a single view."""
    normals = np.array([view.pose.R[:, 2] for view in calibration.views])
    return float(np.degrees(np.arccos(np.clip(np.min(normals @ normals.T), -1.0, 1.0))))

"""Bundle adjustment: from observations to a `Calibration`, the camera and its covariance.

OpenCV finds the optimum (`cv2.calibrateCamera`, Zhang 2000, eq. (9) of the paper) but returns
standard deviations only, and those of independent noise; the covariance is computed here, with the
errors that a view's corners share (`shared_errors`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import cv2
import numpy as np

from venus3d.engine.calibration.information import covariance_of, information_of
from venus3d.engine.calibration.observation import Observation, View, reprojection_errors
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.calibration.shared_errors import (
    CornerErrors,
    ViewResidual,
    corner_errors,
    robust_covariance,
)
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PARAMETERS, Camera
from venus3d.engine.geometry.pose import Array, Pose


@dataclass(frozen=True, eq=False)
class Calibration:
    """The calibrated camera with its covariance and its views."""

    board: Board
    """The board whose corners the views show."""
    camera: Camera
    covariance: Array
    """(9, 9) of the `PARAMETERS`; zero rows and columns for parameters held fixed. With the errors
    that the corners of a view share."""
    covariance_noise_only: Array
    """(9, 9) the same as if each corner's error were independent, as OpenCV reports it."""
    free: tuple[bool, ...]
    """Which of the nine parameters were estimated."""
    residual_sigma_px: float
    """Standard deviation of one corner coordinate, from the residuals, pixels."""
    corner_errors: CornerErrors
    """What of it is independent, and what a view's corners share."""
    rms_px: float
    """Root mean square reprojection distance over all corners, pixels (OpenCV's rms)."""
    views: tuple[View, ...]

    @property
    def sigma(self) -> Array:
        """(9,) standard deviations of the `PARAMETERS`; 0 where a parameter was held fixed."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def sigma_noise_only(self) -> Array:
        """(9,) the same of `covariance_noise_only`: OpenCV's `stdDeviationsIntrinsics`."""
        return np.sqrt(np.diag(self.covariance_noise_only))

    @property
    def uncertainty_px(self) -> float:
        """Projection uncertainty: expected rms error of a projected point over the image. Common
        rotations of the camera are removed. NaN unless all nine parameters were estimated."""
        if not all(self.free):
            return float("nan")
        return projection_uncertainty_px(self.camera, self.covariance)


Model = Literal["full", "startup"]

PARALLEL_DEG = 0.5
"""Views whose normals differ by less count as parallel: they share one vanishing line."""
UNDETERMINED = 0.1
"""A focal length whose sigma exceeds this share of it is undetermined."""
# Lower bound of the corner noise: exact corners must not make a degenerate set look determined.
# Higher for the start-up model, which mistakes distortion for focal length.
_NOMINAL_NOISE_PX: dict[Model, float] = {"full": 0.05, "startup": 0.25}
_UNTIED = (
    "The focal length is not determined by these views: {why}; "
    "tilt the board by 20-45° in different directions."
)
_STARTUP_FLAGS = (
    cv2.CALIB_FIX_PRINCIPAL_POINT
    | cv2.CALIB_FIX_ASPECT_RATIO
    | cv2.CALIB_ZERO_TANGENT_DIST
    | cv2.CALIB_FIX_K1
    | cv2.CALIB_FIX_K2
    | cv2.CALIB_FIX_K3
)
_CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 100, 1e-12)


def calibrate(
    board: Board,
    observations: Sequence[Observation],
    *,
    model: Model = "full",
    start: Camera | None = None,
    numbers: Sequence[int] | None = None,
) -> Calibration:
    """The camera with the least sum of squared reprojection errors.

    Args:
        board: its corners are relative to its centre, so a view's pose is `T_camera_board`.
        observations: views of one image size, each with at least 4 corners of the board.
        model: "full" estimates all nine parameters. "startup" (3.1) estimates one focal length
            (fx = fy, as a board tilted about one axis does not show both) and assumes no distortion
            and the principal point at the image's centre.
        start: initial guess; None: OpenCV's closed form.
        numbers: the views' numbers; 1, 2, ... if not given.

    Raises:
        CalibrationError: no or unusable views, mixed image sizes, views that do not determine the
            focal length (all parallel, all frontal), or an implausible result.
    """
    size = _checked(observations)
    corners = sum(o.count for o in observations)
    free_count = len(PARAMETERS) if model == "full" else 1
    degrees_of_freedom = 2 * corners - free_count - 6 * len(observations)
    if degrees_of_freedom <= 0:
        raise CalibrationError(
            f"{corners} corners in {len(observations)} views are too few for the nine parameters; "
            "take more views, or views that show more of the board."
        )
    points = [board.points_of(o.ids) for o in observations]
    camera, poses = _optimum(points, observations, size, model, start)
    located = list(zip(observations, poses, strict=True))
    residuals = [reprojection_errors(camera, board, o, pose) for o, pose in located]
    squares = [float(np.sum(r * r)) for r in residuals]
    if not np.isfinite(sum(squares)):
        raise CalibrationError(_UNTIED.format(why="the estimate folded up"))
    sigma = float(np.sqrt(sum(squares) / degrees_of_freedom))
    information = np.sum([information_of(camera, board, o, p) for o, p in located], axis=0)
    noise_only = covariance = _covariance(camera, information, sigma, model)
    errors = CornerErrors(sigma)
    if model == "full":
        parts = [
            ViewResidual.of(camera, board, o, pose, r)
            for (o, pose), r in zip(located, residuals, strict=True)
        ]
        found = corner_errors(parts)
        if found.shared_px > 0:
            errors, covariance = found, robust_covariance(parts, found)
    numbered = range(1, len(observations) + 1) if numbers is None else numbers
    views = tuple(
        View(number, o, pose, float(np.sqrt(square / o.count)), r)
        for number, o, pose, square, r in zip(
            numbered, observations, poses, squares, residuals, strict=True
        )
    )
    calibration = Calibration(
        board=board,
        camera=camera,
        covariance=covariance,
        covariance_noise_only=noise_only,
        free=tuple(model == "full" or name in ("fx", "fy") for name in PARAMETERS),
        residual_sigma_px=sigma,
        corner_errors=errors,
        rms_px=float(np.sqrt(sum(squares) / corners)),
        views=views,
    )
    _check_result(calibration)
    return calibration


def largest_angle_deg(calibration: Calibration) -> float:
    """The largest angle between the normals of any two views, degrees; 0 for a single view."""
    normals = np.array([view.pose.R[:, 2] for view in calibration.views])
    return float(np.degrees(np.arccos(np.clip(np.min(normals @ normals.T), -1.0, 1.0))))


def determines_homography(corners: Array) -> bool:
    """Whether corners (N, 2) fix a homography: at least four, not all collinear."""
    if corners.shape[0] < 4:
        return False
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    return bool(spread[1] > 0.02 * spread[0])


def _checked(observations: Sequence[Observation]) -> tuple[int, int]:
    """The common image size (width, height); raises unless the observations can be calibrated."""
    if not observations:
        raise CalibrationError(
            "There is no view to calibrate from: the board was found in no image; check its size "
            "(columns and rows swapped?), its dictionary and that the picture is sharp."
        )
    sizes = sorted({o.image_size for o in observations})
    if len(sizes) > 1:
        named = " and ".join(f"{w} x {h}" for w, h in sizes)
        raise CalibrationError(
            f"The images differ in size ({named} px); calibrate each size by itself."
        )
    for index, o in enumerate(observations, start=1):
        if not determines_homography(o.corners):
            raise CalibrationError(
                f"View {o.name or index} shows fewer than four corners that are not on one line; "
                "leave it out."
            )
    return sizes[0]


def _optimum(
    points: list[Array],
    observations: Sequence[Observation],
    size: tuple[int, int],
    model: Model,
    start: Camera | None,
) -> tuple[Camera, list[Pose]]:
    # OpenCV takes single precision here: 6e-5 px at 1000 px, far below the corner noise.
    objects: list[Any] = [p.astype(np.float32).reshape(-1, 1, 3) for p in points]
    images: list[Any] = [o.corners.astype(np.float32).reshape(-1, 1, 2) for o in observations]
    flags = _STARTUP_FLAGS if model == "startup" else 0
    try:
        K, distortion = _start(objects, images, size, model, start)
        if start is not None or model == "startup":
            flags |= cv2.CALIB_USE_INTRINSIC_GUESS
        _, K, distortion, rvecs, tvecs = cv2.calibrateCamera(
            objects, images, size, K, distortion, flags=flags, criteria=_CRITERIA
        )
        camera = Camera.from_opencv(K, distortion, size)
    except (cv2.error, CalibrationError) as error:
        # OpenCV's message ("focal length must be positive") does not help a user.
        raise CalibrationError(_UNTIED.format(why="they may all be frontal or parallel")) from error
    return camera, [Pose.from_rvec_tvec(r, t) for r, t in zip(rvecs, tvecs, strict=True)]


def _start(
    objects: list[Any],
    images: list[Any],
    size: tuple[int, int],
    model: Model,
    start: Camera | None,
) -> tuple[Any, Any]:
    if model == "full":
        camera = start or Camera.guess(size)
        return camera.K, camera.distortion.copy()
    if start is None:
        K = np.asarray(cv2.initCameraMatrix2D(objects, images, size, 1.0), dtype=np.float64)
        f = float(K[0, 0])
        if not np.isfinite(f) or not 0.1 < f / size[0] < 50:
            f = Camera.guess(size).fx
    else:
        f = start.fx
    K = np.array([[f, 0, (size[0] - 1) / 2], [0, f, (size[1] - 1) / 2], [0, 0, 1]])
    return K, np.zeros(5)


def _covariance(camera: Camera, total: Array, sigma: float, model: Model) -> Array:
    """(9, 9) covariance of the parameters for corner noise `sigma` and the views' information."""
    try:
        if model == "full":
            covariance = covariance_of(total, 1.0)
        else:
            # One parameter moves fx and fy together: df = (1, 1, 0 ...).
            covariance = np.zeros((9, 9))
            with np.errstate(divide="ignore"):  # an exactly frontal view: caught below
                covariance[:2, :2] = 1.0 / total[:2, :2].sum()
    except np.linalg.LinAlgError as error:
        raise CalibrationError(_UNTIED.format(why="they may all be parallel")) from error
    variance = np.diag(covariance)
    f = np.array([camera.fx, camera.fy])
    nominal = max(sigma, _NOMINAL_NOISE_PX[model]) * np.sqrt(np.maximum(variance[:2], 0)) / f
    if not np.isfinite(covariance).all() or (variance < 0).any() or nominal.max() > UNDETERMINED:
        raise CalibrationError(_UNTIED.format(why="they are nearly frontal or nearly parallel"))
    return sigma**2 * covariance


def _check_result(calibration: Calibration) -> None:
    camera = calibration.camera
    if all(calibration.free) and largest_angle_deg(calibration) < PARALLEL_DEG:
        raise CalibrationError(_UNTIED.format(why="all of them are parallel"))
    if not (0 <= camera.cx < camera.width and 0 <= camera.cy < camera.height):
        raise CalibrationError(
            f"The result makes no sense (principal point at {camera.cx:.0f}, {camera.cy:.0f} px, "
            "outside the image); check the board's sizes and add views tilted by 20-45°."
        )

"""Calibration: from observations to the camera, its covariance and the board as it is.

`bundle` finds the optimum (eq. (9) of the paper), `robust_fit` leaves out what does not fit,
`board_shape` adds a bow and a stretch of the board where the residuals ask for them, and
`shared_errors` gives the covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_shape import uncertainty_of, with_shape
from venus3d.engine.calibration.bundle import Corners, Problem, adjust
from venus3d.engine.calibration.calibration import Calibration, LeftOut, largest_angle_deg
from venus3d.engine.calibration.information import covariance_of
from venus3d.engine.calibration.initial_values import located_by
from venus3d.engine.calibration.observation import (
    Observation,
    View,
    determines_homography,
    reprojection_errors,
    rms_distance,
    with_centres,
)
from venus3d.engine.calibration.other_cameras import SUSPICIOUS_PX, cropped
from venus3d.engine.calibration.repeats import repeated
from venus3d.engine.calibration.robust_fit import (
    RobustFit,
    from_several_starts,
    readable,
    without_outliers,
)
from venus3d.engine.calibration.shared_errors import CornerErrors
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.image_circle import common_circle
from venus3d.engine.geometry.lenses import BROWN5, LensModel
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.sentences import Sentence, listed, said_by

Model = Literal["full", "startup"]

PARALLEL_DEG = 0.5
"""Views whose normals differ by less count as parallel: they share one vanishing line."""
UNDETERMINED = 0.1
"""A focal length whose sigma exceeds this share of it is undetermined."""
OUTSIDE = 3.0
"""Standard deviations by which a principal point outside the picture is surely there."""
# Lower bound of the corner noise: exact corners must not make a degenerate set look determined.
# Higher for the start-up model, which mistakes distortion for focal length.
_NOMINAL_NOISE_PX: dict[Model, float] = {"full": 0.05, "startup": 0.25}
_CENTRING_ROUNDS = 2
"""A third moves no centre by more than 0.00002 px for a webcam, 0.003 px in a fisheye."""
_UNTIED = Sentence(
    "The focal length is not determined by these views: {why}; "
    "tilt the board by 20-45° in different directions."
)


_FRONTAL_OR_PARALLEL = Sentence("they may all be frontal or parallel")
_MAYBE_PARALLEL = Sentence("they may all be parallel")
_FOLDED = Sentence("the estimate folded up")
_NEARLY = Sentence("they are nearly frontal or nearly parallel")
_PARALLEL = Sentence("all of them are parallel")
_CAUSE_AND_CURE = Sentence("{cause} {cure}")
_WITH_THE_REST = Sentence("{error} {left_out}")
_NOT_USED = Sentence(
    "Not used: {names}, which show fewer than four corners, corners on one line, or no image of "
    "this board."
)
_VIEW = Sentence("view {number}")
_NO_VIEW = Sentence(
    "There is no view to calibrate from: the board was found in no image; check its size (columns "
    "and rows swapped?), its dictionary and that the picture is sharp."
)
_SIZES = Sentence("The images differ in size ({sizes} px); calibrate each size by itself.")
_TOO_FEW_A_VIEW = Sentence(
    "No view shows enough of the board: each has fewer than four corners, or only corners on one "
    "line; bring the board nearer, or more of it into the picture."
)
_TOO_FEW = Sentence(
    "{count} corners in {views} views are too few for the {parameters} parameters; take more "
    "views, or views that show more of the board."
)
_OUTSIDE = Sentence(
    "The result makes no sense (principal point at {x}, {y} px, outside the image); check the "
    "board's sizes and add views tilted by 20-45°."
)


class CroppedError(CalibrationError):
    """The principal point is surely outside the picture, and the camera explains the views."""

    def __init__(self, camera: Camera, rms_px: float) -> None:
        """The camera, and the rms reprojection error that it leaves."""
        self.diagnosis, self.rms_px = cropped(camera, rms_px), rms_px
        said = _CAUSE_AND_CURE.format(cause=self.diagnosis.cause, cure=self.diagnosis.cure)
        super().__init__(said)


def calibrate(
    board: Board,
    observations: Sequence[Observation],
    *,
    model: Model = "full",
    lens: LensModel | None = None,
    square_pixels: bool = False,
    start: Camera | None = None,
    numbers: Sequence[int] | None = None,
) -> Calibration:
    """The camera with the least sum of squared reprojection errors.

    Corners and views that do not fit are left out and named (`robust_fit`); a bow of the board and
    a stretch of its print are estimated where the residuals ask for them (`board_shape`). Where
    neither is the case, the optimum is that of `cv2.calibrateCamera`.

    Args:
        board: its corners are relative to its centre, so a view's pose is `T_camera_board`.
        observations: views of one image size; one that determines no pose is left out.
        model: "full" estimates all parameters. "startup" (3.1) estimates one focal length (fx = fy,
            as a board tilted about one axis does not show both) and assumes no distortion and the
            principal point at the image's centre.
        lens: None: that of `start`, or brown5.
        square_pixels: one focal length, fx = fy, also for the full model.
        start: initial guess; None: several starts, the best is kept.
        numbers: the views' numbers; 1, 2, ... if not given.

    Raises:
        CalibrationError: no or unusable views, mixed image sizes, views that do not determine the
            focal length (all parallel, all frontal), or an implausible result.
    """
    counted = range(1, len(observations) + 1) if numbers is None else numbers
    views = list(zip(counted, observations, strict=True))
    found = _calibrated(board, views, model, lens, square_pixels, start)
    if model == "startup" or not any(seen.centroids is not None for seen in observations):
        return found
    for _ in range(_CENTRING_ROUNDS):
        views = _centred(views, found)
        found = _calibrated(board, views, model, lens, square_pixels, found.camera)
    return found


def _centred(
    views: Sequence[tuple[int, Observation]], found: Calibration
) -> list[tuple[int, Observation]]:
    """The views with the centres of the board's discs as this calibration has them."""
    poses = {view.number: view.pose for view in found.views}
    return [
        (number, with_centres(found.camera, found.board, seen, poses[number]))
        if number in poses
        else (number, seen)
        for number, seen in views
    ]


def _calibrated(
    board: Board,
    every: Sequence[tuple[int, Observation]],
    model: Model,
    lens: LensModel | None,
    square_pixels: bool,
    start: Camera | None,
) -> Calibration:
    size = _common_size([seen for _, seen in every])
    if lens is None:
        lens = BROWN5 if start is None else start.lens
    usable, corners, left_out = _usable(board, every, size, lens)
    basis = _basis(lens, model, square_pixels)
    try:
        fit = _fitted(board, _checked_count(corners, basis), size, lens, model, basis, start)
        calibration = _calibration(board, [usable[i] for i in fit.kept], fit, model)
        _check_result(calibration)
    except np.linalg.LinAlgError as error:
        # Far along a direction that they leave open, which only their uncertainty tells.
        raise CalibrationError("The views do not determine the camera.") from error
    except CalibrationError as error:
        unread = [one for one in left_out if one.reason != "repeat"]
        if not unread or isinstance(error, CroppedError):
            raise
        said = _WITH_THE_REST.format(error=said_by(error), left_out=_named(unread))
        raise CalibrationError(said) from error
    left_out += [
        LeftOut(number, seen, "misfit")
        for index, (number, seen) in enumerate(usable)
        if index not in fit.kept
    ]
    return replace(
        calibration,
        camera=_with_circle(calibration.camera, [seen for _, seen in every]),
        left_out=tuple(sorted(left_out, key=lambda one: one.number)),
    )


def _with_circle(camera: Camera, observations: Sequence[Observation]) -> Camera:
    """The camera with the image circle of the views' pictures, unless corners are outside it."""
    circle = common_circle(seen.image_circle for seen in observations)
    if circle is None or not all(circle.contains(seen.corners).all() for seen in observations):
        return camera
    return replace(camera, image_circle=circle)


def _named(left_out: Sequence[LeftOut]) -> str:
    names = [one.observation.name or _VIEW.format(number=one.number) for one in left_out]
    return _NOT_USED.format(names=listed(names))


def _usable(
    board: Board,
    views: Sequence[tuple[int, Observation]],
    size: tuple[int, int],
    lens: LensModel,
) -> tuple[list[tuple[int, Observation]], Corners | None, list[LeftOut]]:
    """The views that can show the board and fix its pose, their corners, and the other views."""
    left_out: list[LeftOut] = []
    fixed: list[tuple[int, Observation]] = []
    for view in views:
        if determines_homography(board.points_of(view[1].ids)):
            fixed.append(view)
        else:
            left_out.append(LeftOut(*view, "undetermined"))
    again = repeated([seen for _, seen in fixed])
    left_out += [LeftOut(*fixed[index], "repeat") for index in again]
    fixed = [view for index, view in enumerate(fixed) if index not in again]
    if not fixed:
        return [], None, left_out
    points = [board.points_of(seen.ids) for _, seen in fixed]
    corners = Corners.of(points, [seen.corners for _, seen in fixed])
    weights = readable(corners, size, lens)
    good = weights.sum(axis=1) > 0
    usable: list[tuple[int, Observation]] = []
    for view, kept in zip(fixed, good, strict=True):
        if kept:
            usable.append(view)
        else:
            left_out.append(LeftOut(*view, "misfit"))
    return usable, Corners(corners.points[good], corners.pixels[good], weights[good]), left_out


def _basis(lens: LensModel, model: Model, square_pixels: bool) -> Array:
    """(p, q) the adjusted parameters' effect on the camera's; see `Problem`."""
    every = np.eye(4 + len(lens.coefficient_names))
    if model == "full" and not square_pixels:
        return every
    # One parameter moves fx and fy together.
    focal = every[:, :1] + every[:, 1:2]
    return focal if model == "startup" else np.concatenate([focal, every[:, 2:]], axis=1)


def _fitted(
    board: Board,
    corners: Corners,
    size: tuple[int, int],
    lens: LensModel,
    model: Model,
    basis: Array,
    start: Camera | None,
) -> RobustFit:
    problem = Problem(corners, basis)
    try:
        if start is None:
            solution = from_several_starts(problem, size, lens)
        else:
            solution = adjust(problem, located_by(corners, start))
        if model == "startup":
            every = tuple(range(len(corners.weights)))
            return RobustFit(problem, solution, corners.weights, every)
        fit = without_outliers(problem, solution)
        return with_shape(board, fit)
    except CalibrationError as error:
        raise CalibrationError(_UNTIED.format(why=_FRONTAL_OR_PARALLEL)) from error


def _calibration(
    board: Board, views: Sequence[tuple[int, Observation]], fit: RobustFit, model: Model
) -> Calibration:
    parameters, sigma = fit.solution.parameters, fit.sigma_px
    errors, covariance, noise_only = _covariances(board, fit, model)
    p = len(parameters.camera.parameters)
    shape, free = parameters.shape, np.flatnonzero(fit.problem.basis[p:].any(axis=1))
    shape_sigma = np.zeros(4)
    shape_sigma[free] = np.sqrt(np.diag(covariance)[p + free])
    if len(shape):
        bow = (board.bow[0] + float(shape[0]), board.bow[1] + float(shape[1]))
        board = replace(board, bow=bow, stretch=board.stretch + float(shape[2]))
    if len(shape) > 3:
        board = replace(board, marker=board.marker + float(shape[3]))
    weights = fit.problem.corners.weights
    found = tuple(
        _view(parameters.camera, board, number, seen, pose, used[: seen.count] > 0)
        for (number, seen), pose, used in zip(views, parameters.poses, weights, strict=True)
    )
    squares = sum(view.observation.count * view.rms_px**2 for view in found)
    return Calibration(
        board=board,
        camera=parameters.camera,
        covariance=covariance[:p, :p],
        covariance_noise_only=noise_only[:p, :p],
        free=tuple(bool(row.any()) for row in fit.problem.basis[:p]),
        residual_sigma_px=sigma,
        corner_errors=errors,
        rms_px=float(np.sqrt(squares / sum(view.observation.count for view in found))),
        views=found,
        shape_sigma=(float(shape_sigma[0]), float(shape_sigma[1]), float(shape_sigma[2])),
        marker_sigma=float(shape_sigma[3]),
    )


def _covariances(board: Board, fit: RobustFit, model: Model) -> tuple[CornerErrors, Array, Array]:
    """The corners' errors and the covariances of the camera's parameters and of those of the
    shape, zero where they were held fixed, with shared errors and without."""
    sigma = fit.sigma_px
    try:
        with np.errstate(divide="ignore", invalid="ignore"):  # an exactly frontal view
            unit = covariance_of(fit.solution.information)
    except np.linalg.LinAlgError as error:
        raise CalibrationError(_UNTIED.format(why=_MAYBE_PARALLEL)) from error
    basis = fit.problem.basis
    unit = basis @ unit @ basis.T
    _check_determined(fit.solution.parameters.camera, unit, sigma, model)
    errors, noise_only = CornerErrors(sigma), sigma**2 * unit
    covariance = noise_only
    if model == "full":
        found = uncertainty_of(board, fit)
        if found.errors.shared_px > 0:
            errors, covariance = found.errors, basis @ found.covariance @ basis.T
        for doubt in fit.doubts:
            wide = np.append(doubt, np.zeros(len(covariance) - len(doubt)))
            covariance = covariance + np.outer(wide, wide)
    return errors, covariance, noise_only


def _view(
    camera: Camera,
    board: Board,
    number: int,
    seen: Observation,
    pose: Pose,
    used: NDArray[np.bool_],
) -> View:
    fitted = seen if used.all() else seen.only(used)
    errors = reprojection_errors(camera, board, fitted, pose)
    if not np.isfinite(errors).all():
        raise CalibrationError(_UNTIED.format(why=_FOLDED))
    left_out = None if used.all() else seen.only(~used)
    return View(number, fitted, pose, rms_distance(errors), errors, left_out)


def _common_size(observations: Sequence[Observation]) -> tuple[int, int]:
    """(width, height) of all observations; raises if there is none or they differ."""
    if not observations:
        raise CalibrationError(_NO_VIEW)
    sizes = sorted({o.image_size for o in observations})
    if len(sizes) > 1:
        named = listed([f"{w} x {h}" for w, h in sizes])
        raise CalibrationError(_SIZES.format(sizes=named))
    return sizes[0]


def _checked_count(corners: Corners | None, basis: Array) -> Corners:
    """The corners; raises if they are too few for the model."""
    if corners is None or not len(corners.weights):
        raise CalibrationError(_TOO_FEW_A_VIEW)
    count, views = int(corners.weights.sum()), len(corners.weights)
    if 2 * count - basis.shape[1] - 6 * views <= 0:
        raise CalibrationError(_TOO_FEW.format(count=count, views=views, parameters=basis.shape[1]))
    return corners


def _check_determined(camera: Camera, unit: Array, sigma: float, model: Model) -> None:
    """Raises if the covariance for a noise of one pixel leaves the focal length open."""
    variance = np.diag(unit)
    f = np.array([camera.fx, camera.fy])
    nominal = max(sigma, _NOMINAL_NOISE_PX[model]) * np.sqrt(np.maximum(variance[:2], 0)) / f
    if not np.isfinite(unit).all() or (variance < 0).any() or nominal.max() > UNDETERMINED:
        raise CalibrationError(_UNTIED.format(why=_NEARLY))


def _check_result(calibration: Calibration) -> None:
    camera = calibration.camera
    if all(calibration.free) and largest_angle_deg(calibration) < PARALLEL_DEG:
        raise CalibrationError(_UNTIED.format(why=_PARALLEL))
    if not (0 <= camera.cx < camera.width and 0 <= camera.cy < camera.height):
        cx, cy = camera.parameters[2:4]
        x, y = OUTSIDE * calibration.sigma[2:4]
        is_sure = not (-x <= cx < camera.width + x and -y <= cy < camera.height + y)
        if is_sure and calibration.rms_px < SUSPICIOUS_PX:
            raise CroppedError(camera, calibration.rms_px)
        raise CalibrationError(_OUTSIDE.format(x=f"{camera.cx:.0f}", y=f"{camera.cy:.0f}"))

"""The least-squares fit of the corners that fit: outlying corners and views are found and left out.

One runaway corner must not move the camera, and Gaussian noise must not be trimmed. So the fit is
plain least squares unless a corner is far out; then the loss of far corners is Huber's (1964), from
which the outlying ones are told, and the rest is fitted by plain least squares again.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.bundle import Corners, Parameters, Problem, Solution, adjust
from venus3d.engine.calibration.initial_values import (
    WIDE_FIELDS_DEG,
    equidistant,
    homographies,
    initial_parameters,
    off_centre_parameters,
    on_planes,
)
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.lenses import BROWN5, LensModel
from venus3d.engine.geometry.pose import Array

Mask = NDArray[np.bool_]

OUTLYING = 8.0
"""A corner is outlying at this many standard deviations, of all corners or of its view's, whichever
is more. Noise of 5 sigma never is; the worst corners of good recordings reach 6."""
LEAST_OUTLYING_PX = 0.3
"""No corner nearer than this to its place is outlying."""
OUTLYING_VIEW = 6.0
"""A view is outlying if its median error is this many times the views' median."""
FEWEST_VIEWS = 4
"""With fewer views, one cannot be told from the others."""
_HUBER = 3.0  # standard deviations at which the robust loss turns linear
_MEDIAN = float(np.sqrt(2 * np.log(2)))  # of a distance in two dimensions, in standard deviations
_ROUNDS = 5
_RACE = 5  # steps from each start before the best goes on
_SUSPICIOUS_VIEW = 3.0  # medians of the views' median error from which the robust loss judges
_BENT = 0.15  # of a view's extent: farther from a plane's image is no lens
_ENOUGH = 0.6  # of a view's corners
_SUSPICIOUS_PX = 0.6  # an rms from which each start is followed to its end: one ended at 0.85


@dataclass(frozen=True, eq=False)
class RobustFit:
    """A fit and the views that it is made from."""

    problem: Problem
    """With weight 0 for corners left out."""
    solution: Solution
    counted: Array
    """(N, M) weights with those corners."""
    kept: tuple[int, ...]
    """Indices of the views fitted, ascending; the others are outlying."""
    doubts: tuple[Array, ...] = ()
    """(p,) changes of the camera's parameters by what is likely and not in the model."""

    @property
    def sigma_px(self) -> float:
        """Standard deviation of one corner coordinate, from the residuals, pixels."""
        corners = self.problem.corners.weights
        freedom = 2 * corners.sum() - 6 * len(corners) - self.problem.basis.shape[1]
        return float(np.sqrt(self.solution.cost / max(freedom, 1.0)))


def readable(corners: Corners, size: tuple[int, int], lens: LensModel | None = None) -> Array:
    """(N, M) weights without the corners that cannot be the board's: what is left of each view is
    the image of a plane, but for a lens, and seen from the front if most views are. All zero for a
    view of which too little is left. For a wide lens as much as is left with any field of view."""
    centre = (np.array(size) - 1) / 2
    image = replace(corners, pixels=(corners.pixels - centre[:, None]) / size[0])
    found = [_readable(image)]
    if lens is not None and lens.wide is not None:
        wide = (equidistant(size, angle) for angle in WIDE_FIELDS_DEG)
        found += [_readable(on_planes(corners, camera)[0]) for camera in wide]
    return max(found, key=lambda weights: float(weights.sum()))


def _readable(corners: Corners) -> Array:
    H = homographies(corners, 1.0, np.zeros(2))
    xy1 = np.concatenate([corners.points[:, :, :2], np.ones_like(corners.points[:, :, :1])], axis=2)
    observed = corners.pixels
    weights = corners.weights.copy()
    share = weights / weights.sum(axis=1, keepdims=True)
    middle = (observed * share[:, None]).sum(axis=2, keepdims=True)
    extent = np.sqrt((((observed - middle) ** 2).sum(axis=1) * share).sum(axis=1))
    errors = _distances(H, xy1, observed)
    bent = np.sqrt((errors**2 * share).sum(axis=1)) > _BENT * extent
    for view in np.flatnonzero(bent):
        # Rare, and worth a slow method: least median of squares bears half of the corners wrong.
        used = weights[view] > 0
        found, _ = cv2.findHomography(
            xy1[view, used, :2], observed[view][:, used].T, method=cv2.LMEDS
        )
        if found is None:
            weights[view] = 0.0
            continue
        H[view] = found
        near = _distances(H[view : view + 1], xy1[view : view + 1], observed[view : view + 1])[0]
        weights[view] *= near < _BENT * float(np.median(extent))
        if weights[view].sum() < _ENOUGH * used.sum():
            weights[view] = 0.0
    front = np.linalg.det(H) * np.sign((H @ xy1.swapaxes(1, 2))[:, 2, 0]) > 0
    if front.mean() < 0.5:
        front = ~front
    return weights * front[:, None]


def _distances(H: Array, xy1: Array, observed: Array) -> Array:
    """(N, M) between points (N, M, 3) by homographies (N, 3, 3) and where they were seen (N, 2, M);
    infinite where a point has no image."""
    mapped = H @ xy1.swapaxes(1, 2)
    with np.errstate(all="ignore"):
        found = np.linalg.norm(mapped[:, :2] / mapped[:, 2:] - observed, axis=1)
    return np.where(np.isfinite(found), found, np.inf)


def from_several_starts(
    problem: Problem, size: tuple[int, int], lens: LensModel = BROWN5
) -> Solution:
    """The best of the optima near `initial_parameters`: all start, the best is finished. With a
    suspicious rms, principal points near the picture's edge are tried as well, unless it is held
    fixed."""
    found = best_of_starts(problem, initial_parameters(problem.corners, size, lens))
    suspicious = found.cost > problem.corners.weights.sum() * _SUSPICIOUS_PX**2
    if suspicious and problem.basis[2:4].any():
        starts = off_centre_parameters(problem.corners, size, lens)
        with suppress(CalibrationError):
            found = min(found, best_of_starts(problem, starts, float("inf")), key=_cost)
    return found


def best_of_starts(
    problem: Problem, starts: Iterable[Parameters], suspicious_px: float = _SUSPICIOUS_PX
) -> Solution:
    """The optimum near the start that gets farthest in a few steps; with an rms from
    `suspicious_px` the best of the optima near all of them. Raises `CalibrationError` without any.
    """
    # No solution of a race is the optimum yet, so a step's share of the cost cannot be judged.
    raced = [found for start in starts if (found := _tried(problem, start, _RACE)) is not None]
    if not raced:
        raise CalibrationError("No focal length fits these views.")
    raced.sort(key=_cost)
    best = adjust(problem, raced[0].parameters)
    corners = problem.corners.weights.sum()
    if best.cost > corners * suspicious_px**2:
        others = [_tried(problem, other.parameters, None) for other in raced[1:]]
        best = min([best, *(o for o in others if o is not None)], key=_cost)
    return best


def _cost(solution: Solution) -> float:
    return solution.cost


def _tried(problem: Problem, start: Parameters, steps: int | None) -> Solution | None:
    try:
        return adjust(problem, start) if steps is None else adjust(problem, start, steps)
    except CalibrationError:
        return None


def without_outliers(problem: Problem, solution: Solution) -> RobustFit:
    """The fit of a problem, of which `solution` is the optimum, without its outliers."""
    kept = np.arange(len(problem.corners.weights))
    counted = problem.corners.weights.copy()
    for _ in range(_ROUNDS):
        fitting = _fitting(solution, counted)
        if (fitting == problem.corners.weights).all() and _alike(solution, counted):
            break
        sigma = _spread(solution, counted)[0]
        robust = replace(_weighted(problem, counted), outlier_px=_HUBER * sigma)
        solution = adjust(robust, solution.parameters)
        fitting = _fitting(solution, counted)
        good = _good_views(solution, counted, fitting)
        if not good.all():
            kept, counted, fitting = kept[good], counted[good], fitting[good]
            problem, solution = _of_views(problem, solution, good)
        problem = _weighted(problem, fitting)
        solution = adjust(problem, solution.parameters)
    return RobustFit(problem, solution, counted, tuple(int(i) for i in kept))


def _spread(solution: Solution, counted: Array) -> tuple[float, Array]:
    """Standard deviation of a coordinate, of all corners and (N,) of each view's: by medians."""
    distance = np.where(counted > 0, np.sqrt((solution.errors**2).sum(axis=1)), np.nan)
    return (
        float(np.nanmedian(distance)) / _MEDIAN,
        np.asarray(np.nanmedian(distance, axis=1) / _MEDIAN, dtype=np.float64),
    )


def _fitting(solution: Solution, counted: Array) -> Array:
    """(N, M) 1 for corners that are not outlying, as weights."""
    everywhere, by_view = _spread(solution, counted)
    limit = np.maximum(OUTLYING * np.maximum(everywhere, by_view), LEAST_OUTLYING_PX)
    near = (solution.errors**2).sum(axis=1) <= (limit**2)[:, None]
    return counted * near


def _alike(solution: Solution, counted: Array) -> bool:
    """Whether no view is suspicious: least squares spread a bad view's errors over all."""
    by_view = _spread(solution, counted)[1]
    limit = max(_SUSPICIOUS_VIEW * float(np.median(by_view)), LEAST_OUTLYING_PX)
    return bool((by_view <= limit).all())


def _good_views(solution: Solution, counted: Array, fitting: Array) -> Mask:
    """(N,) whether a view fits as the others do, by enough of its corners."""
    by_view = _spread(solution, counted)[1]
    if len(by_view) < FEWEST_VIEWS:
        return np.ones(len(by_view), dtype=bool)
    good = by_view <= max(OUTLYING_VIEW * float(np.median(by_view)), LEAST_OUTLYING_PX)
    return good & (2 * fitting.sum(axis=1) >= counted.sum(axis=1))


def _weighted(problem: Problem, weights: Array) -> Problem:
    return replace(problem, corners=replace(problem.corners, weights=weights))


def _of_views(problem: Problem, solution: Solution, good: Mask) -> tuple[Problem, Solution]:
    c, p = problem.corners, solution.parameters
    corners = Corners(c.points[good], c.pixels[good], c.weights[good])
    problem = replace(problem, corners=corners)
    if len(problem.deformations):
        problem = replace(problem, deformations=problem.deformations[:, good])
    parameters = replace(p, R=p.R[good], t=p.t[good])
    return problem, replace(solution, parameters=parameters, errors=solution.errors[good])

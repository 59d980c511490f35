"""Finds pictures of another focal length among the others: an autofocus or a zoom that moved, or a
second camera.

Fitted together they give a focal length in between, with a small sigma, and residuals that look
like a moving board's. Each view gets a factor of its own on the focal length, near the fit; sorted
by them, the views are split in two where one factor for the second part explains most. Other errors
gain by such factors too, so a change is looked into only if

- the factor is `SURE` standard deviations off 1, by the errors that a view's corners share
  (`shared_errors`), what all views' own factors leave counting as noise;
- it explains `MOST` of what all views' own factors explain together;
- with the pictures of the second part resized, the errors that a view's corners share are gone:
  less than `LEFT` of them, by their ratio to the independent ones, is left. A rolling shutter in
  all views leaves more than half.

**One picture in motion** passes all of that on a board of few corners: the image of a plane has two
more numbers than a pose, motion while rows are read changes both, and a factor on the focal length
explains the direction that it has. So the change is sure only if three pictures show it by `AGREED`
variances of the noise, since chance gives not three motions one direction, or if

- in no resized picture an even motion explains more than noise, which is what tells the direction;
- others beside the picture that shows it most show it by `AGREED` variances of the noise, or that
  one by `ALONE`: the more it is, the less can chance have given it this direction.

Otherwise the pictures are named as not fitting, which they do either way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import f as f_distribution

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation, whole
from venus3d.engine.calibration.residual_patterns import (
    least_squares_of,
    motion_gains,
    view_residual,
)
from venus3d.engine.calibration.shared_errors import corner_errors
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.pose import Array

Mask = NDArray[np.bool_]
FEWEST_VIEWS = 6
"""With fewer views, two kinds can't be told from errors that each view has."""
SURE, MOST, LEFT = 6.0, 0.8, 0.4
CLEAR = 4.0
"""Variances of the noise that the factor must explain in a view by itself for it to be named."""
AGREED, ALONE = 9.0, 200.0
"""The same for the views beside the one that shows most, and for one view if no other says so."""
BY_CHANCE = 0.001
"""Probability that noise in the resized pictures looks like a motion, up to which it is one."""
_ROUNDS = 3
_SAME = 1e-4  # a factor that is off by less than this


@dataclass(frozen=True)
class FocalChange:
    """Views of another focal length than the others."""

    numbers: tuple[int, ...]
    """Of the smaller part of the views (of equally many that of the longer focal length) those
    that show it."""
    factor: float
    """Their focal length over the others'."""
    is_sure: bool
    """Whether it can't be a motion of these views as well."""


def focal_change(calibration: Calibration) -> FocalChange | None:
    """Views of another focal length than the others; None in nearly all cases."""
    if len(calibration.views) < FEWEST_VIEWS or not all(calibration.free):
        return None
    longer, log_factor = _split(calibration)
    if longer is None:
        return None
    again, log_factor = _equalised(calibration, longer, log_factor)
    if again is None or shared_ratio(again) > LEFT * shared_ratio(calibration):
        return None
    few = longer if 2 * longer.sum() <= len(longer) else ~longer
    factor = float(np.exp(log_factor if few is longer else -log_factor))
    numbers = np.array([view.number for view in calibration.views])
    fits = np.isin(numbers, [view.number for view in again.views])
    if not fits.all():
        unfit = tuple(int(n) for n in numbers[few & ~fits])
        return FocalChange(unfit, factor, is_sure=False) if unfit else None
    noise, freedom = _noise(again, ~few)
    own = _own_evidence(again, np.where(longer, log_factor, -log_factor)) / noise
    named = few & (own > CLEAR)
    if not named.any():
        return None
    by_motion = motion_gains(again)[named] / noise / 6
    most = own[named].max()
    is_sure = (own[named] > AGREED).sum() >= 3 or (
        by_motion.max() < f_distribution.isf(BY_CHANCE / named.sum(), 6, freedom)
        and (own[named].sum() - most > AGREED or most > ALONE)
    )
    return FocalChange(tuple(int(n) for n in numbers[named]), factor, bool(is_sure))


def _equalised(
    calibration: Calibration, longer: Mask, log_factor: float
) -> tuple[Calibration | None, float]:
    """The calibration with the pictures of the longer focal length resized to that of the others,
    and the logarithm of the factor, which gets better from one to the next."""
    again = calibration
    for _ in range(_ROUNDS):
        middle = np.array([again.camera.cx, again.camera.cy])
        scaled = [
            _resized(whole(view), middle, np.exp(-log_factor)) if is_longer else whole(view)
            for view, is_longer in zip(calibration.views, longer, strict=True)
        ]
        numbers = [view.number for view in calibration.views]
        try:
            again = calibrate(
                calibration.board, scaled, lens=calibration.camera.lens, numbers=numbers
            )
        except CalibrationError:
            return None, log_factor
        if len(again.views) < len(numbers):
            break
        step = float(_solved(_weighed(_grams(again, 0.0), longer))[-1])
        if abs(step) < _SAME:
            break
        log_factor += step
    return again, log_factor


def _noise(calibration: Calibration, which: Mask) -> tuple[float, int]:
    """Variance of the corners' coordinates in these views (N,), and their freedom."""
    views = [view for view, is_it in zip(calibration.views, which, strict=True) if is_it]
    fitted = 6 * len(views) + len(calibration.free)
    freedom = max(sum(view.errors.size for view in views) - fitted, 1)
    return sum(float((view.errors**2).sum()) for view in views) / freedom, freedom


def _own_evidence(calibration: Calibration, log_factors: Array) -> Array:
    """(N,) by how much the sum of squares grows if one view alone is resized by the exponentials
    of these (N,)."""
    grams = _grams(calibration, 0.0)
    still = np.delete(np.arange(grams.shape[1]), -2)
    each = []
    for gram, log_factor in zip(grams, log_factors, strict=True):
        resized = np.eye(len(gram))
        resized[-2, -1] = log_factor
        each.append(resized.T @ gram @ resized - gram)
    total = grams.sum(axis=0)
    sums = np.array([total, *(total + change for change in each)])[:, still][:, :, still]
    least = least_squares_of(sums)
    return np.asarray(least[1:] - least[0], dtype=np.float64)


def shared_ratio(calibration: Calibration) -> float:
    """Shared to independent errors of the corners."""
    return corner_errors([view_residual(calibration, view) for view in calibration.views]).ratio


def _split(calibration: Calibration) -> tuple[Mask | None, float]:
    """(N,) the views of the longer focal length, if they are surely others, and the logarithm of
    the factor between the two."""
    parts = [view_residual(calibration, view) for view in calibration.views]
    grams = _grams(calibration, corner_errors(parts).ratio)
    n, p = len(grams), grams.shape[1] - 2
    others = np.delete(np.arange(p + 2), p)
    plain = grams[:, others][:, :, others]
    own, cross = grams[:, p, p], grams[:, p, others]
    each = (plain - cross[:, :, None] * cross[:, None] / own[:, None, None]).sum(axis=0)
    together, apart = least_squares_of(np.array([plain.sum(axis=0), each]))
    freedom = sum(part.freedom for part in parts) - p - n + 1
    noise = apart / max(freedom, 1)
    # All factors alike are a focal length: fx stays, and the factors count from it.
    values = np.append(0.0, _solved(each[1:, 1:]))
    order = np.argsort((cross[:, -1] - cross[:, :-1] @ values) / own)
    second = np.array([np.isin(np.arange(n), order[k:]) for k in range(1, n)])
    splits = np.array([_weighed(grams, which) for which in second])
    best = int(np.argmin(least_squares_of(splits)))
    gained = together - float(least_squares_of(splits[best][None])[0])
    if gained < SURE**2 * noise or gained < MOST * (together - apart):
        return None, 0.0
    return second[best], float(_solved(splits[best])[-1])


def _grams(calibration: Calibration, ratio: float) -> Array:
    """(N, q + 2, q + 2) normal matrices of the views' derivatives by the camera and the board's
    shape, by a factor on the focal length and, last, of their residuals."""
    focal = [calibration.camera.fx, calibration.camera.fy]
    parts = [view_residual(calibration, view) for view in calibration.views]
    return np.array(
        [
            part.gram(
                np.column_stack([part.intrinsics, part.intrinsics[:, :2] @ focal, part.errors]),
                ratio,
            )
            for part in parts
        ]
    )


def _weighed(grams: Array, which: Mask) -> Array:
    """The sum of normal matrices with one factor for these views (N,), and none for the others."""
    weights = np.ones(grams.shape[:2])
    weights[:, -2] = which
    return np.asarray(np.einsum("ni,nij,nj->ij", weights, grams, weights), dtype=np.float64)


def _solved(gram: Array) -> Array:
    """(q,) the least-squares solution of a normal matrix (q + 1, q + 1), residuals last."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(gram)[:-1], 1e-300))
    H = gram[:-1, :-1] * np.outer(scale, scale) + 1e-13 * np.eye(len(scale))
    return np.asarray(scale * np.linalg.solve(H, scale * gram[:-1, -1]), dtype=np.float64)


def _resized(seen: Observation, middle: Array, factor: float) -> Observation:
    """As in a picture that is resized about a point (2,), pixels."""
    return replace(seen, corners=middle + factor * (seen.corners - middle))

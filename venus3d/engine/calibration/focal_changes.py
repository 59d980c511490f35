"""Finds pictures of another focal length among the others: an autofocus or a zoom that moved, or a
second camera.

Fitted together they give a focal length in between, with a small sigma, and residuals that look
like a moving board's. Each view gets a factor of its own on the focal length, near the fit; sorted
by them, the views are split in two where one factor for the second part explains most. Other errors
gain by such factors too, so a change is named only if

- the factor is `SURE` standard deviations off 1, by the errors that a view's corners share
  (`shared_errors`), what all views' own factors leave counting as noise;
- it explains `MOST` of what all views' own factors explain together;
- with the pictures of the second part resized, the errors that a view's corners share are gone:
  less than `LEFT` of them, by their ratio to the independent ones, is left. A rolling shutter
  leaves more than half.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.observation import Observation, whole
from venus3d.engine.calibration.residual_patterns import (
    least_squares_of,
    view_residual,
)
from venus3d.engine.calibration.shared_errors import corner_errors
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.pose import Array

Mask = NDArray[np.bool_]
FEWEST_VIEWS = 6
"""With fewer views, two kinds can't be told from errors that each view has."""
SURE, MOST, LEFT = 6.0, 0.8, 0.4


@dataclass(frozen=True)
class FocalChange:
    """Views of another focal length than the others."""

    numbers: tuple[int, ...]
    """The smaller part of the views; of equally many those of the longer focal length."""
    factor: float
    """Their focal length over the others'."""


def focal_change(calibration: Calibration) -> FocalChange | None:
    """Views of another focal length than the others; None in nearly all cases."""
    if len(calibration.views) < FEWEST_VIEWS or not all(calibration.free):
        return None
    longer, log_factor = _split(calibration)
    if longer is None:
        return None
    seen = [whole(view) for view in calibration.views]
    middle = np.array([calibration.camera.cx, calibration.camera.cy])
    scaled = [
        _resized(one, middle, np.exp(-log_factor)) if is_longer else one
        for one, is_longer in zip(seen, longer, strict=True)
    ]
    try:
        again = calibrate(calibration.board, scaled, lens=calibration.camera.lens)
    except CalibrationError:
        return None
    if shared_ratio(again) > LEFT * shared_ratio(calibration):
        return None
    few = longer if 2 * longer.sum() <= len(longer) else ~longer
    numbers = tuple(v.number for v, one in zip(calibration.views, few, strict=True) if one)
    factor = np.exp(log_factor if few is longer else -log_factor)
    return FocalChange(numbers, float(factor))


def shared_ratio(calibration: Calibration) -> float:
    """Shared to independent errors of the corners."""
    return corner_errors([view_residual(calibration, view) for view in calibration.views]).ratio


def _split(calibration: Calibration) -> tuple[Mask | None, float]:
    """(N,) the views of the longer focal length, if they are surely others, and the logarithm of
    the factor between the two."""
    parts = [view_residual(calibration, view) for view in calibration.views]
    ratio = corner_errors(parts).ratio
    camera = calibration.camera
    focal = [camera.fx, camera.fy]
    grams = np.array(
        [
            # Last but one the derivatives by the factor.
            part.gram(
                np.column_stack([part.intrinsics, part.intrinsics[:, :2] @ focal, part.errors]),
                ratio,
            )
            for part in parts
        ]
    )
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
    weights = np.ones((n - 1, n, p + 2))
    weights[:, :, p] = second
    splits = np.einsum("kni,nij,knj->kij", weights, grams, weights)
    best = int(np.argmin(least_squares_of(splits)))
    gained = together - float(least_squares_of(splits[best][None])[0])
    if gained < SURE**2 * noise or gained < MOST * (together - apart):
        return None, 0.0
    return second[best], float(_solved(splits[best])[p])


def _solved(gram: Array) -> Array:
    """(q,) the least-squares solution of a normal matrix (q + 1, q + 1), residuals last."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(gram)[:-1], 1e-300))
    H = gram[:-1, :-1] * np.outer(scale, scale) + 1e-13 * np.eye(len(scale))
    return np.asarray(scale * np.linalg.solve(H, scale * gram[:-1, -1]), dtype=np.float64)


def _resized(seen: Observation, middle: Array, factor: float) -> Observation:
    """As in a picture that is resized about a point (2,), pixels."""
    return replace(seen, corners=middle + factor * (seen.corners - middle))

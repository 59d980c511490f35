"""Views that repeat another one: the board and the camera have hardly moved between them.

Repeating a view averages its noise, but not what is the same in both: a board not quite flat, a
refinement drawn to one side, a lens that the model does not fit. Three rendered poses, each ten
times with fresh noise: as thirty independent views they give cy to 0.19 px, and are off by 0.79 px.
With the mean corners of each pose it is the same 0.79 px with the same residuals (0.054 of
0.058 px), so there is nothing to average: one view of each pose counts, the sharpest. Those three
are off by 0.58 px and promise 0.62 px.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.pose import Array

SAME = 0.0025
"""Corners that are on average nearer than this share of the image's width make a repeat."""


def repeated(observations: Sequence[Observation]) -> dict[int, int]:
    """For each observation that repeats a sharper one, by index: that one's index. Those without a
    board repeat nothing."""
    kept: list[int] = []
    found: dict[int, int] = {}
    places = _places(observations)
    # Of equally sharp ones the first is kept.
    for index in np.argsort([-o.sharpness for o in observations], kind="stable"):
        one = observations[index]
        if not one.count:
            continue
        near = _nearest(places, kept, int(index), SAME * one.image_size[0])
        if near is None:
            kept.append(int(index))
        else:
            found[int(index)] = near
    return found


def repeats(one: Observation, other: Observation) -> bool:
    """Whether an observation and another one are the same view."""
    return shift_px(one, other) < SAME * one.image_size[0]


def shift_px(one: Observation, other: Observation) -> float:
    """Mean distance of the corners common to both, pixels; inf if they share fewer than half."""
    return float(_shifts(_places([one, other]), [1], 0)[0])


def _nearest(places: Array, kept: list[int], index: int, limit_px: float) -> int | None:
    if not kept:
        return None
    shifts = _shifts(places, kept, index)
    nearest = int(np.argmin(shifts))
    return kept[nearest] if shifts[nearest] < limit_px else None


def _shifts(places: Array, others: list[int], index: int) -> Array:
    """(N,) see `shift_px`, from one observation to others."""
    apart = np.linalg.norm(places[others] - places[index], axis=2)
    common = np.isfinite(apart)
    seen = np.isfinite(places[:, :, 0]).sum(axis=1)
    enough = 2 * common.sum(axis=1) >= np.maximum(seen[others], seen[index])
    mean = np.where(common, apart, 0.0).sum(axis=1) / np.maximum(common.sum(axis=1), 1)
    return np.where(enough & common.any(axis=1), mean, np.inf)


def _places(observations: Sequence[Observation]) -> Array:
    """(N, M, 2) each corner's place by its id, NaN where it is not seen."""
    count = 1 + max((int(o.ids.max()) for o in observations if o.count), default=0)
    places = np.full((len(observations), count, 2), np.nan)
    for index, observation in enumerate(observations):
        places[index, observation.ids] = observation.corners
    return places

"""Corners of square tags as the meeting points of their edges.

Where a black corner stands alone on white, blur rounds it off and cornerSubPix finds it a quarter
of a pixel too far inside. Edges stay where they are. A wide lens bends them, so that a straight
line through their middles meets the next one 0.3 px too far outside; how much, the other tags say.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.board_reader import Grey
from venus3d.engine.geometry.pose import Array

Bends = Callable[[Array, Array], Array]
"""Of outlines (N, 4, 2) and places (S,) along their edges, from 0 to 1: by how much each edge is
bent off the straight line, (N, 4, S, 2) pixels."""

_ALONG: Array = np.asarray(np.linspace(0.2, 0.8, 8), dtype=np.float64)
"""Places along an edge at which it is looked for, away from the rounded corners."""
_OF_REACH = 0.7
_STEPS = 21
_LEVEL, _LEVEL_AT_PX = 0.4, 2.0
"""Share of the half difference of the greys within which an edge is measured, where no more than so
many pixels beside it are its own; more with their square. On a grid of 28 px a tag, through a blur
of 0.8 px, the corners were 0.11 px too far outside without it, 0.03 px with it."""
_FARTHEST_PX = 6.0
_DEGREES, _SUITS = (3, 5), 0.5
"""Of the polynomials that may bend the edges, and the share of the variance that one must leave."""


def corners_by_edges(grey: Grey, quads: Array, reach: float, bends: Bends | None = None) -> Array:
    """(N, 4, 2) corners of tags that are about at `quads`, pixels.

    Args:
        grey: (H, W).
        reach: how far from an edge there is no other one, as a share of the tag's side.
        bends: None: the edges are straight.
    """
    quads = _once(grey, quads, reach, None)
    # Outlines are pixels off here and there, and would bend the edges by as much. The second time
    # the window is centred on the edge, too.
    return _once(grey, quads, reach, None if bends is None else bends(quads, _ALONG))


def bends_of(points: Array, quads: Array, along: Array) -> Array:
    """(N, 4, S, 2) by how much the edges of tags (N, 4, 2), on the board at `points` (N, 4, 2), are
    bent off the straight line at the places `along` (S,) them, pixels.

    A lens moves the image of a pinhole, a homography's, by a smooth function of its place: the
    polynomial that suits all corners, if one of a higher degree suits them much better.
    """
    straight = np.zeros((len(quads), 4, along.size, 2))
    H = cv2.findHomography(points.reshape(-1, 2), quads.reshape(-1, 2))[0]
    if H is None:
        return straight
    sides = np.roll(points, -1, axis=1) - points
    between = points[:, :, None] + along[:, None] * sides[:, :, None]
    flat = np.concatenate([points.reshape(-1, 2), between.reshape(-1, 2)])
    ideal = np.asarray(cv2.perspectiveTransform(flat[None], H)[0], dtype=np.float64)
    shift = _smooth_shift(ideal, quads.reshape(-1, 2))
    if shift is None:
        return straight
    n = 4 * len(quads)
    ends = (ideal + shift)[:n].reshape(quads.shape)
    chord = np.roll(ends, -1, axis=1) - ends
    unit = chord / np.maximum(np.linalg.norm(chord, axis=2, keepdims=True), 1e-9)
    off = (ideal + shift)[n:].reshape(*between.shape) - ends[:, :, None]
    return off - (off * unit[:, :, None]).sum(axis=3, keepdims=True) * unit[:, :, None]


def _smooth_shift(ideal: Array, seen: Array) -> Array | None:
    """(M, 2) by how much a polynomial moves points, so that the first N of them lie where they are
    `seen` (N, 2); None if none is needed."""
    n = len(seen)
    x, y = ((ideal - ideal[:n].mean(axis=0)) / np.ptp(ideal[:n])).T
    left = seen - ideal[:n]
    found, best = None, float((left**2).sum()) / max(n - 4, 1)
    for degree in _DEGREES:
        powers = [(i, d - i) for d in range(degree + 1) for i in range(d + 1)]
        if n < 2 * len(powers):
            break
        A = np.stack([x**i * y**j for i, j in powers], axis=1)
        terms = np.asarray(np.linalg.lstsq(A[:n], left, rcond=None)[0], dtype=np.float64)
        shift = A @ terms
        spread = float(((left - shift[:n]) ** 2).sum()) / (n - len(powers))
        if spread < _SUITS * best:
            found, best = shift, spread
    return found


def _near_middle(profiles: NDArray[np.float32], reach_px: Array) -> Array:
    """(N, 4, S, T - 1) weights of the steps of profiles (N, 4, S, T) from without to within: 1 half
    way between the greys of both. What other edges add to a blurred one is at its foot; if they are
    far away (`reach_px` (N,)), all of it counts, which has less noise.
    """
    ends = profiles.reshape(len(profiles), -1, _STEPS)[:, :, [0, -1]]
    low, middle, high = np.percentile(ends, (25, 50, 75), axis=1)
    outside = middle[:, 0]
    inside = np.where(middle[:, 1] < outside, low[:, 1], high[:, 1])
    values = (profiles[..., 1:] + profiles[..., :-1]) / 2
    spread = np.abs(outside - inside) / 2 * _LEVEL * (reach_px / _LEVEL_AT_PX) ** 2
    off = values - ((outside + inside) / 2)[:, None, None, None]
    weights = np.exp(-((off / np.maximum(spread, 1.0)[:, None, None, None]) ** 2))
    return np.asarray(weights, dtype=np.float64)


def _once(grey: Grey, quads: Array, reach: float, bends: Array | None) -> Array:
    sides = np.roll(quads, -1, axis=1) - quads
    lengths = np.linalg.norm(sides, axis=2, keepdims=True)
    normals = np.stack([-sides[..., 1], sides[..., 0]], axis=2) / np.maximum(lengths, 1e-6)
    half = np.minimum(_FARTHEST_PX, _OF_REACH * reach * lengths[..., 0].min(axis=1))
    # Single precision is enough for what is sampled, and half the work.
    offsets = (half[:, None] * np.linspace(-1, 1, _STEPS)).astype(np.float32)[:, None, None]
    places = quads[:, :, None] + _ALONG[:, None] * sides[:, :, None]
    places = (places if bends is None else places + bends).astype(np.float32)
    across = normals.astype(np.float32)[:, :, None, None]
    x, y = (
        (places[..., axis, None] + offsets * across[..., axis]).reshape(-1, _ALONG.size * _STEPS)
        for axis in (0, 1)
    )  # (4 N, S T)
    values: Any = cv2.remap(grey, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    profiles = np.asarray(values, dtype=np.float32).reshape(*places.shape[:3], _STEPS)
    slopes = profiles[..., 1:] - profiles[..., :-1]
    rising = np.sign(profiles[..., -1:] - profiles[..., :1])
    weights = np.maximum(slopes * rising, 0.0) ** 2 * _near_middle(profiles, half) + 1e-6
    middles = (offsets[..., 1:] + offsets[..., :-1]) / 2
    found = (weights * middles).sum(axis=3) / weights.sum(axis=3)  # (N, 4, S) along the normals
    # A line through them: the first and the last place moved along the normal.
    fit = np.linalg.pinv(np.stack([1 - _ALONG, _ALONG], axis=1))
    ends = found @ fit.T  # (N, 4, 2) at the side's two ends
    begin = quads + ends[..., :1] * normals
    direction = sides + (ends[..., 1:] - ends[..., :1]) * normals
    before, along = np.roll(begin, 1, axis=1), np.roll(direction, 1, axis=1)
    cross = along[..., 0] * direction[..., 1] - along[..., 1] * direction[..., 0]
    apart = begin - before
    share = (apart[..., 0] * direction[..., 1] - apart[..., 1] * direction[..., 0]) / np.where(
        np.abs(cross) < 1e-9, 1e-9, cross
    )
    met = before + share[..., None] * along
    near = np.linalg.norm(met - quads, axis=2, keepdims=True) < 2 * _FARTHEST_PX
    return np.where(near, met, quads)

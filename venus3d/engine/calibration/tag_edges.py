"""Corners of square tags as the meeting points of their edges.

Where a black corner stands alone on white, blur rounds it off and cornerSubPix finds it a quarter
of a pixel too far inside. Straight edges stay where they are.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from venus3d.engine.calibration.board_reader import Grey
from venus3d.engine.geometry.pose import Array

_ALONG = np.linspace(0.2, 0.8, 8)
"""Places along an edge at which it is looked for, away from the rounded corners."""
_OF_REACH = 0.7
_STEPS = 21
_FARTHEST_PX = 6.0
_ROUNDS = 2
"""The second time the window is centred on the edge."""


def corners_by_edges(grey: Grey, quads: Array, reach: float) -> Array:
    """(N, 4, 2) corners of tags that are about at `quads`, pixels.

    Args:
        grey: (H, W).
        reach: how far from an edge there is no other one, as a share of the tag's side.
    """
    for _ in range(_ROUNDS):
        quads = _once(grey, quads, reach)
    return quads


def _once(grey: Grey, quads: Array, reach: float) -> Array:
    sides = np.roll(quads, -1, axis=1) - quads
    lengths = np.linalg.norm(sides, axis=2, keepdims=True)
    normals = np.stack([-sides[..., 1], sides[..., 0]], axis=2) / np.maximum(lengths, 1e-6)
    half = np.minimum(_FARTHEST_PX, _OF_REACH * reach * lengths[..., 0].min(axis=1))
    # Single precision is enough for what is sampled, and half the work.
    offsets = (half[:, None] * np.linspace(-1, 1, _STEPS)).astype(np.float32)[:, None, None]
    places = (quads[:, :, None] + _ALONG[:, None] * sides[:, :, None]).astype(np.float32)
    across = normals.astype(np.float32)[:, :, None, None]
    x, y = (
        (places[..., axis, None] + offsets * across[..., axis]).reshape(-1, _ALONG.size * _STEPS)
        for axis in (0, 1)
    )  # (4 N, S T)
    values: Any = cv2.remap(grey, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    profiles = np.asarray(values, dtype=np.float32).reshape(*places.shape[:3], _STEPS)
    slopes = profiles[..., 1:] - profiles[..., :-1]
    rising = np.sign(profiles[..., -1:] - profiles[..., :1])
    weights = np.maximum(slopes * rising, 0.0) ** 2 + np.float32(1e-6)
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

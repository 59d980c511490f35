"""Subpixel centroids of discs: the darkness around each, weighed over its own part of the board.

The light ground is a plane through the ring outside the disc, so that a shadow moves nothing, and
what is summed is the share by which a pixel is darker: blur leaves its centroid where it was. Noise
of 4 grey levels leaves 0.01 px.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np

from venus3d.engine.calibration.board_reader import Grey
from venus3d.engine.geometry.pose import Array

_ROUNDS, _MOST_ROUNDS, _SETTLED_PX = 2, 8, 0.1
"""The second time the window is centred on the disc. More are needed where a disc was found far
from its place, in dim light: until none moves."""
_FEWEST, _MOST = 14, 28
"""Samples across a window: one a pixel between these."""
_RING = 0.5
"""The ground begins in the middle between the rim and the window's edge."""
_LEAST_CONTRAST = 12.0
"""Grey levels between disc and ground."""
_INNER = 0.5
"""Share of the radius within which a disc is dark."""


def disc_centroids(
    grey: Grey, centres: Array, scales: Array, radius: float, reach: float
) -> Array | None:
    """(N, 2) centroids of the dark discs about `centres` (N, 2), pixels; None if not all are discs.

    Args:
        scales: (N, 2, 2) derivatives of the image by the board, pixels per metre.
        radius: of a disc, metres.
        reach: up to where there is no other disc, metres from the centre.
    """
    across = 2 * reach * np.linalg.norm(scales, axis=1).max()
    count = int(np.clip(np.ceil(across), _FEWEST, _MOST))
    side = (np.arange(count) + 0.5) / count * 2 - 1
    offsets = reach * np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    away = np.linalg.norm(offsets, axis=1)
    offsets, away = offsets[away <= reach], away[away <= reach]
    ring, inner = away >= radius + _RING * (reach - radius), away <= _INNER * radius
    plane = np.column_stack([np.ones(len(offsets)), offsets / reach])
    plane_of = np.linalg.pinv(plane[ring]).T  # (R, 3) a plane from its values in the ring
    around = offsets @ scales.swapaxes(1, 2)
    for number in range(1, _MOST_ROUNDS + 1):
        at = (centres[:, None] + around).astype(np.float32)
        values: Any = cv2.remap(
            grey, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )
        tones = np.asarray(values, dtype=np.float64)
        ground = np.maximum(tones[:, ring] @ plane_of @ plane.T, 1.0)
        darker = ground - tones
        if not (darker[:, inner].mean(axis=1) > _LEAST_CONTRAST).all():
            return None
        shares = darker / ground
        total = shares.sum(axis=1, keepdims=True)
        moved = np.matmul(scales, (shares @ offsets / total)[:, :, None])[:, :, 0]
        if not (total > 0).all():
            return None
        centres = centres + moved
        if number >= _ROUNDS and np.abs(moved).max() < _SETTLED_PX:
            break
    return centres

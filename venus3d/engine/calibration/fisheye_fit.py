"""Whether views come from a fisheye lens: OpenCV's model of one, fitted to the same corners.

`cv2.fisheye.calibrate` (Kannala and Brandt 2006): r = f θ (1 + k1 θ² + ...) where a pinhole has
r = f tan θ. It is fitted to tell the lens, not to calibrate it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np

from venus3d.engine.calibration.observation import Observation, determines_homography
from venus3d.engine.geometry.board import Board

# OpenCV 5 has them where its other flags are.
_PLACE: Any = cv2.fisheye if hasattr(cv2.fisheye, "CALIB_FIX_SKEW") else cv2
_FLAGS: int = _PLACE.CALIB_RECOMPUTE_EXTRINSIC | _PLACE.CALIB_FIX_SKEW
_MOST = 40
"""Views used at most: more take seconds."""


@dataclass(frozen=True)
class FisheyeFit:
    """A fisheye lens fitted to views."""

    rms_px: float
    """Root mean square reprojection distance."""
    view_angle_deg: float
    """Across the image's width."""


def fit_fisheye(board: Board, observations: Sequence[Observation]) -> FisheyeFit | None:
    """OpenCV's fisheye model of observations of one image size; None if it fits none."""
    usable = [o for o in observations if determines_homography(board.points_of(o.ids))]
    usable = usable[:: max(1, -(-len(usable) // _MOST))]
    if len(usable) < 2:
        return None
    points: list[Any] = [board.points_of(o.ids).reshape(1, -1, 3) for o in usable]
    corners: list[Any] = [o.corners.reshape(1, -1, 2) for o in usable]
    K, D = np.eye(3), np.zeros((4, 1))
    size = usable[0].image_size
    try:
        rms, K, D, _, _ = cv2.fisheye.calibrate(points, corners, size, K, D, flags=_FLAGS)
    except cv2.error:  # no fisheye: the points of a view went behind it
        return None
    if not (np.isfinite(rms) and np.isfinite(K).all() and np.isfinite(D).all()):
        return None
    return FisheyeFit(float(rms), _view_angle_deg(K, D.ravel(), size[0]))


def _view_angle_deg(K: Any, D: Any, width: int) -> float:
    angle = np.linspace(0, np.pi, 2000)
    radius = angle * (1 + np.polyval([*D[::-1], 0.0], angle**2))
    # Where the polynomial folds back, nothing is seen.
    rising = np.maximum.accumulate(np.nan_to_num(radius))
    edges = np.array([K[0, 2], width - 1 - K[0, 2]]) / K[0, 0]
    return float(np.degrees(np.interp(edges, rising, angle).sum()))

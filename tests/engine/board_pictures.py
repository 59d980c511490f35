"""Pictures of a board with known truth: rays of every sub-pixel cut the board's plane.

Independent of the renderers in `venus3d`; numpy and OpenCV's resize and remap only.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

_SQUARE_PX = 120
_FINE = 4  # sub-pixels per side


@lru_cache(maxsize=4)
def _rays(camera: Camera) -> NDArray[np.float32]:
    """(H, W, 2) ideal normalised coordinates of the pixel centres; cubic between them is exact."""
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    xd, yd = (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy
    x, y = xd.copy(), yd.copy()
    k1, k2, p1, p2, k3 = camera.coefficients
    for _ in range(25):  # fixed point of eq. (4)
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        dx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        dy = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        x, y = (xd - dx) / radial, (yd - dy) / radial
    return np.stack([x, y], axis=-1)


def picture_of(
    board: Board,
    camera: Camera,
    pose: Pose,
    *,
    blur_px: float = 0.6,
    noise: float = 0.0,
    rng: np.random.Generator | None = None,
) -> NDArray[np.uint8]:
    """(H, W) grey picture of a board with a white margin of one square on a mid-grey wall."""
    texture = cv2.copyMakeBorder(
        board.texture(_SQUARE_PX),
        *(4 * [_SQUARE_PX]),
        cv2.BORDER_CONSTANT,
        value=0 if board.inverted else 255,
    )
    fine = cv2.resize(_rays(camera), None, fx=_FINE, fy=_FINE, interpolation=cv2.INTER_CUBIC)
    x, y = fine[..., 0], fine[..., 1]
    # Depth along the ray to the plane n . X = n . t, then into the board's frame.
    n = pose.R[:, 2]
    s = (n @ pose.t) / (n[0] * x + n[1] * y + n[2])
    e0, e1, o = pose.R[:, 0], pose.R[:, 1], pose.R.T @ pose.t
    bx = s * (e0[0] * x + e0[1] * y + e0[2]) - o[0]
    by = s * (e1[0] * x + e1[1] * y + e1[2]) - o[1]
    scale = _SQUARE_PX / board.square
    mx = ((bx + board.width / 2) * scale + _SQUARE_PX - 0.5).astype(np.float32)
    my = ((by + board.height / 2) * scale + _SQUARE_PX - 0.5).astype(np.float32)
    picture = cv2.remap(
        texture, mx, my, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=128
    )
    picture = cv2.resize(picture, camera.image_size, interpolation=cv2.INTER_AREA).astype(
        np.float64
    )
    if blur_px:
        picture = cv2.GaussianBlur(picture, (0, 0), blur_px)
    if noise and rng is not None:
        picture = picture + rng.normal(0, noise, picture.shape)
    # Room at both ends, as a real exposure leaves it.
    return np.clip(np.rint(25 + 0.8 * picture), 0, 255).astype(np.uint8)

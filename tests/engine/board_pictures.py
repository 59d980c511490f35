"""Pictures of a board with known truth: rays of every sub-pixel cut the board's plane.

Independent of the renderers in `venus3d`; numpy and OpenCV's resize and remap only.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose

_SQUARE_PX = 120
_FINE = 4  # sub-pixels per side


@lru_cache(maxsize=2)
def _rays(camera: Camera) -> NDArray[np.float32]:
    """(2, H, W) ideal normalised coordinates of the sub-pixels' centres: cubic between those of the
    pixels is exact."""
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
    fine = (cv2.resize(v, None, fx=_FINE, fy=_FINE, interpolation=cv2.INTER_CUBIC) for v in (x, y))
    return np.stack(list(fine)).astype(np.float32)


def _place(board: Board, camera: Camera, pose: Pose) -> tuple[slice, slice]:
    """The rows and columns of pixels around the board with its margin; elsewhere is wall."""
    half = np.array([board.width, board.height]) / 2 + board.square
    ends = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * half
    along = np.linspace(0, 1, 30)[:, None]
    rim = [a + along * (b - a) for a, b in pairwise(ends)]
    points = np.pad(np.concatenate(rim), ((0, 0), (0, 1)))
    turn, _ = cv2.Rodrigues(pose.R)
    at, _ = cv2.projectPoints(points, turn, pose.t, camera.K, np.asarray(camera.coefficients))
    low, high = at.min(axis=(0, 1)) - 4, at.max(axis=(0, 1)) + 5
    left, top = np.clip(np.floor(low).astype(int), 0, camera.image_size)
    right, bottom = np.clip(np.ceil(high).astype(int), [left, top], camera.image_size)
    return slice(top, bottom), slice(left, right)


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
    rows, columns = _place(board, camera, pose)
    fine = (slice(_FINE * part.start, _FINE * part.stop) for part in (rows, columns))
    x, y = _rays(camera)[(slice(None), *fine)]
    # Depth along the ray to the plane n . X = n . t, then into the board's frame. Plain floats: the
    # arrays stay single, which is exact to a hundredth of a pixel of the texture.
    R, o = pose.R.tolist(), (pose.R.T @ pose.t).tolist()
    s = float(pose.R[:, 2] @ pose.t) / (R[0][2] * x + R[1][2] * y + R[2][2])
    scale = _SQUARE_PX / board.square

    def texture_at(axis: int, side: float) -> NDArray[np.float32]:
        along = s * (R[0][axis] * x + R[1][axis] * y + R[2][axis])
        return along * scale + ((side / 2 - o[axis]) * scale + _SQUARE_PX - 0.5)

    mx, my = texture_at(0, board.width), texture_at(1, board.height)
    picture = np.full((camera.height, camera.width), 128.0)
    if x.size:
        part = cv2.remap(
            texture, mx, my, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=128
        )
        small = (columns.stop - columns.start, rows.stop - rows.start)
        picture[rows, columns] = cv2.resize(part, small, interpolation=cv2.INTER_AREA)
    if blur_px:
        picture = cv2.GaussianBlur(picture, (0, 0), blur_px)
    if noise and rng is not None:
        picture = picture + rng.normal(0, noise, picture.shape)
    # Room at both ends, as a real exposure leaves it.
    return np.clip(np.rint(25 + 0.8 * picture), 0, 255).astype(np.uint8)


def settle(detector: Detector, images: Iterable[Any]) -> Board:
    """Detect in images until the layout is settled; the board with that layout."""
    for image in images:
        if detector.settled:
            break
        detector.detect(image)
    return detector.board

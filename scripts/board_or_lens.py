"""Whether a fisheye's board is bowed, or its lens bends as four coefficients cannot describe.

Both leave residuals that neighbouring corners share. Corners by OpenCV's `findChessboardCornersSB`,
fits by scipy with a projection written here: nothing of venus3d takes part. The flat board is given
every freedom that a lens may have, the bowed one two parabolas.

    python scripts/board_or_lens.py FOLDER --columns 16 --rows 10 --square-mm 26
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.sparse import lil_matrix
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]
_RADIAL, _EIGHT, _DECENTRED, _PUPIL = slice(4, 8), slice(4, 12), slice(12, 16), slice(16, 18)
_LENS, _SHAPE = 18, 2
"""fx, fy, cx, cy, eight radial coefficients, two tangential and two of a thin prism, two of the
entrance pupil's way along the axis (mm); the board's bow along x and y (mm)."""
_FREEDOMS: dict[str, tuple[list[slice], bool]] = {
    "flat, 4 radial coefficients": ([_RADIAL], False),
    "flat, 8 radial": ([_EIGHT], False),
    "flat, 4 radial, tangential, thin prism": ([_RADIAL, _DECENTRED], False),
    "flat, 4 radial, moving entrance pupil": ([_RADIAL, _PUPIL], False),
    "flat, all of these": ([_EIGHT, _DECENTRED, _PUPIL], False),
    "bowed, 4 radial": ([_RADIAL], True),
    "bowed, all of these": ([_EIGHT, _DECENTRED, _PUPIL], True),
}


def projected(lens: Array, points: Array) -> Array:
    """(N, 2) pixels of (N, 3) points in the camera's frame, mm (Kannala and Brandt, 2006)."""
    radius = np.hypot(points[:, 0], points[:, 1])
    angle = np.arctan2(radius, points[:, 2])
    for _ in range(4):  # the pupil that a ray enters by depends on its angle
        pupil = lens[16] * angle**2 + lens[17] * angle**4
        angle = np.arctan2(radius, points[:, 2] - pupil)
    powers = angle[:, None] ** np.arange(2, 17 + 1, 2)
    bent = angle * (1 + powers[:, :8] @ lens[_EIGHT])
    x, y = (points[:, :2] * (bent / np.maximum(radius, 1e-12))[:, None]).T
    p1, p2, s1, s2 = lens[_DECENTRED]
    squared = x**2 + y**2
    x, y = (
        x + 2 * p1 * x * y + p2 * (squared + 2 * x**2) + s1 * squared,
        y + p1 * (squared + 2 * y**2) + 2 * p2 * x * y + s2 * squared,
    )
    return np.column_stack([lens[0] * x + lens[2], lens[1] * y + lens[3]])


def fitted(
    board: Array, views: list[Array], size: tuple[int, int], free: list[int]
) -> tuple[Array, float]:
    """The parameters of lens and bow, and the rms of the distances, px.

    Args:
        board: (N, 3) its corners, mm, around their centre.
        views: of each picture (N, 2) the corners, px.
        free: which of lens and bow are fitted; the others stay 0.
    """
    columns, count = len(free), len(board)
    unit = board[:, :2] / np.abs(board[:, :2]).max(axis=0)
    parabolas = unit**2 - (unit**2).mean(axis=0)
    camera = np.zeros(_LENS + _SHAPE)
    camera[:4] = [size[0] * 0.44, size[0] * 0.44, size[0] / 2, size[1] / 2]
    start = [camera[free]]
    for corners in views:
        matrix = np.array([[camera[0], 0, camera[2]], [0, camera[1], camera[3]], [0, 0, 1]])
        rays = cv2.fisheye.undistortPoints(corners[:, None], matrix, np.zeros(4))
        _, turn, place = cv2.solvePnP(board, rays, np.eye(3), None)
        start += [turn.ravel(), place.ravel()]

    def residuals(values: Array) -> Array:
        camera[free] = values[:columns]
        shape = board + np.column_stack([np.zeros((count, 2)), parabolas @ camera[_LENS:]])
        poses = values[columns:].reshape(-1, 6)
        return np.concatenate(
            [
                (projected(camera, Rotation.from_rotvec(p[:3]).apply(shape) + p[3:]) - c).ravel()
                for p, c in zip(poses, views, strict=True)
            ]
        )

    pattern = lil_matrix((2 * count * len(views), columns + 6 * len(views)), dtype=np.int8)
    pattern[:, :columns] = 1
    for index in range(len(views)):
        rows = slice(2 * count * index, 2 * count * (index + 1))
        pattern[rows, columns + 6 * index : columns + 6 * index + 6] = 1
    found = least_squares(
        residuals,
        np.concatenate(start),
        jac_sparsity=pattern,
        x_scale="jac",  # pyright: ignore[reportArgumentType]
        max_nfev=100,
    )
    residuals(found.x)
    return camera.copy(), float(np.sqrt(2 * found.cost / (count * len(views))))


def main() -> None:
    """Print rms, fx, fy and the bow for each freedom."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--columns", type=int, required=True, help="squares, not inner corners")
    parser.add_argument("--rows", type=int, required=True)
    parser.add_argument("--square-mm", type=float, required=True)
    asked = parser.parse_args()
    inner = (asked.columns - 1, asked.rows - 1)
    board = np.zeros((inner[0] * inner[1], 3))
    board[:, :2] = asked.square_mm * np.indices(inner).T.reshape(-1, 2)
    board -= board.mean(axis=0)
    views: list[Array] = []
    size = (0, 0)
    for file in sorted(asked.folder.iterdir()):
        picture = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        if picture is None:
            continue
        size = (picture.shape[1], picture.shape[0])
        flags = cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
        is_found, corners = cv2.findChessboardCornersSB(picture, inner, None, flags)
        if is_found:
            views.append(corners.reshape(-1, 2).astype(np.float64))
    print(f"{len(views)} pictures")
    for name, (slices, is_bowed) in _FREEDOMS.items():
        free = [*range(4), *(i for part in slices for i in range(_LENS)[part])]
        free += range(_LENS, _LENS + _SHAPE) if is_bowed else ()
        lens, rms = fitted(board, views, size, free)
        bow = "".join(f"  bow {along:.2f} mm" for along in lens[_LENS:] if is_bowed)
        print(f"{name:40} rms {rms:.3f} px  fx {lens[0]:.1f}  fy {lens[1]:.1f}{bow}", flush=True)


if __name__ == "__main__":
    main()

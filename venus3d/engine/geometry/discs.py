"""The picture of a disc: its centroid is not where the disc's centre is.

A plane seen at an angle shows the nearer half of a disc larger: the ellipse's centre lies on that
side of the projected centre, by about f r^2 sin(tilt) cos(tilt) / z^2 pixels (0.3 px for discs of
21 mm at 0.4 m), and a lens adds to it. Here the disc's rim is projected as a polygon whose centroid
is taken; it is exact for what bends the rim, perspective and lens alike (Heikkila 2000, "Geometric
camera calibration using circular control points", gives the ellipse's centre alone).
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose

_SIDES = 16
_ANGLES = 2 * np.pi * np.arange(_SIDES) / _SIDES
# As wide as has the disc's second moments: what moves a centroid is these, times what bends.
_RIM = np.sqrt(3 / (2 + np.cos(2 * np.pi / _SIDES))) * np.column_stack(
    [np.cos(_ANGLES), np.sin(_ANGLES)]
)

_ROUNDS = 2
_POWERS = [(i, degree - i) for degree in range(4) for i in range(degree + 1)]
_FEWEST = 2 * len(_POWERS)
"""Discs with which a cubic is fitted."""


def rims(centres: Array, radius: float) -> Array:
    """(N, K, 2 or 3) polygons for discs about `centres` (N, 2 or 3); z = 0 is their plane."""
    around = np.zeros((_SIDES, centres.shape[1]))
    around[:, :2] = radius * _RIM
    return centres[:, None] + around


def centroids(polygons: Array) -> Array:
    """(N, 2) of the areas of polygons (N, K, 2)."""
    middles = polygons.mean(axis=1, keepdims=True)
    here = polygons - middles
    after = np.roll(here, -1, axis=1)
    cross = here[..., 0] * after[..., 1] - here[..., 1] * after[..., 0]
    areas = cross.sum(axis=1, keepdims=True)
    return middles[:, 0] + ((here + after) * cross[..., None]).sum(axis=1) / (3 * areas)


def disc_shifts(camera: Camera, board: Board, ids: NDArray[np.intp], pose: Pose) -> Array:
    """(N, 2) centroid of the picture of each of the board's discs minus that of its centre,
    pixels; `pose` is `T_camera_board`."""
    points = board.points_of(ids)
    polygons = rims(points, board.of_kind.radius(board))
    seen = camera.project(pose.apply(polygons.reshape(-1, 3))).reshape(len(points), _SIDES, 2)
    return centroids(seen) - camera.project(pose.apply(points))


def centres_of_discs(points: Array, seen: Array, radius: float) -> Array:
    """(N, 2) where the centres of discs are in a picture, with no camera known.

    A homography with a cubic of the ideal picture (as k1, p1 and p2 are) is fitted to the centres,
    and says by how much the centroids lie beside them. Within 0.01 px for a webcam's lens with
    discs of 21 mm; once the camera is known, `disc_shifts` is exact.

    Args:
        points: (N, 2) of the discs on their plane.
        seen: (N, 2) the discs' centroids, pixels.
        radius: of the discs, in the unit of `points`.
    """
    every = np.concatenate([points[:, None], rims(points, radius)], axis=1)
    centres = seen
    for _ in range(_ROUNDS):
        bent = _bent_picture(points, centres, every)
        if bent is None:
            return seen
        centres = seen - (centroids(bent[:, 1:]) - bent[:, 0])
    return centres


def _bent_picture(points: Array, centres: Array, every: Array) -> Array | None:
    """Where the map that takes `points` (N, 2) to `centres` (N, 2) takes `every` (N, K, 2); None
    if there is none."""
    H, _ = cv2.findHomography(points, centres)
    if H is None:
        return None
    H = np.asarray(H, dtype=np.float64)
    depth = every @ H[2, :2] + H[2, 2]
    if not (depth * np.sign(H[2, 2]) > 0).all():
        return None
    ideal = (every @ H[:2, :2].T + H[:2, 2]) / depth[..., None]
    if len(points) < _FEWEST:
        return ideal
    middle = ideal[:, 0].mean(axis=0)
    x, y = np.moveaxis((ideal - middle) / np.abs(ideal[:, 0] - middle).max(), -1, 0)
    terms = np.stack([x**i * y**j for i, j in _POWERS], axis=-1)
    left = np.linalg.lstsq(terms[:, 0], centres - ideal[:, 0], rcond=None)[0]
    return ideal + terms @ left

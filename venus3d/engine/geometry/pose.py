"""Rigid poses of the board in the camera's frame, and the paper's pose vector.

World is the camera's optical frame (+x right, +y down, +z forward). The board's frame is at the
board's centre: +x along the columns, +y along the rows, +z away from a camera that it faces.

The pose vector `p = [xr, yr, zr, xt, yt, zt]` holds three angles in degrees and the position of the
board's centre in metres. The angles are turns about the camera's *fixed* axes through the board's
centre, X first, then Y, then Z: `R = Rz @ Ry @ Rx` (Figure 5's "system axes", scipy's "xyz").
The board's own axes in the same order (`R = Rx @ Ry @ Rz`, scipy's "XYZ") are available for
teaching as "own".
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from venus3d.engine.errors import PoseError

Array = NDArray[np.float64]
Axes = Literal["fixed", "own"]
Axis = Literal["x", "y", "z"]

AXES: tuple[Axis, Axis, Axis] = ("x", "y", "z")
_SCIPY_ORDER: dict[Axes, str] = {"fixed": "xyz", "own": "XYZ"}
# Closer than this to +-90 degrees about Y, the X and Z angles share one degree of freedom.
GIMBAL_LOCK_DEG = 0.01


@dataclass(frozen=True, eq=False)
class Pose:
    """`T_camera_board`: board to camera coordinates, metres. `@` composes."""

    R: Array
    """(3, 3) rotation matrix."""
    t: Array
    """(3,) position of the board's centre in the camera's frame, metres."""

    @staticmethod
    def identity() -> Pose:
        """The identity transform."""
        return Pose(np.eye(3), np.zeros(3))

    @staticmethod
    def from_vector(p: ArrayLike, axes: Axes = "fixed") -> Pose:
        """Pose of the vector `p`, (6,): three angles in degrees, then x, y, z in metres.
        Raises `PoseError` unless `p` is six finite numbers."""
        vector = np.asarray(p, dtype=np.float64)
        if vector.shape != (6,) or not np.isfinite(vector).all():
            raise PoseError(
                f"A pose is six finite numbers (three angles, three lengths), not {p!r}."
            )
        rotation = Rotation.from_euler(_SCIPY_ORDER[axes], vector[:3], degrees=True)
        return Pose(_matrix(rotation), vector[3:].copy())

    @staticmethod
    def from_rvec_tvec(rvec: ArrayLike, tvec: ArrayLike) -> Pose:
        """Pose of OpenCV's rotation vector (3,), radians, and translation (3,), metres."""
        rotation = Rotation.from_rotvec(np.asarray(rvec, dtype=np.float64).reshape(3))
        return Pose(_matrix(rotation), np.asarray(tvec, dtype=np.float64).reshape(3).copy())

    @staticmethod
    def from_wxyz(wxyz: ArrayLike, position: ArrayLike) -> Pose:
        """Pose of a quaternion (4,), scalar first (viser's order), and a position (3,), metres."""
        rotation = Rotation.from_quat(np.asarray(wxyz, dtype=np.float64), scalar_first=True)
        return Pose(_matrix(rotation), np.asarray(position, dtype=np.float64).reshape(3).copy())

    @staticmethod
    def from_matrix(T: ArrayLike) -> Pose:
        """Pose of a homogeneous matrix (4, 4); the rotation part is made orthonormal.
        Raises `PoseError` if the matrix is not finite or is a reflection."""
        matrix = np.asarray(T, dtype=np.float64)
        if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
            raise PoseError("A pose matrix is 4 x 4 finite numbers.")
        if np.linalg.det(matrix[:3, :3]) <= 0:
            raise PoseError("This matrix mirrors or flattens space: it is no rotation.")
        return Pose(_matrix(Rotation.from_matrix(matrix[:3, :3])), matrix[:3, 3].copy())

    @property
    def rvec(self) -> Array:
        """(3,) rotation vector, radians: OpenCV's `rvec`."""
        return np.asarray(Rotation.from_matrix(self.R).as_rotvec(), dtype=np.float64)

    @cached_property
    def wxyz(self) -> Array:
        """(4,) unit quaternion, scalar first and non-negative (Shepperd 1978)."""
        # scipy's takes thirty times as long, several times in each frame.
        (a, b, c), (d, e, f), (g, h, i) = self.R.tolist()
        # 4 q q^T, whose longest row is a multiple of q.
        rows = (
            (1 + a + e + i, h - f, c - g, d - b),
            (h - f, 1 + a - e - i, b + d, c + g),
            (c - g, b + d, 1 - a + e - i, f + h),
            (d - b, c + g, f + h, 1 - a - e + i),
        )
        longest = max(range(4), key=lambda k: rows[k][k])
        row = rows[longest]
        length = math.copysign(math.hypot(*row), row[0])
        return np.array([value / length for value in row])

    @property
    def matrix(self) -> Array:
        """(4, 4) homogeneous matrix."""
        T = np.eye(4)
        T[:3, :3] = self.R
        T[:3, 3] = self.t
        return T

    @property
    def angle_y_deg(self) -> float:
        """The Y angle of the fixed-axes vector, degrees, -90 ... 90: `-asin(R[2, 0])`."""
        return float(np.degrees(np.arcsin(np.clip(-self.R[2, 0], -1.0, 1.0))))

    @property
    def is_gimbal_locked(self) -> bool:
        """Whether Y is so near +-90 degrees that only the sum or difference of X and Z matters."""
        return 90.0 - abs(self.angle_y_deg) < GIMBAL_LOCK_DEG

    def vector(self, axes: Axes = "fixed") -> Array:
        """The pose vector (6,): angles in degrees (X, Z in -180 ... 180, Y in -90 ... 90), metres.

        In gimbal lock (see `is_gimbal_locked`) the last angle is 0 and the first takes the whole
        turn: the vector describes this pose, but is not unique.
        """
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Gimbal lock", category=UserWarning)
            angles = Rotation.from_matrix(self.R).as_euler(_SCIPY_ORDER[axes], degrees=True)
        return np.concatenate([np.asarray(angles, dtype=np.float64), self.t])

    def inverse(self) -> Pose:
        """`T_board_camera`: camera to board coordinates."""
        return Pose(self.R.T.copy(), -self.R.T @ self.t)

    def __matmul__(self, other: Pose) -> Pose:
        """`T_a_c = T_a_b @ T_b_c`."""
        return Pose(self.R @ other.R, self.R @ other.t + self.t)

    def apply(self, points: ArrayLike) -> Array:
        """Points (..., 3) from the board's to the camera's frame, metres."""
        return np.asarray(points, dtype=np.float64) @ self.R.T + self.t

    def turned(self, axis: Axis, angle_deg: float) -> Pose:
        """This pose after a turn about a fixed axis of the camera through the board's centre."""
        return Pose(turn(axis, angle_deg) @ self.R, self.t.copy())

    def moved(self, translation: ArrayLike) -> Pose:
        """This pose after a translation (3,) in the camera's frame, metres."""
        return Pose(self.R.copy(), self.t + np.asarray(translation, dtype=np.float64))

    def angle_to_deg(self, other: Pose) -> float:
        """Angle, 0 ... 180 degrees, of the single rotation from this orientation to the other."""
        # The chord between two rotation matrices is 2 sqrt(2) sin(angle / 2).
        chord = float(np.linalg.norm(other.R - self.R)) / np.sqrt(8)
        return float(np.degrees(2 * np.arcsin(min(chord, 1.0))))

    def distance_to(self, other: Pose) -> float:
        """Distance between the board centres, metres."""
        return float(np.linalg.norm(other.t - self.t))


def turn(axis: Axis, angle_deg: float) -> Array:
    """(3, 3) right-handed rotation about one coordinate axis, degrees."""
    return _matrix(Rotation.from_euler(axis, angle_deg, degrees=True))


def interpolate(start: Pose, end: Pose, fraction: float) -> Pose:
    """The pose at `fraction` (0 ... 1) of the way, by the shortest rotation and a straight line."""
    rotvec = Rotation.from_matrix(end.R @ start.R.T).as_rotvec()
    R = _matrix(Rotation.from_rotvec(rotvec * fraction)) @ start.R
    return Pose(R, start.t + fraction * (end.t - start.t))


def rotations_of(vectors: ArrayLike) -> Array:
    """Rotation matrices (N, 3, 3) of pose vectors (N, 6), fixed axes: `Rz Ry Rx`. Written out
    because a search needs thousands: five times as fast as scipy's `from_euler("xyz")`."""
    angles = np.radians(np.atleast_2d(np.asarray(vectors, dtype=np.float64))[:, :3]).T
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    R = np.empty((angles.shape[1], 3, 3))
    R[:, 0, 0], R[:, 1, 0], R[:, 2, 0] = cz * cy, sz * cy, -sy
    R[:, 0, 1], R[:, 1, 1], R[:, 2, 1] = cz * sy * sx - sz * cx, sz * sy * sx + cz * cx, cy * sx
    R[:, 0, 2], R[:, 1, 2], R[:, 2, 2] = cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx
    return R


def angles_of(R: ArrayLike) -> Array:
    """(N, 3) angles of the pose vector, degrees, of rotations (N, 3, 3); Y within -90 ... 90.
    The inverse of `rotations_of`, except in gimbal lock, where the angles are not unique."""
    rotations = np.asarray(R, dtype=np.float64)
    x = np.arctan2(rotations[:, 2, 1], rotations[:, 2, 2])
    y = np.arcsin(np.clip(-rotations[:, 2, 0], -1.0, 1.0))
    z = np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0])
    return np.degrees(np.stack([x, y, z], axis=1))


def _matrix(rotation: Any) -> Array:
    # scipy ships no types for Rotation.
    return np.asarray(rotation.as_matrix(), dtype=np.float64)

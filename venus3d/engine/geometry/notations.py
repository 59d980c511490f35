"""A rotation, and a whole pose, as other programs write them, each with a line of Python.

The axes of other programs have other names for the same directions. With `F` from OpenCV's axes to
those of another program, `v' = F v`, a pose becomes `F R F^T, F t`: the board's axes are renamed as
well as the camera's, so that an upright board stays the identity, and a turn is the same turn about
an axis that has another name now.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.pose import Array, Pose

RotationNotation = Literal[
    "rotation-vector", "quaternion-wxyz", "quaternion-xyzw", "matrix", "euler-fixed", "euler-own"
]
ROTATION_NOTATIONS: tuple[RotationNotation, ...] = get_args(RotationNotation)
"""rotation-vector: the axis times the angle, radians, OpenCV's `rvec`. quaternion: with the scalar
first (viser, Blender, Eigen's constructor) or last (ROS, scipy). euler-fixed: degrees about the
fixed axes x, y, z in this order, scipy's "xyz", ROS's roll, pitch, yaw; euler-own: about the
board's own axes x, y, z in this order, scipy's "XYZ"."""

AxesName = Literal["opencv", "opengl", "ros-optical", "ros-body"]
FRAMES: dict[AxesName, Array] = {
    "opencv": np.eye(3),
    "opengl": np.diag([1.0, -1.0, -1.0]),
    "ros-optical": np.eye(3),
    "ros-body": np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
}
"""(3, 3) from OpenCV's axes (x right, y down, z forward) to those of OpenGL and of Blender's camera
(x right, y up, z backward), of ROS's optical frames (as OpenCV's), and of its bodies (x forward, y
left, z up): REP 103, https://www.ros.org/reps/rep-0103.html."""

_SCIPY = "from scipy.spatial.transform import Rotation; R = Rotation.{made}.as_matrix()"
_NUMPY = "import numpy as np; {name} = np.array({numbers})"
_DECIMALS = 12


@dataclass(frozen=True, eq=False)
class Notation:
    """Numbers that stand for a rotation or a pose."""

    values: Array
    """(3,), (4,), (3, 3) or (4, 4)."""
    python: str
    """A line of Python that makes the rotation matrix `R`, or the pose matrix `T`, of them."""


def rotation_notations(R: ArrayLike) -> dict[RotationNotation, Notation]:
    """A rotation matrix (3, 3) in all notations.

    Near a half turn the sign of the rotation vector, and in gimbal lock the Euler angles, are one
    choice of several that stand for the same rotation.
    """
    matrix = np.asarray(R, dtype=np.float64)
    pose = Pose(matrix, np.zeros(3))
    wxyz, fixed, own = pose.wxyz, pose.vector("fixed")[:3], pose.vector("own")[:3]
    made: dict[RotationNotation, tuple[Array, str]] = {
        "rotation-vector": (pose.rvec, "from_rotvec({})"),
        "quaternion-wxyz": (wxyz, "from_quat({}, scalar_first=True)"),
        "quaternion-xyzw": (np.roll(wxyz, -1), "from_quat({})"),
        "euler-fixed": (fixed, 'from_euler("xyz", {}, degrees=True)'),
        "euler-own": (own, 'from_euler("XYZ", {}, degrees=True)'),
    }
    lines = {
        name: Notation(values, _SCIPY.format(made=call.format(_numbers(values))))
        for name, (values, call) in made.items()
    }
    lines["matrix"] = Notation(matrix, _NUMPY.format(name="R", numbers=_numbers(matrix)))
    return {name: lines[name] for name in ROTATION_NOTATIONS}


def pose_in(frame: AxesName, pose: Pose) -> Pose:
    """A pose given in OpenCV's axes, in those of `frame`; the board's axes are renamed too."""
    F = FRAMES[frame]
    return Pose(F @ pose.R @ F.T, F @ pose.t)


def pose_notation(frame: AxesName, pose: Pose) -> Notation:
    """The 4 x 4 matrix of a pose, given in OpenCV's axes, in those of `frame`; metres."""
    T = pose_in(frame, pose).matrix
    return Notation(T, _NUMPY.format(name="T", numbers=_numbers(T)))


def _numbers(values: Array) -> str:
    """As a Python list: 12 decimals, and no negative zeros."""
    return repr((np.round(values, _DECIMALS) + 0.0).tolist())

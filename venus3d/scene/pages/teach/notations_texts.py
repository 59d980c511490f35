"""Texts of the fold-out with a turn in other notations."""

from __future__ import annotations

from venus3d.engine.geometry.notations import AxesName, RotationNotation
from venus3d.languages.texts_module import speak

TITLE = "The same turn in other notations"
POSE_TURN = "From an upright board to this pose: one turn of {angle:.1f}°."
STEP_TURN = "Step {number} only: a turn of {angle}° about {axis}."
STEP_MOVE = "Step 1 only: a move, which turns nothing."
SAME = "All of these numbers say the same; each button copies a line of Python that makes it."
LOCKED = (
    "Gimbal lock: many triples of Euler angles say this turn. Here the last angle is 0, so they "
    "differ from the sliders."
)
WHOLE = "The whole pose in other programs' axes"
WHOLE_NOTE = (
    "Three columns of the turn, one of the place in metres. The board's axes are named like the "
    "camera's, so an upright board has no turn in any of them."
)
COPY, COPY_HINT = "Python", "Copy this as a line of Python"

ROTATIONS: dict[RotationNotation, tuple[str, str]] = {
    "rotation-vector": (
        "Rotation vector",
        "the axis of the one turn, as long as its angle in radians; OpenCV's rvec",
    ),
    "quaternion-wxyz": ("Quaternion w x y z", "scalar first: Blender, viser, Eigen"),
    "quaternion-xyzw": ("Quaternion x y z w", "scalar last: ROS, scipy"),
    "matrix": ("Rotation matrix", "its columns are the board's x, y and z"),
    "euler-fixed": (
        "Euler angles, fixed axes x y z (°)",
        "the sliders' turns; ROS's roll, pitch, yaw",
    ),
    "euler-own": (
        "Euler angles, the board's own x y z (°)",
        "each about an axis that the turns before have moved",
    ),
}
FRAMES: dict[tuple[AxesName, ...], tuple[str, str]] = {
    ("opencv", "ros-optical"): (
        "OpenCV; ROS, optical frame",
        "x right, y down, z away from the camera",
    ),
    ("opengl",): ("OpenGL; Blender's camera", "x right, y up, z towards the camera"),
    ("ros-body",): ("ROS, body frame (REP 103)", "x away from the camera, y left, z up"),
}

speak(__name__)

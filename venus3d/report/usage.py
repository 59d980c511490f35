"""How to use a calibration in other programs: lines to copy, with this camera's own numbers."""

from __future__ import annotations

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array


def python_lines(camera: Camera) -> str:
    """OpenCV in Python."""
    return f"""import cv2
import numpy as np

K = np.array({_rows(camera.K)})
distortion = np.array([{_row(camera.distortion)}])  # k1, k2, p1, p2, k3
undistorted = cv2.undistort(picture, K, distortion)  # a picture of {camera.width} x {camera.height}
pixels, _ = cv2.projectPoints(points, rvec, tvec, K, distortion)
found, rvec, tvec = cv2.solvePnP(points, pixels, K, distortion)"""


def cpp_lines(camera: Camera) -> str:
    """OpenCV in C++."""
    return f"""#include <opencv2/opencv.hpp>

const cv::Matx33d K({", ".join(_row(row) for row in camera.K)});
const cv::Vec<double, 5> distortion({_row(camera.distortion)});  // k1, k2, p1, p2, k3
cv::undistort(picture, undistorted, K, distortion);  // {camera.width} x {camera.height}
cv::projectPoints(points, rvec, tvec, K, distortion, pixels);
cv::solvePnP(points, pixels, K, distortion, rvec, tvec);"""


def ros_lines() -> str:
    """The camera as ROS reads it."""
    return """venus3d export result.json --to ros --output camera_info.yaml
# then the driver's parameter, for example of usb_cam or v4l2_camera:
#   camera_info_url: file:///.../camera_info.yaml
# image_proc undistorts what is published on image_raw with it."""


def _rows(matrix: Array) -> str:
    return "[" + ", ".join(f"[{_row(row)}]" for row in matrix) + "]"


def _row(values: Array) -> str:
    return ", ".join(f"{value:.9g}" for value in values.ravel())

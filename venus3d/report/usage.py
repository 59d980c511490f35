"""How to use a calibration in other programs: lines to copy, with this camera's own numbers."""

from __future__ import annotations

from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import RATIONAL_THIN_PRISM
from venus3d.engine.geometry.pose import Array


def python_lines(camera: Camera) -> str:
    """OpenCV in Python."""
    if not camera.lens.is_perspective:
        return f"""import cv2
import numpy as np

K = np.array({_rows(camera.K)})
D = np.array([{_row(camera.distortion)}])  # k1, k2, k3, k4 of cv2.fisheye
undistorted = cv2.fisheye.undistortImage(picture, K, D, Knew=K)  # {camera.width} x {camera.height}
pixels, _ = cv2.fisheye.projectPoints(points.reshape(1, -1, 3), rvec, tvec, K, D)
rays = cv2.fisheye.undistortPoints(pixels, K, D)  # x, y at z = 1; for angles below 90 degrees"""
    names = _names(camera)
    return f"""import cv2
import numpy as np

K = np.array({_rows(camera.K)})
distortion = np.array([{_row(camera.distortion)}])  # {names}
undistorted = cv2.undistort(picture, K, distortion)  # a picture of {camera.width} x {camera.height}
pixels, _ = cv2.projectPoints(points, rvec, tvec, K, distortion)
found, rvec, tvec = cv2.solvePnP(points, pixels, K, distortion)"""


def cpp_lines(camera: Camera) -> str:
    """OpenCV in C++."""
    if not camera.lens.is_perspective:
        return f"""#include <opencv2/opencv.hpp>

const cv::Matx33d K({", ".join(_row(row) for row in camera.K)});
const cv::Vec4d D({_row(camera.distortion)});  // k1, k2, k3, k4 of cv::fisheye
cv::fisheye::undistortImage(picture, undistorted, K, D, K);  // {camera.width} x {camera.height}
cv::fisheye::projectPoints(points, pixels, rvec, tvec, K, D);"""
    names, count = _names(camera), len(camera.distortion)
    return f"""#include <opencv2/opencv.hpp>

const cv::Matx33d K({", ".join(_row(row) for row in camera.K)});
const cv::Vec<double, {count}> distortion({_row(camera.distortion)});  // {names}
cv::undistort(picture, undistorted, K, distortion);  // {camera.width} x {camera.height}
cv::projectPoints(points, rvec, tvec, K, distortion, pixels);
cv::solvePnP(points, pixels, K, distortion, rvec, tvec);"""


def ros_lines() -> str:
    """The camera as ROS reads it."""
    return """venus3d export result.json --to ros --output camera_info.yaml
# then the driver's parameter, for example of usb_cam or v4l2_camera:
#   camera_info_url: file:///.../camera_info.yaml
# image_proc undistorts what is published on image_raw with it."""


def _names(camera: Camera) -> str:
    names = RATIONAL_THIN_PRISM.coefficient_names[: len(camera.distortion)]
    return ", ".join(names)


def _rows(matrix: Array) -> str:
    return "[" + ", ".join(f"[{_row(row)}]" for row in matrix) + "]"


def _row(values: Array) -> str:
    return ", ".join(f"{value:.9g}" for value in values.ravel())

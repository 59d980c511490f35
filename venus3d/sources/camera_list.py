"""What cameras there are: names, devices by id, picture sizes and rates, controls.

On Linux by V4L2 through linuxpy, which knows all of it without starting the camera; elsewhere, and
where linuxpy is missing, OpenCV opens the first numbers and tells what it gets. linuxpy is an extra
(`pip install "venus3d[cameras]"`), since its licence is the GPL.
"""

from __future__ import annotations

import os
import sys

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.sources.camera_device import open_camera, present_cameras
from venus3d.sources.opencv_log import silence_opencv
from venus3d.sources.v4l2 import CameraFound, CameraMode, found_by_v4l2, has_v4l2

_NUMBERS_TRIED = 6


def list_cameras() -> list[CameraFound]:
    """The cameras at this machine."""
    if sys.platform.startswith("linux"):
        if not has_v4l2():
            return [_by_opencv(device) for device in present_cameras()]
        found = (found_by_v4l2(device) for device in present_cameras())
        return [camera for camera in found if camera is not None]
    silence_opencv()
    numbers = (str(number) for number in range(_NUMBERS_TRIED))
    return [camera for camera in map(_by_opencv, numbers) if not camera.trouble]


def sample_picture(device: str) -> NDArray[np.uint8]:
    """One picture of a camera, after a second in which its exposure settles. Raises `SourceError`
    if it gives none."""
    live = open_camera(device)
    try:
        frame = live.read()
        while frame is not None and frame.time_s < 1.0:
            frame = live.read()
    finally:
        live.close()
    if frame is None:
        raise SourceError(f"Camera {device} sends no picture.")
    return frame.image


def _by_opencv(device: str) -> CameraFound:
    silence_opencv()
    capture = cv2.VideoCapture(int(device) if device.isdecimal() else os.path.realpath(device))
    try:
        if not capture.isOpened():
            return CameraFound(f"Camera {device}", device, (), (), "it cannot be opened")
        width, height = (
            int(capture.get(what)) for what in (cv2.CAP_PROP_FRAME_WIDTH, cv2.CAP_PROP_FRAME_HEIGHT)
        )
        rate = capture.get(cv2.CAP_PROP_FPS)
        mode = CameraMode("", (width, height), (rate,) if rate > 0 else ())
        return CameraFound(f"Camera {device}", device, (mode,), ())
    finally:
        capture.release()

"""Cameras at this machine: by number, device or id, and GStreamer pipelines; by OpenCV."""

from __future__ import annotations

import glob
import os
import sys

import cv2

from venus3d.engine.errors import SourceError
from venus3d.sources.camera_controls import CameraControls
from venus3d.sources.camera_settings import CameraSettings
from venus3d.sources.live import Live
from venus3d.sources.opencv_log import silence_opencv
from venus3d.sources.v4l2 import setting_ranges


def open_camera(
    device: str, size: tuple[int, int] | None = None, settings: CameraSettings | None = None
) -> Live:
    """The camera with a number ("0"), device ("/dev/video0") or id ("/dev/v4l/by-id/usb-...").

    `size` (width, height) is requested; without it the camera chooses. Raises `SourceError` if the
    camera does not exist, is not accessible, or does not offer this size or these settings.
    """
    name = f"Camera {device}"
    controls = CameraControls(name, settings or CameraSettings(), lambda: setting_ranges(device))

    def opening() -> cv2.VideoCapture:
        capture = _camera_capture(device, size)
        try:
            controls.opened(capture)
        except SourceError:
            capture.release()
            raise
        return capture

    live = Live(opening, name, controls=controls)
    live.notes = controls.notes
    if size is not None and live.image_size != size:
        live.close()
        raise SourceError(
            f"{name} gives {live.image_size[0]} x {live.image_size[1]} px, not {size[0]} x "
            f"{size[1]}; ask for a size that it has, or for none."
        )
    return live


def open_pipeline(pipeline: str) -> Live:
    """A GStreamer pipeline ("v4l2src ! ... ! appsink"). Raises `SourceError` if OpenCV was built
    without GStreamer, as its packages are, or if the pipeline does not run."""
    return Live(lambda: _pipeline_capture(pipeline), "The GStreamer pipeline")


def present_cameras() -> list[str]:
    """The cameras' devices by the names that stay the same (Linux; elsewhere none), by id where the
    camera has one: /dev/video0 may be another camera tomorrow."""
    by_id = {os.path.realpath(path): path for path in sorted(glob.glob("/dev/v4l/by-id/*"))}
    return [by_id.get(path, path) for path in sorted(glob.glob("/dev/video*"))]


def _camera_capture(device: str, size: tuple[int, int] | None) -> cv2.VideoCapture:
    silence_opencv()
    _check_device(device)
    capture = cv2.VideoCapture(int(device) if device.isdecimal() else os.path.realpath(device))
    if not capture.isOpened():
        raise SourceError(
            f"Camera {device} cannot be opened; close the program that uses it, or choose another "
            f"({_present()})."
        )
    if size is not None:
        # USB 2 reaches the full rate at this size with compressed images only; a camera without
        # compression is unaffected.
        capture.set(cv2.CAP_PROP_FOURCC, cv2.VideoWriter.fourcc(*"MJPG"))
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
    capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
    return capture


def _pipeline_capture(pipeline: str) -> cv2.VideoCapture:
    silence_opencv()
    if not cv2.videoio_registry.hasBackend(cv2.CAP_GSTREAMER):
        raise SourceError(
            "This OpenCV was built without GStreamer, as its packages are; build it with "
            "GStreamer, or have the pipeline send RTSP or MJPEG and give that address."
        )
    capture = cv2.VideoCapture(pipeline, cv2.CAP_GSTREAMER)
    if not capture.isOpened():
        raise SourceError(
            "The GStreamer pipeline does not run; try it with gst-launch-1.0, and end it with "
            "appsink."
        )
    return capture


def _present() -> str:
    found = ", ".join(present_cameras())
    return f"there is {found}" if found else "this machine shows none"


def _check_device(device: str) -> None:
    """Raise for a camera that does not exist; only Linux shows cameras as files."""
    if not sys.platform.startswith("linux"):
        return
    path = f"/dev/video{device}" if device.isdecimal() else device
    if not os.path.exists(path):
        raise SourceError(
            f"There is no camera {device}; plug it in, or choose another ({_present()})."
        )
    if not os.access(path, os.R_OK | os.W_OK):
        raise SourceError(
            f"Camera {device} may not be used by you; join the group that owns {path} "
            "(mostly: video) and log in again."
        )

"""What cameras there are: names, devices by id, picture sizes and rates, controls.

On Linux by V4L2 through linuxpy, which knows all of it without starting the camera; elsewhere, and
where linuxpy is missing, OpenCV opens the first numbers and tells what it gets. linuxpy is an extra
(`pip install "venus3d[cameras]"`), since its licence is the GPL.
"""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from venus3d.engine.errors import SourceError
from venus3d.sources.camera_device import open_camera, present_cameras
from venus3d.sources.opencv_log import silence_opencv

_NUMBERS_TRIED = 6


@dataclass(frozen=True)
class CameraMode:
    """One picture size of a camera."""

    encoding: str
    """As V4L2 calls it: MJPEG, YUYV, ..."""
    size: tuple[int, int]
    rates: tuple[float, ...]
    """Pictures per second, the fastest first; empty if unknown."""


@dataclass(frozen=True)
class CameraControl:
    """A control of a camera, with its value."""

    name: str
    value: int | bool | None
    minimum: int
    maximum: int
    step: int
    choices: tuple[tuple[int, str], ...] = ()
    """Of a menu: its numbers and names."""
    is_active: bool = True
    """Whether it can be set now: not while an automatic sets it."""


@dataclass(frozen=True)
class CameraFound:
    """A camera at this machine."""

    name: str
    device: str
    """What to name as the source: by id where there is one."""
    modes: tuple[CameraMode, ...]
    controls: tuple[CameraControl, ...]
    trouble: str = ""
    """Why nothing else is known of it."""


def list_cameras() -> list[CameraFound]:
    """The cameras at this machine."""
    if sys.platform.startswith("linux"):
        try:
            import linuxpy  # pyright: ignore[reportUnusedImport] # noqa: F401
        except ImportError:
            return [_by_opencv(device) for device in present_cameras()]
        found = (_by_v4l2(device) for device in present_cameras())
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


def _by_v4l2(device: str) -> CameraFound | None:
    """None for a device that gives no pictures, such as a camera's metadata."""
    import linuxpy.video.device as v4l2  # pyright: ignore[reportMissingTypeStubs]

    library: Any = v4l2
    try:
        with library.Device(os.path.realpath(device)) as camera:
            if library.Capability.VIDEO_CAPTURE not in camera.info.device_capabilities:
                return None
            controls = (_control(library, one) for one in camera.controls.values())
            return CameraFound(
                camera.info.card,
                device,
                tuple(_modes(camera.info.frame_types)),
                tuple(control for control in controls if control is not None),
            )
    except OSError as error:
        reason = error.strerror or str(error)
        return CameraFound(f"Camera {device}", device, (), (), reason)


def _modes(frame_types: list[Any]) -> list[CameraMode]:
    rates: dict[tuple[str, tuple[int, int]], set[float]] = {}
    for one in frame_types:
        known = rates.setdefault((one.pixel_format.name, (one.width, one.height)), set())
        if one.max_fps > 0:
            known.add(round(float(Fraction(one.max_fps)), 2))
    modes = [
        CameraMode(encoding, size, tuple(sorted(fastest, reverse=True)))
        for (encoding, size), fastest in rates.items()
    ]
    return sorted(modes, key=lambda mode: (mode.encoding, -mode.size[0] * mode.size[1]))


def _control(library: Any, control: Any) -> CameraControl | None:
    kinds = (library.BaseNumericControl, library.BooleanControl, library.MenuControl)
    if not isinstance(control, kinds) or control.is_flagged_disabled:
        return None
    choices = (
        tuple((int(number), str(name)) for number, name in control.data.items())
        if isinstance(control, library.MenuControl)
        else ()
    )
    return CameraControl(
        control.config_name,
        control.value,
        control.minimum,
        control.maximum,
        control.step,
        choices,
        is_active=control.is_writeable and not control.is_flagged_inactive,
    )

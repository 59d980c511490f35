"""A camera's sizes, rates and controls by V4L2, through linuxpy (Linux, an extra)."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from venus3d.sources.camera_settings import Range, SettingName


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


def has_v4l2() -> bool:
    """Whether linuxpy is installed and runs here."""
    try:
        _library()
    except ImportError:
        return False
    return True


def _library() -> Any:
    import linuxpy.video.device as v4l2  # pyright: ignore[reportMissingTypeStubs]

    return v4l2


def found_by_v4l2(device: str) -> CameraFound | None:
    """None for a device that gives no pictures, such as a camera's metadata."""
    library = _library()
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


def setting_ranges(device: str) -> Mapping[SettingName, Range]:
    """Least value, greatest value and step of a camera's settings, as far as its driver tells;
    none without linuxpy."""
    if not has_v4l2():
        return {}
    library = _library()
    ids = library.ControlID
    names: dict[int, SettingName] = {
        ids.EXPOSURE_ABSOLUTE: "exposure",
        ids.GAIN: "gain",
        ids.FOCUS_ABSOLUTE: "focus",
        ids.WHITE_BALANCE_TEMPERATURE: "white_balance",
    }
    path = f"/dev/video{device}" if device.isdecimal() else os.path.realpath(device)
    ranges: dict[SettingName, Range] = {}
    try:
        with library.Device(path) as camera:
            for control in camera.controls.values():
                if control.id in names and not control.is_flagged_disabled:
                    ends = control.minimum, control.maximum, control.step
                    ranges[names[control.id]] = (float(ends[0]), float(ends[1]), float(ends[2]))
    except OSError:
        return {}
    return ranges

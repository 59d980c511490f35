"""A camera's exposure, gain, focus and white balance: read, set, or locked as they are.

By OpenCV on the opened capture, on every system; what a camera offers is listed by
`camera_list.py`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Literal, Protocol, get_args

import cv2
from tyro.conf import arg

from venus3d.engine.errors import SourceError
from venus3d.engine.sentences import Sentence

SettingName = Literal["exposure", "gain", "focus", "white_balance"]
SETTING_NAMES: tuple[SettingName, ...] = get_args(SettingName)
_Setting = Annotated[str | None, arg(metavar="NUMBER|auto|lock", help_behavior_hint="(as it is)")]


@dataclass(frozen=True)
class CameraSettings:
    """What is set on a camera when it is opened: a number of its driver's, `auto`, or `lock`, which
    stops the automatic and keeps its value, also when the camera is opened again."""

    exposure: _Setting = None
    """Exposure time, in the driver's unit (V4L2: 0.1 ms)."""
    gain: _Setting = None
    """Gain."""
    focus: _Setting = None
    """Focus; autofocus changes the camera that is being calibrated."""
    white_balance: _Setting = None
    """Colour temperature."""

    def check(self) -> None:
        """Raises `SourceError` for a setting that is neither a number nor `auto` or `lock`."""
        for name, wanted in self.wanted():
            if wanted not in ("auto", "lock") and not _is_number(wanted):
                raise SourceError(f"{_option(name)} wants a number, auto or lock, not {wanted!r}.")

    def wanted(self) -> list[tuple[SettingName, str]]:
        """Names and values of those that are given."""
        wanted: list[tuple[SettingName, str]] = []
        for name in SETTING_NAMES:
            value: str | None = getattr(self, name)
            if value is not None:
                wanted.append((name, value))
        return wanted


Range = tuple[float, float, float]
"""Least value, greatest value, step."""


@dataclass(frozen=True)
class CameraSetting:
    """One that a camera has, as it is now."""

    name: SettingName
    value: float
    """In the driver's unit."""
    automatic: bool | None
    """Whether the camera sets it by itself; None if it never does."""
    range: Range | None = None
    """Of the value; None if the driver does not tell."""


class Adjustable(Protocol):
    """The part of `cv2.VideoCapture` used here."""

    def get(self, propId: int) -> float: ...
    def set(self, propId: int, value: float) -> bool: ...
    def getBackendName(self) -> str: ...


_VALUE: dict[SettingName, int] = {
    "exposure": cv2.CAP_PROP_EXPOSURE,
    "gain": cv2.CAP_PROP_GAIN,
    "focus": cv2.CAP_PROP_FOCUS,
    "white_balance": cv2.CAP_PROP_WB_TEMPERATURE,
}
_AUTOMATIC: dict[SettingName, int] = {
    "exposure": cv2.CAP_PROP_AUTO_EXPOSURE,
    "focus": cv2.CAP_PROP_AUTOFOCUS,
    "white_balance": cv2.CAP_PROP_AUTO_WB,
}
_AUTOFOCUS = Sentence(
    "{name} focuses by itself, which changes the camera that is being calibrated; lock it under "
    "The camera's settings, or with --camera.focus lock."
)
_NOT_TAKEN = Sentence("{name} does not take {option} {wanted}; venus3d cameras shows what it has.")
_EXPOSURE_BY_V4L2 = (1.0, 3.0)
"""Manual and automatic as V4L2's menu numbers them; elsewhere OpenCV has 0.25 and 0.75."""


def apply_settings(capture: Adjustable, settings: CameraSettings, name: str) -> CameraSettings:
    """Set a camera called `name`. Returns the settings with which it will be the same when it is
    opened again: numbers for what is locked. Raises `SourceError` for what it does not take."""
    for what, wanted in settings.wanted():
        automatic = _AUTOMATIC.get(what)
        if automatic is not None:
            manual, by_itself = _on_off(capture, what)
            done = capture.set(automatic, by_itself if wanted == "auto" else manual)
            if not done and wanted in ("auto", "lock"):
                raise _not_taken(name, what, wanted)
        elif wanted == "auto":
            raise _not_taken(name, what, wanted)
        if wanted == "lock":
            settings = replace(settings, **{what: f"{capture.get(_VALUE[what]):g}"})
        elif wanted != "auto" and not _takes(capture, _VALUE[what], float(wanted)):
            raise _not_taken(name, what, wanted)
    return settings


def present_settings(
    capture: Adjustable, ranges: Mapping[SettingName, Range]
) -> tuple[CameraSetting, ...]:
    """Those that a camera has, with the ranges that are known."""
    return tuple(
        CameraSetting(
            name, capture.get(_VALUE[name]), _is_automatic(capture, name), ranges.get(name)
        )
        for name in SETTING_NAMES
        if _has(capture, _VALUE[name])
    )


def settings_notes(capture: Adjustable, name: str) -> tuple[str, ...]:
    """Warnings about a camera as it is set now."""
    if capture.get(cv2.CAP_PROP_AUTOFOCUS) == 1:
        return (_AUTOFOCUS.format(name=name),)
    return ()


def _has(capture: Adjustable, what: int) -> bool:
    # V4L2 gives -1 for what it has not; others give 0 as well.
    return capture.get(what) not in ((-1.0,) if capture.getBackendName() == "V4L2" else (-1.0, 0.0))


def _is_automatic(capture: Adjustable, name: SettingName) -> bool | None:
    what = _AUTOMATIC.get(name)
    if what is None or capture.get(what) == -1:
        return None
    manual, _ = _on_off(capture, name)
    return capture.get(what) != manual


def _on_off(capture: Adjustable, what: SettingName) -> tuple[float, float]:
    if what != "exposure":
        return 0.0, 1.0
    return _EXPOSURE_BY_V4L2 if capture.getBackendName() == "V4L2" else (0.25, 0.75)


def _takes(capture: Adjustable, what: int, value: float) -> bool:
    # Drivers round to their steps and clip to their range without a word.
    return capture.set(what, value) and abs(capture.get(what) - value) <= max(
        1.0, 0.05 * abs(value)
    )


def _not_taken(name: str, what: str, wanted: str) -> SourceError:
    return SourceError(_NOT_TAKEN.format(name=name, option=_option(what), wanted=wanted))


def _option(what: str) -> str:
    return f"--camera.{what.replace('_', '-')}"


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False

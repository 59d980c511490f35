"""A V4L2 driver for tests: it answers ioctl calls as a webcam's does."""

from __future__ import annotations

import errno
from typing import Any

from linuxpy.video import device as v4l2
from linuxpy.video import raw

MODES = {
    v4l2.PixelFormat.MJPEG: {(1920, 1080): (30,), (1280, 720): (60, 30)},
    v4l2.PixelFormat.YUYV: {(640, 480): (30,)},
}
MENU = {1: b"Manual Mode", 3: b"Aperture Priority Mode"}


class Driver:
    """One webcam with autofocus and automatic exposure; `values` are its controls."""

    def __init__(self) -> None:
        number, switch, menu = (
            v4l2.ControlType.INTEGER,
            v4l2.ControlType.BOOLEAN,
            v4l2.ControlType.MENU,
        )
        inactive, ids = v4l2.ControlFlag.INACTIVE, v4l2.ControlID
        self.controls = [
            (ids.GAIN, number, b"Gain", 0, 255, 1, 0, 12),
            (ids.EXPOSURE_AUTO, menu, b"Auto Exposure", 0, 3, 1, 0, 3),
            (ids.EXPOSURE_ABSOLUTE, number, b"Exposure Time, Absolute", 3, 2047, 1, inactive, 250),
            (ids.FOCUS_AUTO, switch, b"Focus, Automatic Continuous", 0, 1, 1, 0, 1),
            (ids.FOCUS_ABSOLUTE, number, b"Focus, Absolute", 0, 250, 5, inactive, 30),
        ]

    def ioctl(self, fd: Any, request: Any, *arguments: Any) -> None:
        """As the kernel's, by name."""
        answer = getattr(self, f"_{request.name.lower()}", None)
        if answer is None or not answer(arguments[0]):
            raise OSError(errno.EINVAL, "Invalid argument")

    def _querycap(self, caps: raw.v4l2_capability) -> bool:
        caps.driver, caps.card, caps.bus_info = b"uvcvideo", b"HD Pro Webcam", b"usb-0000:00:14.0-1"
        caps.device_caps = v4l2.Capability.VIDEO_CAPTURE | v4l2.Capability.STREAMING
        caps.capabilities = caps.device_caps
        return True

    def _enum_fmt(self, one: raw.v4l2_fmtdesc) -> bool:
        if one.index >= len(MODES):
            return False
        one.pixelformat, one.description = list(MODES)[one.index], b"as named"
        return True

    def _enum_framesizes(self, one: raw.v4l2_frmsizeenum) -> bool:
        sizes = list(MODES[v4l2.PixelFormat(one.pixel_format)])
        if one.index >= len(sizes):
            return False
        one.type = v4l2.FrameSizeType.DISCRETE
        one.m1.discrete.width, one.m1.discrete.height = sizes[one.index]
        return True

    def _enum_frameintervals(self, one: raw.v4l2_frmivalenum) -> bool:
        rates = MODES[v4l2.PixelFormat(one.pixel_format)][one.width, one.height]
        if one.index >= len(rates):
            return False
        one.type = v4l2.FrameIntervalType.DISCRETE
        one.discrete.numerator, one.discrete.denominator = 1, rates[one.index]
        return True

    def _query_ext_ctrl(self, one: raw.v4l2_query_ext_ctrl) -> bool:
        after = one.id & ~(v4l2.ControlFlag.NEXT_CTRL | v4l2.ControlFlag.NEXT_COMPOUND)
        for number, kind, name, low, high, step, flags, _ in sorted(self.controls):
            if number > after:
                one.id, one.type, one.name, one.flags = number, kind, name, flags
                one.minimum, one.maximum, one.step = low, high, step
                one.elem_size, one.elems, one.nr_of_dims = 4, 1, 0
                return True
        return False

    def _querymenu(self, one: raw.v4l2_querymenu) -> bool:
        one.name = MENU.get(one.index, b"")
        return one.index in MENU

    def _g_ext_ctrls(self, asked: raw.v4l2_ext_controls) -> bool:
        values = {control[0]: control[-1] for control in self.controls}
        for one in asked.controls[: asked.count]:
            one.value = values[one.id]
        return True

"""A webcam as `cv2.VideoCapture` shows it on V4L2, for tests: no real one is needed.

What it has not is -1. While an automatic sets a value, V4L2 refuses to have it set; numbers beyond
the range are clipped without a word.
"""

from __future__ import annotations

import time
from typing import Any

import cv2
import numpy as np

_SET_BY = {
    cv2.CAP_PROP_FOCUS: cv2.CAP_PROP_AUTOFOCUS,
    cv2.CAP_PROP_EXPOSURE: cv2.CAP_PROP_AUTO_EXPOSURE,
}


class Webcam:
    """With autofocus, automatic exposure, and a gain that it never sets by itself."""

    def __init__(self, backend: str = "V4L2") -> None:
        self.backend, self.unplugged, self.reads = backend, False, 0
        self.manual = {cv2.CAP_PROP_AUTOFOCUS: 0.0, cv2.CAP_PROP_AUTO_EXPOSURE: 1.0}
        if backend != "V4L2":
            self.manual[cv2.CAP_PROP_AUTO_EXPOSURE] = 0.25
        self.values = {
            cv2.CAP_PROP_AUTOFOCUS: 1.0,
            cv2.CAP_PROP_FOCUS: 35.0,
            cv2.CAP_PROP_AUTO_EXPOSURE: 3.0,
            cv2.CAP_PROP_EXPOSURE: 250.0,
            cv2.CAP_PROP_GAIN: 12.0,
        }

    def get(self, propId: int) -> float:
        return self.values.get(propId, -1.0)

    def set(self, propId: int, value: float) -> bool:
        by = _SET_BY.get(propId)
        if propId not in self.values or (by and self.values[by] != self.manual[by]):
            return False
        self.values[propId] = min(value, 250.0) if propId == cv2.CAP_PROP_FOCUS else value
        return True

    def getBackendName(self) -> str:
        return self.backend

    def read(self) -> tuple[bool, Any]:
        time.sleep(0.01)
        self.reads += 1
        return not self.unplugged, np.full((48, 64, 3), self.reads % 256, np.uint8)

    def release(self) -> None:
        """Nothing holds it."""

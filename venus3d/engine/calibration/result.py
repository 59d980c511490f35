"""A calibration's result and what may be wrong with it, as frozen values.

Nothing in here computes: `adjustment` and `diagnosis` fill it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from venus3d.engine.calibration.observation import View
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array

DiagnosisKind = Literal[
    "parallel-views",
    "unseen-side",
    "same-depth",
    "outlying-view",
    "wrong-layout",
    "swapped-size",
    "wrong-dictionary",
    "impossible-distance",
    "correlated",
    "folding",
    "weak-focal-length",
]


@dataclass(frozen=True)
class Diagnosis:
    """Something about a calibration that makes its numbers less trustworthy than they look."""

    kind: DiagnosisKind
    cause: str
    """One sentence: what is the matter, with figures."""
    cure: str
    """One sentence: what to do about it."""
    views: tuple[int, ...] = ()
    """Numbers of the views concerned; empty for all."""

    def __str__(self) -> str:
        """Both in one sentence."""
        return f"{self.cause.removesuffix('.')}; {self.cure[:1].lower()}{self.cure[1:]}"


@dataclass(frozen=True, eq=False)
class Calibration:
    """A camera with everything the views say about how well it is known."""

    board: Board
    """The board by whose corners the views were calibrated."""
    camera: Camera
    covariance: Array
    """(9, 9) of the `PARAMETERS`; zero rows and columns for parameters held fixed."""
    free: tuple[bool, ...]
    """Which of the nine parameters were estimated."""
    residual_sigma_px: float
    """Standard deviation of one corner coordinate, from the residuals, pixels."""
    rms_px: float
    """Root mean square reprojection distance over all corners, pixels (OpenCV's rms)."""
    views: tuple[View, ...]

    @property
    def sigma(self) -> Array:
        """(9,) standard deviations of the `PARAMETERS`; 0 where a parameter was held fixed."""
        return np.sqrt(np.diag(self.covariance))

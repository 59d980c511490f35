"""What the session knows at one moment: frozen values that anyone may draw or store.

Nothing in here computes; the session fills it, the scene and the storage read it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.decomposition import Steps
from venus3d.engine.observation import Observation, View
from venus3d.engine.pose import Array, Pose
from venus3d.engine.words import Words

Phase = Literal["startup", "guiding", "captured", "converged", "finished"]
"""startup: until the first capture; guiding: a target is shown; captured: calibrating and
searching; converged: the parameters have settled; finished: the user ended it, or it ran out."""

Method = Literal["random", "pose-selection", "venus", "global"]
METHODS: tuple[Method, ...] = ("random", "pose-selection", "venus", "global")
Cost = Literal["projection-variance", "sum-iod", "max-iod", "rms"]
COSTS: tuple[Cost, ...] = ("projection-variance", "sum-iod", "max-iod", "rms")


@dataclass(frozen=True, eq=False)
class Calibration:
    """A camera with everything the views say about how well it is known."""

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


@dataclass(frozen=True, eq=False)
class Match:
    """How the board as it is now compares with where it should be."""

    steps: Steps
    """From the board's current pose to the target: what remains of each degree of freedom now."""
    active_step: int
    """1 ... 4: the first step whose degree of freedom is not yet within tolerance (4 if none)."""
    within: tuple[bool, bool, bool, bool]
    """For each step, whether its degree of freedom is within tolerance."""
    remaining_mm: Array
    """(3,) target minus current position, camera frame, millimetres."""
    remaining_deg: Array
    """(3,) turns about X, Y, Z that are left, degrees."""
    corner_distance_px: float
    """Mean distance of the projected inner corners, pixels."""
    overlap: float
    """Jaccard overlap of the two silhouettes in the image, 0 ... 1."""
    motion_px: float
    """How far the corners moved since the last frame, pixels; inf if there was none."""
    reached: bool
    """The overlap is large enough and the corners are still."""


@dataclass(frozen=True, eq=False)
class Target:
    """The pose asked for, why, and how to get there."""

    number: int
    """Counts from 1; a skipped target uses up its number."""
    pose: Pose
    steps: Steps
    """Eq. (15): from the frontal, upright board to the target."""
    method: Method
    cost: Cost
    serves: tuple[str, ...]
    """The parameters this view helps most, best first."""
    reason: str
    """One sentence: what this pose is for."""
    predicted_sigma: Array
    """(9,) expected standard deviations after this view; NaN where not known."""
    predicted_error_px: float
    """Expected mean projection error over the image after this view; NaN where not known."""
    evaluated: int
    """How many candidate poses were looked at."""
    search_s: float
    """How long the search took."""


@dataclass(frozen=True, eq=False)
class Convergence:
    """Eqs (16), (17) per parameter."""

    ratio: Array
    """(9,) variance now over variance before; NaN where there is no before."""
    parameters: tuple[bool, ...]
    """(9,) which have converged."""
    rule: Literal["repaired", "printed"]

    @property
    def converged(self) -> bool:
        """Whether all parameters have."""
        return all(self.parameters)


@dataclass(frozen=True, eq=False)
class Progress:
    """One calibration's summary, for the plots of how things went."""

    views: int
    rms_px: float
    parameters: Array
    """(9,) values."""
    sigma: Array
    """(9,) standard deviations."""
    error_px: float
    """Mean projection error over the image that the covariance predicts, pixels."""


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Everything about one moment of a guided calibration."""

    number: int
    """Counts every observation."""
    phase: Phase
    board: Board
    camera: Camera
    """The best camera known: a guess, the start-up estimate, or the calibration's."""
    observation: Observation
    pose: Pose | None
    """The board as it is estimated now; None while it is not seen."""
    target: Target | None
    match: Match | None
    calibration: Calibration | None
    convergence: Convergence | None
    history: tuple[Progress, ...]
    headline: str
    """Two or three words for the state: "Hold still", "Captured", "Step 3 of 4"."""
    instruction: Words
    """The one sentence that says what to do now."""
    warnings: tuple[str, ...] = field(default=())

    @property
    def views(self) -> tuple[View, ...]:
        """The captured views."""
        return () if self.calibration is None else self.calibration.views

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
from venus3d.engine.known import Knowledge
from venus3d.engine.moves import Walk
from venus3d.engine.observation import Observation, View
from venus3d.engine.pose import Array, Pose
from venus3d.engine.words import Words

Phase = Literal["startup", "guiding", "captured", "converged", "finished"]
"""startup: until the first capture; guiding: a target is shown; captured: calibrating and
searching; converged: the parameters have settled; finished: the user ended it, or it ran out."""

Method = Literal["random", "pose-selection", "venus", "global"]
METHODS: tuple[Method, ...] = ("random", "pose-selection", "venus", "global")
Cost = Literal["projection-variance", "max-ere", "trace", "log-det", "sum-iod", "max-iod", "rms"]
COSTS: tuple[Cost, ...] = (
    "projection-variance",
    "max-ere",
    "trace",
    "log-det",
    "sum-iod",
    "max-iod",
    "rms",
)
Strategy = Literal["annealing", "global", "dual-annealing", "differential-evolution"]
STRATEGIES: tuple[Strategy, ...] = (
    "annealing",
    "global",
    "dual-annealing",
    "differential-evolution",
)
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
    limit_mm: float
    """The centre is in its place within this distance, millimetres."""
    limit_deg: float
    """A turn is done within this angle, degrees."""


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
    error_px: float = float("nan")
    """Expected mean projection error over the image before this view; NaN where not known."""
    alternatives: tuple[Target, ...] = ()
    """Clearly different poses that are nearly as good, best first; one may suit the wrists."""
    held: str = ""
    """In a few words, how the board is held there: upright or turned, place, tilt, distance."""

    @property
    def gain_px(self) -> float:
        """By how much this view is expected to lower the mean projection error; NaN if unknown."""
        return self.error_px - self.predicted_error_px


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
    predicted_sigma: Array = field(default_factory=lambda: np.full(9, np.nan))
    """(9,) what the last view's target had promised; NaN if it was not taken at a target."""
    predicted_error_px: float = float("nan")
    """What the last view's target had promised for `error_px`; NaN likewise."""


@dataclass(frozen=True)
class Forecast:
    """How many more views it takes until a wanted projection error, if targets are followed."""

    wanted_px: float
    """The wanted mean projection error over the image."""
    views: int | None
    """More views needed; 0 if it is reached; None if more than were looked ahead."""
    low: int | None
    """Lower end of the interval of about 90 %; None likewise."""
    high: int | None
    """Its upper end; None likewise."""
    looked_ahead: int
    """How many views ahead were planned."""


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
    diagnoses: tuple[Diagnosis, ...] = field(default=())
    """What makes this calibration less trustworthy than its numbers; worst first."""
    forecast: Forecast | None = None
    """None while nothing can be said."""
    method: Method = "global"
    """How the next poses are found."""
    cost: Cost = "projection-variance"
    """What the search for them makes small."""
    knowledge: Knowledge | None = None
    """Of the present calibration; None while it does not estimate all nine parameters."""
    walk: Walk | None = None
    """How the present target was searched; None if it was not."""

    @property
    def views(self) -> tuple[View, ...]:
        """The captured views."""
        return () if self.calibration is None else self.calibration.views

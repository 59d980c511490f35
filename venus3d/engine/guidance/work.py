"""The slow half of the session: calibrate, diagnose, search. Pure: it can run on any thread.
The session hands out a frozen `Work` and applies its `Outcome`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.adjustment import calibrate
from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.checks import Diagnoses
from venus3d.engine.calibration.lens_choice import calibrate_with_any_lens, start_with_any_lens
from venus3d.engine.calibration.observation import (
    Observation,
    View,
    reprojection_errors,
    rms_distance,
)
from venus3d.engine.calibration.shared_errors import CornerErrors
from venus3d.engine.errors import CalibrationError, VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.lenses import lens_chosen
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.convergence import Convergence, Progress, check_convergence
from venus3d.engine.guidance.known_camera import KnownCamera
from venus3d.engine.guidance.loop import Calibrated
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.forecast import Forecast, forecast
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.pose_space import Space
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.search_trace import OnSearchStep, SearchRecorder, SearchTrace, Stop
from venus3d.engine.planning.suggest import NextTarget, Planner
from venus3d.engine.planning.target import Target
from venus3d.engine.planning.uncertainty import ProjectionUncertainty, projection_uncertainty
from venus3d.engine.sentences import Sentence, said_by

_SIMPLER = Sentence("Without lens distortion for now. {cause}")
_KNOWN = Sentence("With the camera from before for now. {cause}")
_GUESSED = Sentence("The camera is only guessed for now. {cause}")


@dataclass(frozen=True, eq=False)
class Outcome:
    """The result of a `Work`."""

    work: Work
    calibration: Calibration
    calibrated: Calibrated
    posterior: Posterior
    """The posterior after the views, for planning."""
    history: tuple[Progress, ...]
    convergence: Convergence
    suggestion: NextTarget | None
    """None if converged, if there are enough views, or if no pose fits the limits."""
    is_over: bool
    """Whether nothing is left to do: converged, or enough views."""
    warnings: tuple[str, ...]
    diagnoses: Diagnoses
    forecast: Forecast | None = None
    """None if unknown, or if there was no time for it."""
    uncertainty: ProjectionUncertainty | None = None
    """None while not all parameters are estimated."""
    search_trace: SearchTrace | None = None
    """The search of the suggestion; None if there was none."""


@dataclass(frozen=True, eq=False)
class Work:
    """Calibrate these views, then search for the next pose."""

    board: Board
    settings: Settings
    observations: tuple[Observation, ...]
    numbers: tuple[int, ...]
    history: tuple[Progress, ...]
    """The earlier calibrations, with fewer views."""
    heuristic_state: HeuristicState
    """State of the rule, for methods that have one."""
    skipped: tuple[Pose, ...]
    target_number: int
    start: Camera
    """The start-up's camera; used while the views determine none."""
    keep_going: bool = False
    """Search on even if everything has converged."""
    last_target: Target | None = None
    """Target of the last view; None if it was not taken at one."""
    known: KnownCamera | None = None
    """A camera known from before; `start` is then this one."""

    def run(
        self,
        stop: Stop | None = None,
        on_step: OnSearchStep | None = None,
        on_calibrated: Callable[[Calibrated], None] | None = None,
    ) -> Outcome:
        """Do the work. `stop` ends the search early with the best pose; `on_step` observes it, and
        `on_calibrated` is called before it.
        Raises `CalibrationError` if the views determine no camera at all."""
        began = time.perf_counter()
        calibration, warnings = self._calibrated()
        took_s = time.perf_counter() - began
        calibrated = Calibrated(took_s, len(self.observations), calibration.rms_px)
        if on_calibrated is not None:
            on_calibrated(calibrated)
        settings = self.settings
        posterior = Posterior.of_calibration(
            calibration, settings.noise, self._known_of(calibration)
        )
        history = (*self.history, self._progress(calibration))
        convergence = check_convergence(history, epsilon=settings.epsilon, rule=settings.rule)
        enough = len(self.observations) >= settings.max_views
        is_over = enough or (convergence.converged and not self.keep_going)
        suggestion, recorder = None, SearchRecorder(on_step)
        space = Space.of(posterior, settings, self.skipped, calibration.views)
        planner = Planner(posterior, settings, space, calibration.views, stop, recorder)
        if not is_over:
            try:
                # Seeded by the target's number: a replayed session gives the same poses.
                rng = np.random.default_rng([settings.seed, self.target_number])
                suggestion = planner.next_target(self.target_number, rng, self.heuristic_state)
            except VenusError as error:
                warnings = (
                    *warnings,
                    said_by(error),
                )  # the views stay; more can be captured manually
        if suggestion is not None and suggestion.note:
            warnings = (*warnings, suggestion.note)
        target = None if suggestion is None else suggestion.target
        return Outcome(
            self,
            calibration,
            calibrated,
            posterior,
            history,
            convergence,
            suggestion,
            is_over,
            warnings,
            Diagnoses.of(calibration),
            self._forecast(planner, calibration, suggestion),
            projection_uncertainty(calibration, posterior, target),
            None if target is None else recorder.trace(target.pose.vector()),
        )

    def _progress(self, calibration: Calibration) -> Progress:
        aim = self.last_target
        return Progress(
            len(self.observations),
            calibration.rms_px,
            calibration.camera.parameters,
            calibration.sigma,
            calibration.uncertainty_px,
            self._promised(calibration),
            float("nan") if aim is None else aim.predicted_uncertainty_px,
            calibration.camera.parameter_names,
        )

    def _known_of(self, calibration: Calibration) -> Array | None:
        """What is known from before of the parameters that the calibration has."""
        known = self.known
        if known is None or known.camera.lens != calibration.camera.lens:
            return None
        return known.information

    def _promised(self, calibration: Calibration) -> Array:
        """(p,) the sigmas that the last view's target promised; NaN if it promised none."""
        aim, p = self.last_target, len(calibration.camera.parameters)
        if aim is None or len(aim.predicted_sigma) != p:
            return np.full(p, np.nan)
        return aim.predicted_sigma

    def _calibrated(self) -> tuple[Calibration, tuple[str, ...]]:
        """The fullest model that the views determine, and a sentence if it is not the full one."""
        cause: str = ""
        if len(self.observations) > 1:
            try:
                return self._with_lens(), ()
            except CalibrationError as error:
                cause = said_by(error)
        if self.known is not None:
            located = provisional(self.board, self.observations, self.numbers, self.start)
            return located, (_KNOWN.format(cause=cause),) if cause else ()
        # The views stay; a simpler model serves until more come.
        try:
            simple = start_with_any_lens(
                self.board,
                self.observations,
                lens=lens_chosen(self.settings.lens),
                numbers=self.numbers,
            )
            return simple, (_SIMPLER.format(cause=cause),) if cause else ()
        except CalibrationError as error:
            return provisional(self.board, self.observations, self.numbers, self.start), (
                _GUESSED.format(cause=cause or said_by(error)),
            )

    def _with_lens(self) -> Calibration:
        lens = lens_chosen(self.settings.lens)
        if lens is None:
            return calibrate_with_any_lens(self.board, self.observations, numbers=self.numbers)
        return calibrate(self.board, self.observations, lens=lens, numbers=self.numbers)

    def _forecast(
        self, planner: Planner, calibration: Calibration, suggestion: NextTarget | None
    ) -> Forecast | None:
        """None before the first full calibration, when stopped, and for the cost "rms", which is
        too slow to plan with."""
        wanted_px = self.settings.wanted_uncertainty_px
        if wanted_px is None or self.settings.cost == "rms":
            return None
        if not all(calibration.free) or not planner.posterior.settled:
            return None
        views = calibration.views
        degrees = (
            2 * sum(v.observation.count for v in views) - len(calibration.free) - 6 * len(views)
        )
        if calibration.corner_errors.shared_px > 0:
            degrees = len(views) + 1  # what the views share is learnt from the views alone
        try:
            return forecast(
                planner,
                np.random.default_rng([self.settings.seed, self.target_number, 1]),
                wanted_px=wanted_px,
                degrees=degrees,
                state=self.heuristic_state if suggestion is None else suggestion.state,
                first=None if suggestion is None else suggestion.target.pose.vector(),
            )
        except VenusError:
            return None  # no pose fits the limits: already reported by the suggestion


def provisional(
    board: Board, observations: Sequence[Observation], numbers: Sequence[int], camera: Camera
) -> Calibration:
    """Views located with a camera that they do not determine, so that guidance can continue."""
    views: list[View] = []
    for number, observation in zip(numbers, observations, strict=True):
        pose = estimate_pose(camera, board, observation)
        if pose is None:
            raise CalibrationError(
                f"View {number} shows no pose of this board; check the board's options."
            )
        errors = reprojection_errors(camera, board, observation, pose)
        views.append(View(number, observation, pose, rms_distance(errors), errors))
    residuals = np.concatenate([view.errors for view in views])
    p = len(camera.parameters)
    return Calibration(
        board=board,
        camera=camera,
        covariance=np.zeros((p, p)),
        covariance_noise_only=np.zeros((p, p)),
        free=(False,) * p,
        residual_sigma_px=float(residuals.std()),
        corner_errors=CornerErrors(float(residuals.std())),
        rms_px=rms_distance(residuals),
        views=tuple(views),
    )

"""`venus3d study bench`: measures this project's claims about its search.

Speeds are ratios of two things timed alternately within one process. Accuracies are medians with
quartiles over seeded repeats. Compared are the product's parts with OpenCV's and scipy's, and
methods with each other by their poses.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import cv2
import numpy as np

from venus3d.engine.calibration.detection import Detector
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.costs import make_cost
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.search import search
from venus3d.engine.planning.settings import Method
from venus3d.sources.sim import Simulation
from venus3d.sources.view_errors import ViewErrors
from venus3d.study.runner import Row, run_trials
from venus3d.study.simulated import (
    NOISE_PX,
    guided_calibrations,
    observed,
    true_error_px,
    true_information,
)
from venus3d.study.text import table

VIEWS = 14
TIMINGS = 15
"""How often each of two things is timed, alternately."""
STATES = 10
"""States of a calibration by `global`, with 2, 3 ... 11 views, for comparing searches."""
SHARED_PX = 0.2
"""Error of each smooth mode that a view's corners share; two thirds of the noise, as on real
recordings."""
VIEW_ERRORS = ViewErrors(bow=0.0003, bias_px=0.2, blur_px=1.0)
"""Of rendered views: as large as on real recordings."""
LONG_RUNS, LONG_BUDGET = 10, 20_000


@dataclass(frozen=True)
class Bar:
    """One claim, measured."""

    name: str
    value: float
    bar: str
    ok: bool
    quartiles: tuple[float, float] | None = None


@dataclass(frozen=True)
class BenchTrial:
    """One calibration by one method, or the searches on one state."""

    kind: str
    """A method, "state", "shared" or "rendered"."""
    repeat: int
    seed: int

    @property
    def key(self) -> str:
        """`kind/repeat`."""
        return f"{self.kind}/{self.repeat}"


def bench(
    rows_file: Path, *, seed: int = 0, repeats: int = 20, jobs: int | None = None
) -> list[Bar]:
    """Measure every claim; the rows go to `rows_file`. Raises what `run_trials` raises."""
    speed = (candidate_speed(seed), *suggestion_speed(seed))
    trials = [
        *(BenchTrial("state", index, seed) for index in range(STATES)),
        *(
            BenchTrial(kind, n, seed)
            for n in range(repeats)
            for kind in ("venus", "global", "shared")
        ),
        # The root mean square of twenty scatters from 0.79 to 1.0.
        *(BenchTrial("rendered", n, seed) for n in range(3 * repeats)),
    ]
    rows = run_trials(
        bench_trial,
        trials,
        rows_file,
        setup=f"bench seed={seed} views={VIEWS} runs={LONG_RUNS}x{LONG_BUDGET}",
        jobs=jobs,
        label="bench",
    )
    return [*speed, *judged(rows)]


def bench_trial(trial: BenchTrial) -> list[Row]:
    """The rows of one trial."""
    if trial.kind == "state":
        return [state_row(trial)]
    if trial.kind == "shared":
        return [promise_row(trial, seen_with_shared_errors)]
    return [rendered_row(trial)] if trial.kind == "rendered" else method_rows(trial)


def seen_with_shared_errors(pose: Pose, rng: np.random.Generator) -> Observation:
    """The corners' projections with noise, and smooth errors that they share."""
    return observed(PAPER_CAMERA, Board(), pose, rng, shared_px=SHARED_PX)


def rendered_row(trial: BenchTrial) -> Row:
    """As `promise_row`, of pictures: the simulator bows the board of each view, draws its corners
    aside and blurs it."""
    detector = Detector(Board())
    seed = int(np.random.default_rng([trial.seed, trial.repeat]).integers(2**31))
    with closing(Simulation(seed=seed, autopilot=False, view_errors=VIEW_ERRORS)) as source:

        def see(pose: Pose, _rng: np.random.Generator) -> Observation:
            source.move_to(pose)
            source.draw_view_error(pose)
            frame = source.read()
            assert frame is not None, "the simulation ends only when it is closed"
            return detector.detect(frame.image)

        return promise_row(trial, see)


def promise_row(trial: BenchTrial, see: Callable[[Pose, np.random.Generator], Observation]) -> Row:
    """What the calibration promises and what came, of a recording whose views bring errors that
    all their corners share."""
    *_, last = guided_calibrations(Settings(), VIEWS, seed=trial.seed, repeat=trial.repeat, see=see)
    calibration = last.outcome.calibration
    return {
        "kind": trial.kind,
        "repeat": trial.repeat,
        "views": len(calibration.views),
        "promised_px": calibration.uncertainty_px,
        "came_px": projection_diff_px(PAPER_CAMERA, calibration.camera),
    }


def method_rows(trial: BenchTrial) -> list[Row]:
    """A row for each view: the true quality of the poses, the predicted and the actual gain.
    Gains are drops of the expected mean projection error as computed by the engine."""
    rows: list[Row] = []
    promised = before = float("nan")
    settings = Settings(method=cast(Method, trial.kind))
    for stage in guided_calibrations(settings, VIEWS, seed=trial.seed, repeat=trial.repeat):
        error = stage.outcome.history[-1].uncertainty_px
        rows.append(
            {
                "kind": trial.kind,
                "repeat": trial.repeat,
                "views": len(stage.poses),
                "projection_variance": true_error_px(Board(), stage.poses) ** 2,
                "promised_gain": before - promised,
                "gain": before - error,
            }
        )
        next_one = stage.outcome.suggestion
        before = error
        promised = float("nan") if next_one is None else next_one.target.predicted_uncertainty_px
    return rows


def state_row(trial: BenchTrial) -> Row:
    """The result of `global` on one state, and the best of long runs of dual annealing."""
    settings, views = Settings(), trial.repeat + 2
    *_, last = guided_calibrations(settings, views, seed=trial.seed, repeat=trial.repeat)
    posterior = last.outcome.posterior
    space = Space.of(posterior, settings)
    cost = make_cost("projection-variance", posterior)

    def found(strategy: Any, chance: int, budget: int | None) -> float:
        rng = np.random.default_rng([trial.seed, trial.repeat, chance])
        return search(strategy, space, cost, rng, budget=budget).cost

    long_runs = [found("dual-annealing", 1 + n, LONG_BUDGET) for n in range(LONG_RUNS)]
    return {
        "kind": trial.kind,
        "repeat": trial.repeat,
        "views": views,
        "global_cost": found("global", 0, None),
        "best_cost": min(long_runs),
    }


def judged(rows: Sequence[Row]) -> list[Bar]:
    """The claims about accuracy, from the trials' rows."""
    states = [row for row in rows if row["kind"] == "state"]
    above = np.array([float(row["global_cost"]) / float(row["best_cost"]) for row in states])
    variance = {kind: _by_repeat(rows, kind, "projection_variance") for kind in ("venus", "global")}
    ratio = variance["global"][:, 5] / variance["venus"][:, 5]
    reached = variance["global"] <= variance["venus"][:, -1:]
    needed = np.where(reached.any(axis=1), reached.argmax(axis=1) + 1, np.inf)
    gains = _by_repeat(rows, "global", "gain") / _by_repeat(rows, "global", "promised_gain")
    gains = gains[np.isfinite(gains)]
    middle = float(np.median(gains))
    return [
        _bar("projection variance after 6 views, global over venus", ratio, 1 / 6),
        _bar("views of global for venus' level at 14", needed, 5),
        Bar(
            f"states of {len(states)} in which global is within 5 % of long dual annealing",
            float(np.sum(above <= 1.05)),
            ">= 9",
            bool(np.sum(above <= 1.05) >= 9),
        ),
        Bar(
            "gain of a view over its promise",
            middle,
            "0.8 ... 1.25",
            0.8 <= middle <= 1.25,
            _quartiles(gains),
        ),
        _promise(rows, "shared", "errors that a view's corners share"),
        _promise(rows, "rendered", "pictures with a bow, a shift and a blur anew in each"),
    ]


def _promise(rows: Sequence[Row], kind: str, what: str) -> Bar:
    """How the errors of a kind of recordings compare with the uncertainty promised."""
    mine = [row for row in rows if row["kind"] == kind]
    came = np.array([float(row["came_px"]) / float(row["promised_px"]) for row in mine])
    # Of the squares' means: the promise is an rms.
    kept = float(np.sqrt(np.mean(came**2)))
    name = f"error over the uncertainty promised, {what}: root mean square"
    return Bar(name, kept, "0.8 ... 1.25", 0.8 <= kept <= 1.25, _quartiles(came))


def bench_table(bars: Sequence[Bar]) -> str:
    """The claims as a readable table."""
    lines: list[list[str]] = []
    for bar in bars:
        spread = "–" if bar.quartiles is None else "–".join(map(_figure, bar.quartiles))
        lines.append([bar.name, _figure(bar.value), spread, bar.bar, "yes" if bar.ok else "NO"])
    return table(["what", "median", "quartiles", "bar", "met"], lines)


def _figure(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def _by_repeat(rows: Sequence[Row], kind: str, column: str) -> Array:
    """(repeats, views) of a column of a method's rows."""
    values = [float(row[column]) for row in rows if row["kind"] == kind]
    return np.array(values).reshape(-1, VIEWS)


def _bar(name: str, values: Array, bar: float, *, least: bool = False) -> Bar:
    """A median against a bar as an upper limit or, with `least`, a lower one."""
    value = float(np.median(values))
    ok = value >= bar if least else value <= bar
    return Bar(name, value, f"{'>=' if least else '<='} {bar:.4g}", ok, _quartiles(values))


def _quartiles(values: Array) -> tuple[float, float]:
    low, high = np.quantile(values, [0.25, 0.75], method="nearest")
    return float(low), float(high)


# -- speed -----------------------------------------------------------------------------------------


def candidate_speed(seed: int) -> Bar:
    """One candidate's cost in a batch of 1000 against one hypothetical calibration, 8 views."""
    scene = _Scene(seed, views=8)
    batch = np.array([random_pose(scene.space, scene.rng) for _ in range(1000)])
    ratios = _ratios(scene.calibrate, lambda: scene.cost(batch)) * len(batch)
    return _bar("candidate's cost: times faster than a calibration", ratios, 300, least=True)


def suggestion_speed(seed: int) -> tuple[Bar, Bar]:
    """One `global` search at 12 views, in hypothetical calibrations, and its number of poses."""
    scene = _Scene(seed, views=12)
    looked: list[int] = []

    def suggestion() -> None:
        rng = np.random.default_rng([seed, len(looked)])
        looked.append(search("global", scene.space, scene.cost, rng).evaluated)

    ratios = _ratios(suggestion, scene.calibrate)
    return (
        _bar("global suggestion: time in calibrations", ratios, 5),
        _bar("global suggestion: candidates looked at", np.array(looked), 3000, least=True),
    )


class _Scene:
    """Views of the paper's camera, with the input for a search of the next one."""

    def __init__(self, seed: int, views: int) -> None:
        self.rng = np.random.default_rng(seed)
        board, camera = Board(), PAPER_CAMERA
        self.space = Space(board, camera, Limits.for_board(board, camera))
        vectors = np.array([random_pose(self.space, self.rng) for _ in range(views + 1)])
        poses = [Pose.from_vector(vector) for vector in vectors]
        seen = [observed(camera, board, pose, self.rng) for pose in poses]
        self._objects: Any = [board.points_of(o.ids).astype(np.float32) for o in seen]
        self._images: Any = [o.corners.astype(np.float32) for o in seen]
        posterior = Posterior(board, camera, true_information(board, poses[:views]), NOISE_PX)
        self.cost = make_cost("projection-variance", posterior)

    def calibrate(self) -> None:
        """A hypothetical calibration with one more view, by OpenCV alone."""
        cv2.calibrateCamera(self._objects, self._images, PAPER_CAMERA.image_size, None, None)  # type: ignore[call-overload]


def _ratios(one: Callable[[], Any], other: Callable[[], Any]) -> Array:
    """Ratio of two times, measured alternately so that both see the same machine load."""
    for first in (one, other):  # warm up caches
        first()
    return np.array([_seconds(one) / _seconds(other) for _ in range(TIMINGS)])


def _seconds(work: Callable[[], Any]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began

"""Table 1 of the paper on real recordings: number of views and accuracy of each method.

One trial: a part of the pool is held out by seed; a method asks for poses, gets the nearest unused
real view, calibrates, and stops at convergence. The methods run through the product's own session.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.calibration import Calibration
from venus3d.engine.calibration.projection_uncertainty import projection_diff_px
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.convergence import MIN_VIEWS
from venus3d.engine.guidance.session import Session
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.guidance.startup import Startup
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.settings import Method
from venus3d.study.pool import ViewPool, nearest, split
from venus3d.study.runner import Row
from venus3d.study.text import mean_sd, table

Arm = Literal["pose-selection", "opencv", "venus", "global", "best-view"]
ARMS: tuple[Arm, ...] = ("pose-selection", "opencv", "venus", "global", "best-view")
"""In the paper's order. "opencv": random views of the pool, no guidance. "best-view": takes the
unused view that minimises the expected projection error, without asking for a pose; the best that
the pool could give."""
_ASKING = ("pose-selection", "venus", "global")
Ending = Literal["converged", "pool empty", "enough views", "no pose fits"]

PAPER = {
    "pose-selection": (0.4331, 8.8, 0.5139),
    "opencv": (0.62253, 9.0, 0.43771),
    "venus": (0.4086, 7.8, 0.4704),
}
"""Rms test, frames used, rms train: Table 1."""


@dataclass(frozen=True, eq=False)
class Table1Trial:
    """One method on one pool with one seed. Trials of the same seed share the held-out views."""

    pool: ViewPool
    arm: Arm
    seed: int
    held_out: float = 0.3
    """Share of the pool held out for the test."""
    max_views: int = 40
    """Upper limit of the number of views, converged or not."""

    @property
    def key(self) -> str:
        """Unique in a study."""
        return f"{self.pool.name}/{self.arm}/{self.seed}"


@dataclass(frozen=True, eq=False)
class TakenView:
    """One view that a method took from the pool, and the calibration with it."""

    index: int
    """Index in the pool's views."""
    off_deg: float
    """Turn between the requested pose and the view's, degrees; NaN without a request."""
    calibration: Calibration
    uncertainty_px: float
    """Mean projection error over the image expected from the covariance, pixels; NaN while
    parameters are held fixed."""


def run_table1(trial: Table1Trial) -> list[Row]:
    """A row for each view taken; the last says in "ended" why the method stopped."""
    pool = trial.pool
    training, held_out = split(
        len(pool.observations), np.random.default_rng([trial.seed, 0]), trial.held_out
    )
    taken, ending = guide_through(pool, training, trial.arm, trial.seed, trial.max_views)
    rows: list[Row] = []
    for step in taken:
        camera = step.calibration.camera
        # Rounded: the last digits depend on the memory layout, not on the seed.
        measured = {
            "rms_train_px": step.calibration.rms_px,
            "rms_test_px": rms_of_views_px(camera, pool, held_out),
            "expected_uncertainty_px": step.uncertainty_px,
            "true_error_px": (
                np.nan if pool.truth is None else projection_diff_px(pool.truth, camera)
            ),
            "fx": camera.fx,
            "fy": camera.fy,
            "cx": camera.cx,
            "cy": camera.cy,
            "off_deg": step.off_deg,
        }
        rows.append(
            {
                "source": pool.name,
                "method": trial.arm,
                "seed": trial.seed,
                "pool": len(training),
                "held_out": len(held_out),
                "views": len(step.calibration.views),
                "view": pool.observations[step.index].name,
                "ended": ending if step is taken[-1] else "",
                **{name: round(float(value), 5) for name, value in measured.items()},
            }
        )
    return rows


def guide_through(
    pool: ViewPool, training: Sequence[int], arm: Arm, seed: int, max_views: int = 40
) -> tuple[list[TakenView], Ending]:
    """Calibrate from the views `training` of the pool that the method asks for.

    The first view is the one nearest to the start-up pose of 3.1, for "opencv" a random one. Raises
    `CalibrationError` if no view of the pool can be calibrated from.
    """
    method: Method = arm if arm in _ASKING else "random"
    settings = Settings(
        method=method,
        seed=seed,
        auto_capture=False,
        max_views=max_views,
        limits=pool.asking,
        wanted_uncertainty_px=None,  # no forecast needed
    )
    session = Session(pool.board, pool.image_size, settings)
    rng = np.random.default_rng([seed, 1])
    unused, taken = list(training), list[TakenView]()
    wanted: Pose | None = Startup(pool.board, pool.image_size).target
    while unused and session.phase not in ("converged", "finished"):
        chosen = _chosen(pool, unused, arm, wanted, session, rng)
        if chosen is None:
            break
        index, off_deg = chosen
        unused.remove(index)
        session.observe(pool.observations[index])
        if not session.capture():
            continue  # no board pose under the current camera
        session.run_pending()
        snapshot = session.snapshot()
        wanted = None if snapshot.target is None else snapshot.target.pose
        if snapshot.calibration is not None:
            uncertainty_px = snapshot.history[-1].uncertainty_px
            taken.append(TakenView(index, off_deg, snapshot.calibration, uncertainty_px))
    if not taken:
        raise CalibrationError(f"No view of {pool.name} can be calibrated from.")
    return taken, _ending(session, wanted, arm)


def _chosen(
    pool: ViewPool,
    unused: Sequence[int],
    arm: Arm,
    wanted: Pose | None,
    session: Session,
    rng: np.random.Generator,
) -> tuple[int, float] | None:
    """The next view, and its turn from the requested pose, degrees; NaN without a request."""
    calibration = session.snapshot().calibration
    if arm == "opencv":
        return int(rng.choice(list(unused))), float("nan")
    if arm == "best-view" and calibration is not None:
        return _most_telling(pool, unused, calibration), float("nan")
    if wanted is None:
        return None
    limits = replace(Limits.for_board(pool.board, session.camera), **pool.asking)
    found = nearest(wanted, pool, unused, session.camera, limits)
    return None if found is None else (found[0], wanted.angle_to_deg(found[1]))


def _most_telling(pool: ViewPool, unused: Sequence[int], calibration: Calibration) -> int:
    """The view that would minimise the expected projection error."""
    posterior = Posterior.of_calibration(calibration, noise=None)

    def uncertainty_px(index: int) -> float:
        view = pool.observations[index]
        pose = estimate_pose(posterior.camera, pool.board, view)
        return np.inf if pose is None else posterior.with_observation(view, pose).uncertainty_px

    return min(unused, key=uncertainty_px)


def _ending(session: Session, wanted: Pose | None, arm: Arm) -> Ending:
    if session.phase == "converged":
        return "converged"
    if session.phase == "finished":
        return "enough views"
    return "no pose fits" if wanted is None and arm in _ASKING else "pool empty"


def rms_of_views_px(camera: Camera, pool: ViewPool, indices: Sequence[int]) -> float:
    """Rms reprojection distance over all corners of the views `indices`, pixels. Each view has its
    best pose under this camera; inf if one has no pose, so that a camera is not rewarded for it."""
    squares: list[Array] = []
    for index in indices:
        view = pool.observations[index]
        pose = estimate_pose(camera, pool.board, view)
        if pose is None:
            return float("inf")
        error = view.corners - camera.project(pose.apply(pool.board.points_of(view.ids)))
        squares.append((error**2).sum(axis=1))
    return float(np.sqrt(np.concatenate(squares).mean()))


def table1_trials(
    pools: Sequence[ViewPool], repeats: int, seed: int, held_out: float, max_views: int
) -> list[Table1Trial]:
    """All methods on all pools, `repeats` seeds each."""
    return [
        Table1Trial(pool, arm, seed + k, held_out, max_views)
        for pool in pools
        for k in range(repeats)
        for arm in ARMS
    ]


def table1_text(rows: Sequence[Row], pools: Sequence[ViewPool]) -> str:
    """A readable table per source, the paper's figures beside ours."""
    parts: list[str] = []
    for pool in pools:
        mine = [row for row in rows if row["source"] == pool.name]
        lines = [
            _line(arm, of_arm)
            for arm in ARMS
            if (of_arm := [row for row in mine if row["method"] == arm])
        ]
        head = mine[0]
        seeds = len({row["seed"] for row in mine})
        parts.append(
            f"{pool.name}: {pool.frames} frames, {len(pool.observations)} distinct views; "
            f"{head['pool']} to choose from, {head['held_out']} held out; "
            f"{seeds} seeds, mean ± standard deviation"
        )
        parts.append(table(_HEADINGS, lines))
    return "\n\n".join(parts)


_HEADINGS = (
    "method",
    "rms test (px)",
    "views used",
    "rms train (px)",
    "expected error (px)",
    "true error (px)",
    "fx (px)",
    "converged",
    f"rms test at {MIN_VIEWS} views",
    "asked - got (°)",
    "paper: test, views, train",
)

_MEANS = {
    "rms_test_px": 4,
    "views": 1,
    "rms_train_px": 4,
    "expected_uncertainty_px": 2,
    "true_error_px": 2,
    "fx": 1,
}
"""Columns of a method's last rows that are averaged, and their digits."""


def _line(arm: Arm, rows: Sequence[Row]) -> tuple[str, ...]:
    last = [row for row in rows if row["ended"]]
    equal = [row for row in rows if row["views"] == MIN_VIEWS]
    converged = sum(row["ended"] == "converged" for row in last)
    return (
        arm,
        *(mean_sd(_column(last, name), digits) for name, digits in _MEANS.items()),
        f"{converged} of {len(last)}",
        mean_sd(_column(equal, "rms_test_px"), 4),
        f"{np.mean(_column(rows, 'off_deg')):.0f}" if arm in _ASKING else "-",
        "{:.4f}, {:.1f}, {:.4f}".format(*PAPER[arm]) if arm in PAPER else "-",
    )


def _column(rows: Sequence[Row], name: str) -> list[float]:
    return [float(row[name]) for row in rows]

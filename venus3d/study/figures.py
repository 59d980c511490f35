"""Figures 6 to 9 of the paper and a tenth: which arm wins, and from how many views on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import t as student

from venus3d import __version__
from venus3d.engine.geometry.pose import Array
from venus3d.engine.planning.limits import Mask
from venus3d.sources.sim_cameras import SimCamera
from venus3d.study.runner import Row, run_trials
from venus3d.study.simulated import ARMS, ArmTrial, run_arm
from venus3d.study.text import table

INDICATORS: Mapping[str, str] = {
    "sum_iod": "SumIOD",
    "abs_rms_err_px": "AbsRmsErr",
    "abs_rms_err_rotated_px": "AbsRmsErr, rotation removed",
    "rms_err_px": "RmsErr",
    "true_projection_error_px": "Expected error",
}
_PAPER_ALWAYS = ("sum_iod", "abs_rms_err_px")
FIRST_VIEWS = 2
"""Least number of views at which all parameters are estimated."""
CONFIDENCE = 0.95
_LEGEND = """\
"Smaller, from n views on": paired over the repeats, the 95 % interval of the mean difference of the
logarithms excludes equality at n views and at every later number. The ratio is the second arm's
value to the first's at the last view (geometric mean, 95 % interval), the scatter that of their
standard deviations of the logarithm (from 6 views on). "Expected error" is what the poses leave at
the true camera and noise, mean over the image: no estimate is in it."""


@dataclass(frozen=True)
class Figure:
    """Two arms, and the paper's claim about them."""

    number: int
    title: str
    arms: tuple[str, str]
    claim: str
    winner: str
    """The better arm according to the paper; empty if it makes no claim."""
    from_views: int = 20
    """The number of views from which, at the latest, it is better according to the paper."""
    steadier: bool = False
    """Whether the claim is less scatter rather than a smaller value."""
    told_by: tuple[str, ...] = _PAPER_ALWAYS
    """The indicators shown in the paper."""
    also: tuple[str, ...] = ("abs_rms_err_rotated_px", "true_projection_error_px")
    """Further indicators, to make four."""

    @property
    def indicators(self) -> tuple[str, ...]:
        """Four keys of `INDICATORS`."""
        return (*self.told_by, *self.also)


FIGURES = (
    Figure(
        6,
        "Does searching help? Random poses, with and without a search",
        ("random", "random-rms"),
        "the search lowers uncertainty and reprojection error",
        "random-rms",
    ),
    Figure(
        7,
        "What should the search make small? RmsErr or MaxIOD",
        ("random-rms", "random-max-iod"),
        "IOD as a loss scatters less",
        "random-max-iod",
        steadier=True,
    ),
    Figure(
        8,
        "Where should the search start? At random or at a generated pose",
        ("random-rms", "generated-rms"),
        "a generated start is far better",
        "generated-rms",
    ),
    Figure(
        9,
        "The paper against its forerunner: Pose selection and Pose search",
        ("pose-selection", "venus"),
        "Pose search is better under all three indicators beyond 5 views",
        "venus",
        from_views=6,
        told_by=(*_PAPER_ALWAYS, "rms_err_px"),
        also=("abs_rms_err_rotated_px",),
    ),
    Figure(
        10,
        "The whole pose space at once: the paper's search and global",
        ("venus", "global"),
        "",
        "",
    ),
)

OTHER_CAMERAS = (
    Figure(
        11,
        "Guided or not: random poses and global",
        ("random", "global"),
        "",
        "",
    ),
    Figure(
        12,
        "Pose selection and global",
        ("pose-selection", "global"),
        "",
        "",
    ),
)
"""For cameras that the paper has not."""


def figures_of(camera: SimCamera) -> tuple[Figure, ...]:
    """The figures that are drawn for a simulated camera."""
    return FIGURES if camera == "webcam" else OTHER_CAMERAS


@dataclass(frozen=True)
class Verdict:
    """The winner by one indicator of one figure."""

    figure: Figure
    indicator: str
    winner: str
    """Empty if neither wins by the last view."""
    since: int
    """From this number of views on, to the end; 0 without a winner."""
    ratio: float
    """Second arm's value over the first's at the last view, geometric mean."""
    interval: tuple[float, float]
    """Of the ratio, 95 %, over the paired repeats."""
    scatter: float
    """Second arm's scatter over the first's: standard deviations of ln over the repeats, mean from
    6 views on."""

    @property
    def agrees(self) -> str:
        """Whether this agrees with the paper, in a word or two; "–" without a claim."""
        figure = self.figure
        if not figure.winner or self.indicator not in figure.told_by:
            return "–"
        if figure.steadier:
            return "yes" if self.scatter < 1 else "no"
        if not self.winner:
            return "not shown"
        if self.winner != figure.winner:
            return "the reverse"
        return "yes" if self.since <= figure.from_views else f"only from {self.since} on"


def run_figures(
    rows_file: Path,
    *,
    views: int,
    repeats: int,
    seed: int,
    camera: SimCamera = "webcam",
    jobs: int | None = None,
    dask: str | None = None,
) -> list[Row]:
    """Run all arms of a camera's figures, each once; rows as `run_arm` makes them, in one file."""
    arms = tuple(dict.fromkeys(arm for figure in figures_of(camera) for arm in figure.arms))
    # The slow arms first, or the last of them would run alone at the end.
    ordered = sorted(arms, key=lambda arm: ARMS[arm].settings.cost != "rms")
    trials = [
        ArmTrial(arm, repeat, seed, views, camera) for arm in ordered for repeat in range(repeats)
    ]
    of_camera = "" if camera == "webcam" else f" of {camera}"
    return run_trials(
        run_arm,
        trials,
        rows_file,
        setup=f"venus3d {__version__}: figures{of_camera} with seed {seed} and {views} views",
        jobs=jobs,
        dask=dask,
        label="figures",
    )


def logarithms(rows: Iterable[Row], arm: str, indicator: str) -> Array:
    """(repeats, views) natural logarithms of an indicator; NaN where unknown."""
    chosen = [row for row in rows if row["arm"] == arm]
    repeats = len({row["repeat"] for row in chosen})
    values = np.array([float(row[indicator]) for row in chosen]).reshape(repeats, -1)
    return np.log(values)


def judge_figure(rows: Sequence[Row], figure: Figure) -> list[Verdict]:
    """A verdict for each indicator."""
    return [_verdict(rows, figure, indicator) for indicator in figure.indicators]


def _verdict(rows: Sequence[Row], figure: Figure, indicator: str) -> Verdict:
    first, second = (logarithms(rows, arm, indicator) for arm in figure.arms)
    low, high = _interval(second - first)
    # A winner leads at every number of views from some one on: the interval excludes equality.
    won = {figure.arms[1]: _since(high < 0), figure.arms[0]: _since(low > 0)}
    winner, since = min(
        ((arm, views) for arm, views in won.items() if views), default=("", 0), key=lambda w: w[1]
    )
    last = second[:, -1] - first[:, -1]
    steady = slice(min(5, first.shape[1] - 1), None)
    spread = [np.nanstd(values[:, steady], axis=0).mean() for values in (second, first)]
    return Verdict(
        figure,
        indicator,
        winner,
        since,
        float(np.exp(np.nanmean(last))),
        (float(np.exp(low[-1])), float(np.exp(high[-1]))),
        float(spread[0] / spread[1]) if spread[1] > 0 else float("nan"),
    )


def _interval(differences: Array) -> tuple[Array, Array]:
    """(views,) lower and upper ends of the mean difference, Student's t over the repeats."""
    known = np.isfinite(differences)
    count = known.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        total = np.where(known, differences, 0.0)
        mean = total.sum(axis=0) / count
        variance = (np.where(known, differences - mean, 0.0) ** 2).sum(axis=0) / (count - 1)
        half = student.ppf((1 + CONFIDENCE) / 2, np.maximum(count - 1, 1)) * np.sqrt(
            variance / count
        )
    return mean - half, mean + half


def _since(leads: Mask) -> int:
    """The number of views from which somebody leads to the end; 0 if not at the end."""
    behind = np.flatnonzero(~leads)
    since = int(behind[-1]) + 2 if behind.size else 1
    return since if since <= len(leads) else 0


def verdicts_text(rows: Sequence[Row], camera: SimCamera = "webcam") -> str:
    """A camera's figures in Markdown: the arms, the paper's claim, and the winner."""
    figures = [_figure_text(figure, judge_figure(rows, figure)) for figure in figures_of(camera)]
    return "\n\n".join([_LEGEND, *figures])


def _figure_text(figure: Figure, verdicts: Sequence[Verdict]) -> str:
    first, second = (ARMS[arm].label for arm in figure.arms)
    claim = f"The paper: {figure.claim}." if figure.claim else "The paper has no such pair."
    headings = ["indicator", "smaller", f"{second} : {first}", "scatter", "as the paper"]
    cells = [_cells(verdict) for verdict in verdicts]
    return f"**Figure {figure.number}. {figure.title}.** {claim}\n\n{table(headings, cells)}"


def _cells(verdict: Verdict) -> list[str]:
    won = "neither"
    if verdict.winner:
        won = f"{ARMS[verdict.winner].label}, from {verdict.since} views on"
    low, high = verdict.interval
    sure = f" ({low:.2g} to {high:.2g})" if np.isfinite([low, high]).all() else ""
    return [
        INDICATORS[verdict.indicator],
        won,
        f"{verdict.ratio:.2f}{sure}",
        f"{verdict.scatter:.2f}" if np.isfinite(verdict.scatter) else "–",
        verdict.agrees,
    ]

"""When the parameters have settled: eqs (16) and (17), as printed and repaired (3.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from venus3d.engine.geometry.pose import Array

Rule = Literal["repaired", "printed"]
MIN_VIEWS = 6
"""The repaired rule gives no verdict from fewer views.

Nine parameters and six more per view are estimated from few views; until then the residual noise,
which scales every sigma, is itself known only roughly and a ratio near 1 is easily chance.
"""


@dataclass(frozen=True, eq=False)
class Convergence:
    """Eqs (16), (17) per parameter."""

    ratio: Array
    """(9,) variance now over variance before; NaN where there is no before."""
    parameters: tuple[bool, ...]
    """(9,) which have converged."""
    rule: Rule

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
    uncertainty_px: float
    """Mean projection error over the image that the covariance predicts, pixels."""
    predicted_sigma: Array = field(default_factory=lambda: np.full(9, np.nan))
    """(9,) what the last view's target had promised; NaN if it was not taken at a target."""
    predicted_uncertainty_px: float = float("nan")
    """What the last view's target had promised for `uncertainty_px`; NaN likewise."""


def check_convergence(
    history: Sequence[Progress],
    epsilon: float = 0.1,
    rule: Rule = "repaired",
    min_views: int = MIN_VIEWS,
) -> Convergence:
    """Which parameters have converged after the last calibration in `history`.

    "printed" is eqs (16), (17) to the letter, `1 - sigma^2_(n+1) / sigma^2_n <= epsilon`, looking
    at the last two calibrations only. It also calls a parameter converged whose variance grew.

    "repaired" asks `0 <= 1 - sigma_(n+1) / sigma_n < epsilon` of the standard deviations, so that a
    variance that grew is not converged, gives no verdict before `min_views` views, and keeps a
    parameter's verdict once reached, as Rojtberg's program does: later views are chosen for the
    other parameters and may move it a little either way.
    """
    unknown = np.full(9, np.nan)
    if len(history) < 2:
        return Convergence(unknown, (False,) * 9, rule)
    ratio = _ratio(history[-2], history[-1])
    if rule == "printed":
        with np.errstate(invalid="ignore"):
            reached = 1 - ratio <= epsilon
        return Convergence(ratio, tuple(bool(v) for v in reached), rule)
    reached = np.zeros(9, dtype=bool)
    for before, after in pairwise(history):
        if after.views >= min_views:
            with np.errstate(invalid="ignore"):
                drop = 1 - np.sqrt(_ratio(before, after))
                reached |= (drop >= 0) & (drop < epsilon)
    return Convergence(ratio, tuple(bool(v) for v in reached), rule)


def _ratio(before: Progress, after: Progress) -> Array:
    """Eq. (16), (9,): NaN where a parameter was held fixed before or after (its sigma is 0)."""
    old, new = np.asarray(before.sigma) ** 2, np.asarray(after.sigma) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((old > 0) & (new > 0), new / old, np.nan)

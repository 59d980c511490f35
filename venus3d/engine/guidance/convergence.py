"""Convergence of the parameters: eqs (16) and (17), as printed and repaired (3.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

import numpy as np

from venus3d.engine.geometry.camera import PINHOLE_PARAMETERS
from venus3d.engine.geometry.lenses import BROWN5
from venus3d.engine.geometry.pose import Array

Rule = Literal["repaired", "printed"]
_BROWN5 = (*PINHOLE_PARAMETERS, *BROWN5.coefficient_names)
MIN_VIEWS = 6
"""The repaired rule gives no verdict from fewer views.
With few views the residual noise, which scales every sigma, is itself known only roughly, and a
ratio near 1 is easily chance."""


@dataclass(frozen=True, eq=False)
class Convergence:
    """Eqs (16), (17) per parameter."""

    ratio: Array
    """(p,) current variance over the previous one; NaN if there is none."""
    parameters: tuple[bool, ...]
    """(p,) whether each parameter has converged."""
    rule: Rule
    names: tuple[str, ...] = _BROWN5
    """(p,) of the parameters."""

    @property
    def converged(self) -> bool:
        """Whether all parameters have converged."""
        return all(self.parameters)

    @property
    def unsettled(self) -> tuple[str, ...]:
        """Names of the parameters that have not converged."""
        return tuple(n for n, done in zip(self.names, self.parameters, strict=True) if not done)


@dataclass(frozen=True, eq=False)
class Progress:
    """Summary of one calibration, for the plots over the session."""

    views: int
    rms_px: float
    parameters: Array
    """(p,) values."""
    sigma: Array
    """(p,) standard deviations."""
    uncertainty_px: float
    """Projection uncertainty over the image, pixels."""
    predicted_sigma: Array = field(default_factory=lambda: np.full(9, np.nan))
    """(p,) predicted by the last view's target; NaN if it was not taken at a target."""
    predicted_uncertainty_px: float = float("nan")
    """`uncertainty_px` as predicted by the last view's target; NaN likewise."""
    names: tuple[str, ...] = _BROWN5
    """(p,) of the parameters."""


def last_gain(history: Sequence[Progress]) -> tuple[float, float]:
    """Uncertainty before and after the last view, pixels; NaN where unknown. Both are, once an
    earlier view was dropped, since no calibration lacks just the last one."""
    nothing = float("nan"), float("nan")
    if not history or not np.isfinite(history[-1].uncertainty_px):
        return nothing
    before = history[-2] if len(history) > 1 else None
    if history[-1].views != (0 if before is None else before.views) + 1:
        return nothing
    return float("nan") if before is None else before.uncertainty_px, history[-1].uncertainty_px


def check_convergence(
    history: Sequence[Progress],
    epsilon: float = 0.1,
    rule: Rule = "repaired",
    min_views: int = MIN_VIEWS,
) -> Convergence:
    """Which parameters have converged after the last calibration in `history`.

    "printed" is eqs (16), (17) as they stand, `1 - sigma^2_(n+1) / sigma^2_n <= epsilon`, on the
    last two calibrations only. It also accepts a parameter whose variance grew.

    "repaired" requires `0 <= 1 - sigma_(n+1) / sigma_n < epsilon` of the standard deviations, so a
    grown variance is not convergence; gives no verdict before `min_views` views; and keeps a
    verdict once reached, as Rojtberg's program does: later views serve the other parameters and may
    move this one a little either way.
    """
    names = history[-1].names if history else _BROWN5
    if len(history) < 2:
        return Convergence(np.full(len(names), np.nan), (False,) * len(names), rule, names)
    ratio = _ratio(history[-2], history[-1])
    if rule == "printed":
        with np.errstate(invalid="ignore"):
            reached = 1 - ratio <= epsilon
        return Convergence(ratio, tuple(bool(v) for v in reached), rule, names)
    reached = np.zeros(len(names), dtype=bool)
    for before, after in pairwise(history):
        # A verdict on other parameters says nothing of these.
        if after.views >= min_views and after.names == names:
            with np.errstate(invalid="ignore"):
                drop = 1 - np.sqrt(_ratio(before, after))
                reached |= (drop >= 0) & (drop < epsilon)
    return Convergence(ratio, tuple(bool(v) for v in reached), rule, names)


def _ratio(before: Progress, after: Progress) -> Array:
    """Eq. (16), (p,): NaN if a parameter was held fixed before or after (its sigma is 0), and
    if the two are of different lenses."""
    if before.names != after.names:
        return np.full(len(after.names), np.nan)
    old, new = np.asarray(before.sigma) ** 2, np.asarray(after.sigma) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((old > 0) & (new > 0), new / old, np.nan)

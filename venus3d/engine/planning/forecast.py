"""Forecast of the views needed to reach a projection uncertainty, by planning them ahead.

Views are added to the current posterior greedily, each the best of a small search. The plan is only
for counting; the targets come from `suggest`, as each view changes the posterior.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from venus3d.engine.calibration.information import shared_share, view_information
from venus3d.engine.calibration.projection_uncertainty import projection_weight
from venus3d.engine.geometry.pose import Array, rotations_of
from venus3d.engine.planning.heuristic_poses import HeuristicState
from venus3d.engine.planning.pose_space import Space, nothing_fits
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.suggest import Planner

AHEAD = 10
"""Largest number of views planned ahead."""
CONFIDENCE = 0.9
"""Of the interval."""
# A plan's search: poses spread over the space once, then for each view rounds of ever closer
# neighbours of the best (standard deviations in the unit cube).
_SPREAD, _NEIGHBOURS, _PARENTS, _STRIDES = 512, 96, 16, (0.05, 0.03, 0.015)
_BUDGET = 1000
"""Poses per planned view for searches other than the annealing: the target waits for the forecast,
and scipy's would take half a minute."""
_BEHIND = 1.03
"""Factor by which a plan lies above the thorough search of the suggestions: 1.02 for the second
view, 1.03 to 1.04 from the fourth to the ninth."""


@dataclass(frozen=True)
class Forecast:
    """Number of further views to reach a projection uncertainty, if targets are followed."""

    wanted_px: float
    """Target projection uncertainty: rms over the image, pixels."""
    views: int | None
    """Views needed; 0 if reached; None if more than were planned ahead."""
    low: int | None
    """Lower end of the interval of about 90 %; None likewise."""
    high: int | None
    """Its upper end; None likewise."""
    looked_ahead: int
    """Number of views planned ahead."""


def forecast(
    planner: Planner,
    rng: np.random.Generator,
    *,
    wanted_px: float,
    degrees: int,
    state: HeuristicState | None = None,
    first: Array | None = None,
    ahead: int = AHEAD,
) -> Forecast | None:
    """Views needed until the projection uncertainty over the image is `wanted_px` or less.

    Args:
        planner: its `stop` is polled before each view.
        degrees: degrees of freedom of the residuals behind the posterior's `sigma_px`.
        state: of the rule, for methods that have one.
        first: (6,) the target already found; the plan begins with it.

    Returns None when stopped. Raises `VenusError` if no pose fits the limits.
    """
    best, worst = spread_of(degrees)
    uncertainties = [planner.posterior.uncertainty_px]
    if uncertainties[0] <= wanted_px:
        return Forecast(wanted_px, 0, 0, 0, 0)
    plan = _plan(replace(planner, views=(), stop=None, on_step=None), rng, state, first)
    while len(uncertainties) <= ahead and uncertainties[-1] * worst > wanted_px:
        if planner.stop is not None and planner.stop():
            return None
        uncertainties.append(next(plan))
    views, low, high = (_reached(uncertainties, factor, wanted_px) for factor in (1.0, best, worst))
    # The current uncertainty is too large, so at least one more view is needed.
    low = None if low is None else max(low, 1)
    return Forecast(wanted_px, views, low, high, len(uncertainties) - 1)


def spread_of(degrees: int) -> tuple[float, float]:
    """Factors (best, worst) on all planned uncertainties.
    From the uncertainty of the noise: `degrees * s^2 / sigma^2` is chi-square distributed."""
    count, tail = max(degrees, 1), (1 - CONFIDENCE) / 2
    best, worst = np.sqrt(count / chdtri(count, [tail, 1 - tail]))
    return float(best), float(worst)


def _reached(uncertainties: list[float], factor: float, wanted_px: float) -> int | None:
    reached = [views for views, value in enumerate(uncertainties) if value * factor <= wanted_px]
    return reached[0] if reached else None


def _plan(
    planner: Planner, rng: np.random.Generator, state: HeuristicState | None, first: Array | None
) -> Iterator[float]:
    """The uncertainties after one more view, after two, and so on."""
    settings, posterior = planner.settings, planner.posterior
    # The quick search minimises the projection variance; another cost leads to other poses.
    quick = settings.method == "global" and settings.search_cost == "projection-variance"
    poses = _Poses(posterior, planner.space, rng) if quick else None
    behind, budget = 1.0, None if settings.search_strategy in (None, "annealing") else _BUDGET
    while True:
        if first is not None:
            vector, first = first, None
        elif poses is not None:
            vector, behind = poses.best(posterior), _BEHIND
        else:
            found, _, state = replace(planner, posterior=posterior).find_pose(rng, state, budget)
            vector = found.vector
        posterior = posterior.with_view(vector)
        yield posterior.uncertainty_px / behind


class _Poses:
    """Poses of the space with the information of a view under each, computed once for all views."""

    def __init__(self, posterior: Posterior, space: Space, rng: np.random.Generator) -> None:
        self._start, self._space, self._rng = posterior, space, rng
        self._vectors, self._information = (
            np.empty((0, 6)),
            np.empty((0, *posterior.information.shape)),
        )
        self._add(rng.random((_SPREAD, 6)))

    def best(self, posterior: Posterior) -> Array:
        """(6,) the pose whose view leaves the least projection uncertainty."""
        variances = _variances(posterior, self._information)
        for stride in _STRIDES:
            parents = self._vectors[np.argsort(variances, kind="stable")[:_PARENTS]]
            around = np.repeat(self._space.to_unit(parents), _NEIGHBOURS // _PARENTS, axis=0)
            added = self._add(around + stride * self._rng.standard_normal(around.shape))
            variances = np.concatenate([variances, _variances(posterior, added)])
        # The next view chooses among the best ones, so that it takes no longer than this one.
        kept = np.argsort(variances, kind="stable")[:_SPREAD]
        self._vectors, self._information = self._vectors[kept], self._information[kept]
        return self._vectors[0]

    def _add(self, unit: Array) -> Array:
        """Add points (N, 6) of the unit cube; the information (K, p, p) of those in the space."""
        vectors, good = self._space.bring_inside(self._space.from_unit(unit))
        vectors, start = vectors[good], self._start
        if not len(vectors):
            if len(self._vectors):
                return np.empty((0, *start.information.shape))
            raise nothing_fits(self._space)
        camera, board = start.camera, start.board
        R, t = rotations_of(vectors), vectors[:, 3:]
        shared = shared_share(board, board.corners, start.shared_ratio)
        added = view_information(camera, board.corners, R, t, shared=shared)
        if start.noise is not None:
            added *= start.noise.weight(camera, board, vectors)[:, None, None]
        self._vectors = np.concatenate([self._vectors, vectors])
        self._information = np.concatenate([self._information, added])
        return added


def _variances(posterior: Posterior, information: Array) -> Array:
    """(N,) mean variance of a projected pixel, in units of a corner's, after a view of each of the
    informations (N, p, p)."""
    after = np.linalg.inv(posterior.information + information)
    return after.reshape(len(after), -1) @ projection_weight(posterior.camera).ravel()

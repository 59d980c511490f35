"""The next target: the method's pose, its purpose and the steps to it.

random           a valid random pose
pose-selection   Rojtberg's pose for the least certain parameter
venus            the paper's pose for that parameter, then Algorithm 1 (annealing)
global           a search of the whole pose space within the limits
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.adjustment import Calibration
from venus3d.engine.calibration.observation import View
from venus3d.engine.calibration.projection_uncertainty import projection_uncertainty_px
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.costs import CostFunction, make_cost, with_surcharge
from venus3d.engine.planning.heuristic_poses import (
    HeuristicPose,
    HeuristicState,
    paper_pose,
    rojtberg_pose,
    weakest_parameter,
)
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.search import search
from venus3d.engine.planning.search_trace import OnSearchStep, SearchResult, Stop
from venus3d.engine.planning.settings import Method, PlanningSettings
from venus3d.engine.planning.target import Target, held_in_words, reason_for, served

EFFORT = 0.02
"""Surcharge of a pose with all three angles at their ends over an upright one: poses within two per
cent are equal for the camera, but not for the person's wrists."""
AT_MOST = 3
"""Number of alternatives besides the best pose."""
DIFFERENT_DEG = 20.0
DIFFERENT_FRACTION = 0.2
NEARLY = 0.15
"""How much worse an alternative may be, as a share of the best pose's gain plus the uncertainty it
leaves; the latter for the first views, whose gains are large."""


@dataclass(frozen=True, eq=False)
class NextTarget:
    """The next target and the rule's state after it."""

    target: Target
    state: HeuristicState
    note: str = ""
    """How a generated pose was changed to fit the limits; empty if it was not."""


def suggest(
    calibration: Calibration,
    settings: PlanningSettings | None = None,
    *,
    number: int | None = None,
    skipped: Iterable[Pose] = (),
    rng: np.random.Generator | None = None,
    state: HeuristicState | None = None,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> Target:
    """The next pose for the calibration's board, its purpose, and the four steps to it.

    Args:
        settings: how it is found; None for the defaults: the method global.
        number: the target's number; None: one more than there are views.
        skipped: poses not to be offered again within 15 degrees and a tenth of the distance.
        rng: None: seeded with 0 and the number, as in a session with the seed 0.
        state, stop, on_step: see `next_target`.

    Raises `VenusError` for limits that leave no pose.
    """
    settings = settings or PlanningSettings()
    count = len(calibration.views) + 1 if number is None else number
    posterior = Posterior.of_calibration(calibration, settings.noise)
    return next_target(
        posterior,
        settings,
        Space.of(posterior, settings, skipped),
        np.random.default_rng([0, count]) if rng is None else rng,
        number=count,
        state=state,
        views=calibration.views,
        stop=stop,
        on_step=on_step,
    ).target


def next_target(
    posterior: Posterior,
    settings: PlanningSettings,
    space: Space,
    rng: np.random.Generator,
    *,
    number: int,
    state: HeuristicState | None = None,
    views: Sequence[View] = (),
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> NextTarget:
    """The next target in the `space`, with the rule's state after it.

    Args:
        number: the target's number.
        state: of the rule, for methods that have one.
        views: captured so far; only the cost "rms" needs their observations.
        stop, on_step: see `search`.

    Raises `VenusError` for limits that leave no pose.
    """
    began = time.perf_counter()
    found, generated, ended = find_pose(
        posterior, settings, space, rng, state=state, views=views, stop=stop, on_step=on_step
    )
    by_rule = settings.method == "pose-selection" and generated is not None
    others = tuple(
        target_at(posterior, settings, vector, number, evaluated=found.evaluated)
        for vector in nearly_equal(posterior, found.vector, found.elites)
    )
    target = target_at(
        posterior,
        settings,
        found.vector,
        number,
        aimed_at=generated.parameter if by_rule and generated else None,
        alternatives=others,
        evaluated=found.evaluated,
        began=began,
    )
    return NextTarget(target, ended, "" if generated is None else generated.note)


def find_pose(
    posterior: Posterior,
    settings: PlanningSettings,
    space: Space,
    rng: np.random.Generator,
    *,
    state: HeuristicState | None = None,
    views: Sequence[View] = (),
    budget: int | None = None,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> tuple[SearchResult, HeuristicPose | None, HeuristicState]:
    """The pose itself; what the method's rule made, if it was used; the rule's state after it.

    `budget`: approximate number of poses to evaluate; None: the search's default. Others as
    `next_target`.
    """
    strategy = settings.search_strategy
    begun = (state or HeuristicState()).observed(np.sqrt(np.diag(posterior.covariance)))
    # Only the annealing needs a start, and so a rule.
    ruled = strategy is None or (strategy == "annealing" and settings.start == "generated")
    made = _generated(settings.method, space, posterior.covariance, begun) if ruled else None
    ended = begun if made is None else made.state
    if strategy is None:
        vector = random_pose(space, rng) if made is None else made.vector
        return SearchResult(vector, float("nan"), 0, False), made, ended
    begin = None
    if strategy == "annealing":
        if made is not None and not space.accepts(made.vector)[0]:
            made = None
        begin = random_pose(space, rng) if made is None else made.vector
    found = search(
        strategy,
        space,
        _search_cost(settings, posterior, space, views, rng),
        rng,
        start=begin,
        budget=budget,
        stop=stop,
        on_step=on_step,
        keep_best=settings.keep_best,
    )
    return found, made, ended


def target_at(
    posterior: Posterior,
    settings: PlanningSettings,
    vector: Array,
    number: int,
    *,
    aimed_at: str | None = None,
    alternatives: tuple[Target, ...] = (),
    evaluated: int = 0,
    began: float | None = None,
) -> Target:
    """The complete target at a pose vector (6,).

    Args:
        aimed_at: the parameter that a rule aimed at; listed first whatever it gains.
        evaluated: number of poses evaluated.
        began: `time.perf_counter` when the search began.
    """
    camera, board = posterior.camera, posterior.board
    after = posterior.after(vector)[0]
    pose, serves = Pose.from_vector(vector), served(posterior.covariance, after, aimed_at)
    return Target(
        number=number,
        pose=pose,
        steps=decompose(pose, camera, board),
        method=settings.method,
        cost=settings.search_cost,
        serves=serves,
        reason=reason_for(serves, pose, camera, board),
        predicted_sigma=np.sqrt(np.diag(after)),
        predicted_uncertainty_px=projection_uncertainty_px(camera, after),
        evaluated=evaluated,
        search_s=0.0 if began is None else time.perf_counter() - began,
        uncertainty_px=posterior.uncertainty_px if posterior.settled else float("nan"),
        alternatives=alternatives,
        held=held_in_words(pose, camera),
    )


def _search_cost(
    settings: PlanningSettings,
    posterior: Posterior,
    space: Space,
    views: Sequence[View],
    rng: np.random.Generator,
) -> CostFunction:
    """The cost; for the method global with a small surcharge for turns (see `EFFORT`)."""
    observations = [view.observation for view in views]
    cost = make_cost(settings.search_cost, posterior, observations=observations, rng=rng)
    if settings.method != "global":
        return cost

    def effort(vectors: Array) -> Array:
        return EFFORT * np.abs(vectors[:, :3]).mean(axis=1) / space.limits.max_angle_deg

    return with_surcharge(cost, effort)


def _generated(
    method: Method, space: Space, covariance: Array, state: HeuristicState
) -> HeuristicPose | None:
    """The rule's next pose that was not skipped, or the eighth; None for methods without a rule."""
    if method not in ("venus", "pose-selection"):
        return None
    generate = paper_pose if method == "venus" else rojtberg_pose
    worst = weakest_parameter(space.camera, covariance, state.settled)
    made: HeuristicPose | None = None
    for _ in range(8):
        made = generate(space.board, space.camera, space.limits, worst, state)
        if space.accepts(made.vector)[0]:
            break
        state = made.state
    return made


def clearly_different(one: Pose, other: Pose) -> bool:
    """Whether two poses are obviously different to a person.
    By 20 degrees of turn, or by a fifth of the nearer one's distance in any direction."""
    nearer = min(float(np.linalg.norm(pose.t)) for pose in (one, other))
    apart = one.distance_to(other) >= DIFFERENT_FRACTION * nearer
    return apart or one.angle_to_deg(other) >= DIFFERENT_DEG


def nearly_equal(posterior: Posterior, best: Array, elites: Array) -> list[Array]:
    """The elites (K, 6) to offer besides the pose vector `best` (6,), best first (at most 3).

    Ranked by the projection uncertainty they leave, which is what the page shows, whatever the cost
    of the search. All are clearly different from `best` and from each other.
    """
    if not len(elites):
        return []
    uncertainties = np.array(
        [projection_uncertainty_px(posterior.camera, C) for C in posterior.after(elites)]
    )
    least = projection_uncertainty_px(posterior.camera, posterior.after(best)[0])
    allowed = least + NEARLY * min(max(posterior.uncertainty_px - least, 0.0), least)
    chosen, poses = list[Array](), [Pose.from_vector(best)]
    for i in np.argsort(uncertainties, kind="stable"):
        if uncertainties[i] > allowed or len(chosen) == AT_MOST:
            break
        pose = Pose.from_vector(elites[i])
        if all(clearly_different(pose, other) for other in poses):
            chosen.append(elites[i])
            poses.append(pose)
    return chosen

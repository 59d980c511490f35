"""The next target: the method's pose, its purpose and the steps to it.

random           a valid random pose
pose-selection   Rojtberg's pose for the least certain parameter
venus            the paper's pose for that parameter, then Algorithm 1 (annealing)
global           a search of the whole pose space within the limits
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.calibration.calibration import Calibration
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
from venus3d.engine.planning.settings import PlanningSettings
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
        state: of the rule, for methods that have one.
        stop, on_step: see `search`.

    Raises `VenusError` for limits that leave no pose.
    """
    settings = settings or PlanningSettings()
    count = len(calibration.views) + 1 if number is None else number
    posterior = Posterior.of_calibration(calibration, settings.noise)
    space = Space.of(posterior, settings, skipped, calibration.views)
    planner = Planner(posterior, settings, space, calibration.views, stop, on_step)
    rng = np.random.default_rng([0, count]) if rng is None else rng
    return planner.next_target(count, rng, state).target


@dataclass(frozen=True, eq=False)
class Planner:
    """Finds the pose after the views of a posterior. Raises `VenusError` where none is allowed."""

    posterior: Posterior
    settings: PlanningSettings
    space: Space
    views: Sequence[View] = ()
    """Captured so far; only the cost "rms" needs their observations."""
    stop: Stop | None = None
    on_step: OnSearchStep | None = None
    """Both: see `search`."""

    def next_target(
        self, number: int, rng: np.random.Generator, state: HeuristicState | None = None
    ) -> NextTarget:
        """The target with this number, from the rule's `state` and with the one after it."""
        began = time.perf_counter()
        found, made, ended = self.find_pose(rng, state)
        by_rule = made is not None and self.settings.method == "pose-selection"
        aimed_at = made.parameter if made is not None and by_rule else None
        others = nearly_equal(self.posterior, found.vector, found.elites)
        target = replace(
            self.target_at(found.vector, number, found.evaluated, aimed_at),
            alternatives=tuple(self.target_at(v, number, found.evaluated) for v in others),
            search_s=time.perf_counter() - began,
        )
        return NextTarget(target, ended, "" if made is None else made.note)

    def find_pose(
        self,
        rng: np.random.Generator,
        state: HeuristicState | None = None,
        budget: int | None = None,
    ) -> tuple[SearchResult, HeuristicPose | None, HeuristicState]:
        """The pose itself; what the method's rule made, if it was used; the rule's state after it.

        `budget`: approximate number of poses to evaluate; None: the search's default.
        """
        settings, space, strategy = self.settings, self.space, self.settings.search_strategy
        ended = (state or HeuristicState()).observed(
            np.sqrt(np.diag(self.posterior.covariance)), self.posterior.camera.parameter_names
        )
        made: HeuristicPose | None = None
        # Only the annealing needs a start, and so a rule.
        if strategy is None or (strategy == "annealing" and settings.start == "generated"):
            made = self._generated(ended)
            ended = ended if made is None else made.state
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
            self._cost(rng),
            rng,
            start=begin,
            budget=budget,
            stop=self.stop,
            on_step=self.on_step,
            keep_best=settings.keep_best,
        )
        return found, made, ended

    def target_at(
        self, vector: Array, number: int, evaluated: int = 0, aimed_at: str | None = None
    ) -> Target:
        """The complete target at a pose vector (6,), found among `evaluated` poses.
        The parameter that a rule `aimed_at` is listed first whatever it gains."""
        posterior, camera, board = self.posterior, self.posterior.camera, self.posterior.board
        after = posterior.after(vector)[0]
        pose, serves = (
            Pose.from_vector(vector),
            served(posterior.covariance, after, posterior.camera.parameter_names, aimed_at),
        )
        return Target(
            number=number,
            pose=pose,
            steps=decompose(pose, camera, board),
            method=self.settings.method,
            cost=self.settings.search_cost,
            serves=serves,
            reason=reason_for(serves, pose, camera, board),
            predicted_sigma=np.sqrt(np.diag(after)),
            predicted_uncertainty_px=projection_uncertainty_px(camera, after),
            evaluated=evaluated,
            search_s=0.0,
            uncertainty_px=posterior.uncertainty_px if posterior.settled else float("nan"),
            held=held_in_words(pose, camera),
        )

    def _cost(self, rng: np.random.Generator) -> CostFunction:
        """The cost; for the method global with a small surcharge for turns (see `EFFORT`)."""
        seen = [view.observation for view in self.views]
        cost = make_cost(self.settings.search_cost, self.posterior, observations=seen, rng=rng)
        if self.settings.method != "global":
            return cost

        def effort(vectors: Array) -> Array:
            return EFFORT * np.abs(vectors[:, :3]).mean(axis=1) / self.space.limits.max_angle_deg

        return with_surcharge(cost, effort)

    def _generated(self, state: HeuristicState) -> HeuristicPose | None:
        """The rule's next pose that was not skipped, or the eighth; None if there is no rule."""
        if self.settings.method not in ("venus", "pose-selection"):
            return None
        generate = paper_pose if self.settings.method == "venus" else rojtberg_pose
        covariance = self.posterior.covariance
        worst = weakest_parameter(self.space.camera, covariance, state.settled)
        made: HeuristicPose | None = None
        for _ in range(8):
            made = generate(self.space, worst, state)
            if self.space.accepts(made.vector)[0]:
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

"""The next target: the method finds a pose, and this says what it is for and how to get there.

random           a valid random pose
pose-selection   Rojtberg's pose for the parameter known worst
venus            the paper's pose for that parameter, then Algorithm 1 (annealing)
global           a search of the whole pose space within the limits
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.calibration.corner_noise import NoiseModel
from venus3d.engine.calibration.observation import View
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.alternatives import nearly_equal
from venus3d.engine.planning.costs import (
    CostFunction,
    make_cost,
    projection_uncertainty_px,
    with_surcharge,
)
from venus3d.engine.planning.heuristic_poses import (
    HeuristicPose,
    HeuristicState,
    paper_pose,
    rojtberg_pose,
    weakest_parameter,
)
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.method import (
    Cost,
    Method,
    SearchMethod,
    Start,
    Strategy,
    search_method,
)
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.engine.planning.posterior import Posterior
from venus3d.engine.planning.reasons import held_in_words, reason_for, served
from venus3d.engine.planning.search import OnSearchStep, SearchResult, Stop, search
from venus3d.engine.planning.target import Target

EFFORT = 0.02
"""A pose at the end of all three angles may be this much cheaper and still lose to an upright one.

Poses within two per cent of each other are equal for the camera, not for the person's wrists.
"""


@dataclass(frozen=True, eq=False)
class Suggestion:
    """The next target and the generators' state after it."""

    target: Target
    state: HeuristicState
    note: str = ""
    """How a generated pose had to be changed to stay within the limits; empty if it was not."""


def suggest(
    board: Board,
    camera: Camera,
    information: ArrayLike,
    sigma_px: float,
    *,
    method: Method = "global",
    cost: Cost | None = None,
    strategy: Strategy | None = None,
    start: Start = "generated",
    noise: NoiseModel | None = None,
    limits: Limits | None = None,
    rng: np.random.Generator,
    number: int,
    state: HeuristicState | None = None,
    views: Sequence[View] = (),
    skipped: Sequence[Pose] = (),
    keep_best: bool = False,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> Suggestion:
    """The next pose to hold the board in.

    Args:
        information: (9, 9) what the views so far say, for corner noise of one pixel.
        sigma_px: standard deviation of a corner coordinate, pixels.
        cost, strategy: None for the method's own (`DEFAULT_COST`, `DEFAULT_STRATEGY`).
        start: where the method venus begins to search: at its rule's pose or at a random one.
        noise: how noise and found corners depend on the pose; None: they do not.
        limits: None for `Limits.for_board`.
        number: the target's number.
        views: captured so far; only the cost "rms" needs their observations.
        skipped: poses not to be offered again within 15 degrees and a tenth of the distance.
        keep_best: let the annealing return the best pose it met, not the one it ends on.
        stop, on_step: see `search`.

    Raises `VenusError` for what `search_method` refuses, and for limits that leave no pose.
    """
    way = search_method(method, cost, strategy, start=start, keep_best=keep_best)
    began = time.perf_counter()
    posterior = Posterior.of(board, camera, information, sigma_px, noise)
    bounds = Limits.for_board(board, posterior.camera) if limits is None else limits
    space = Space(board, posterior.camera, bounds, tuple(skipped))
    found, generated, ended = find(
        way, posterior, space, rng, state=state, views=views, stop=stop, on_step=on_step
    )
    aimed_at = generated.parameter if method == "pose-selection" and generated else None
    others = tuple(
        target_at(posterior, way, vector, number, evaluated=found.evaluated)
        for vector in nearly_equal(posterior, found.vector, found.elites)
    )
    target = target_at(
        posterior,
        way,
        found.vector,
        number,
        aimed_at=aimed_at,
        alternatives=others,
        evaluated=found.evaluated,
        began=began,
    )
    return Suggestion(target, ended, "" if generated is None else generated.note)


def find(
    way: SearchMethod,
    posterior: Posterior,
    space: Space,
    rng: np.random.Generator,
    *,
    state: HeuristicState | None = None,
    views: Sequence[View] = (),
    budget: int | None = None,
    stop: Stop | None = None,
    on_step: OnSearchStep | None = None,
) -> tuple[SearchResult, HeuristicPose | None, HeuristicState]:
    """The pose itself; what the method's rule made, if that was used; the rule's state after it.

    `budget` is about how many poses to look at, None for the search's own. Others as `suggest`.
    """
    begun = (state or HeuristicState()).observed(np.sqrt(np.diag(posterior.covariance)))
    # Other searches than the annealing do not start anywhere: no rule is asked.
    ruled = way.strategy is None or (way.strategy == "annealing" and way.start == "generated")
    made = _generated(way.method, space, posterior.covariance, begun) if ruled else None
    ended = begun if made is None else made.state
    if way.strategy is None:
        vector = random_pose(space, rng) if made is None else made.vector
        return SearchResult(vector, float("nan"), 0, False), made, ended
    begin = None
    if way.strategy == "annealing":
        if made is not None and not space.accepts(made.vector)[0]:
            made = None
        begin = random_pose(space, rng) if made is None else made.vector
    found = search(
        way.strategy,
        space,
        _price(way, posterior, space, views, rng),
        rng,
        start=begin,
        budget=budget,
        stop=stop,
        on_step=on_step,
        keep_best=way.keep_best,
    )
    return found, made, ended


def target_at(
    posterior: Posterior,
    way: SearchMethod,
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
        aimed_at: the parameter that a rule aimed at; stands first whatever it gains.
        evaluated: poses looked at.
        began: `time.perf_counter` when the search began.
    """
    camera, board = posterior.camera, posterior.board
    after = posterior.after(vector)[0]
    pose, serves = Pose.from_vector(vector), served(posterior.covariance, after, aimed_at)
    return Target(
        number=number,
        pose=pose,
        steps=decompose(pose, camera, board),
        method=way.method,
        cost=way.cost,
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


def _price(
    way: SearchMethod,
    posterior: Posterior,
    space: Space,
    views: Sequence[View],
    rng: np.random.Generator,
) -> CostFunction:
    """The cost; for the method global with a tiny surcharge for the turns that a person has to
    make (see `EFFORT`)."""
    price = make_cost(
        way.cost,
        board=posterior.board,
        camera=posterior.camera,
        information=posterior.information,
        sigma_px=posterior.sigma_px,
        observations=[view.observation for view in views],
        rng=rng,
        noise=posterior.noise,
    )
    if way.method != "global":
        return price

    def effort(vectors: Array) -> Array:
        return EFFORT * np.abs(vectors[:, :3]).mean(axis=1) / space.limits.max_angle_deg

    return with_surcharge(price, effort)


def _generated(
    method: Method, space: Space, covariance: Array, state: HeuristicState
) -> HeuristicPose | None:
    """The rule's next pose that was not skipped; it gives up after eight and takes the last.

    None for methods without a rule.
    """
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

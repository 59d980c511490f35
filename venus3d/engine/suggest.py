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
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.board import Board
from venus3d.engine.camera import PARAMETERS, Camera, planning_camera
from venus3d.engine.costs import (
    CostFunction,
    make_cost,
    predicted_covariance,
    projection_error_px,
)
from venus3d.engine.decomposition import decompose
from venus3d.engine.errors import VenusError
from venus3d.engine.generation import (
    Generated,
    GenerationState,
    generate_paper,
    generate_rojtberg,
    weakest_parameter,
)
from venus3d.engine.information import covariance_of, prior_information
from venus3d.engine.limits import Limits
from venus3d.engine.observation import View
from venus3d.engine.pose import Array, Pose
from venus3d.engine.reasons import reason_for
from venus3d.engine.search import Found, Stop, Watch, anneal, search_globally
from venus3d.engine.snapshot import COSTS, METHODS, Cost, Method, Target
from venus3d.engine.space import Space, random_pose

DEFAULT_COST: dict[Method, Cost] = {
    "random": "projection-variance",
    "pose-selection": "projection-variance",
    "venus": "sum-iod",
    "global": "projection-variance",
}
"""A method's own cost. "random" and "pose-selection" search nothing: it only names what is told."""
EFFORT = 0.02
"""A pose at the end of all three angles may be this much cheaper and still lose to an upright one.

Poses within two per cent of each other are equal for the camera, not for the person's wrists.
"""


@dataclass(frozen=True, eq=False)
class Suggestion:
    """The next target and the generators' state after it."""

    target: Target
    state: GenerationState
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
    limits: Limits | None = None,
    rng: np.random.Generator,
    number: int,
    state: GenerationState | None = None,
    views: Sequence[View] = (),
    skipped: Sequence[Pose] = (),
    keep_best: bool = False,
    stop: Stop | None = None,
    on_move: Watch | None = None,
) -> Suggestion:
    """The next pose to hold the board in.

    Args:
        information: (9, 9) what the views so far say, for corner noise of one pixel.
        sigma_px: standard deviation of a corner coordinate, pixels.
        cost: None for the method's own (`DEFAULT_COST`).
        limits: None for `Limits.for_board`.
        number: the target's number.
        views: captured so far; only the cost "rms" needs their observations.
        skipped: poses not to be offered again within 15 degrees and a tenth of the distance.
        keep_best: let the annealing return the best pose it met, not the one it ends on.
        stop, on_move: see `search`.

    Raises `VenusError` for a method or cost that does not exist, a cost that the method cannot
    use, and limits that leave no pose.
    """
    chosen = _checked(method, cost)
    started = time.perf_counter()
    plan = planning_camera(camera)
    known = _with_prior(camera, np.asarray(information, dtype=np.float64), sigma_px)
    before = covariance_of(known, sigma_px)
    bounds = Limits.for_board(board, plan) if limits is None else limits
    space = Space(board, plan, bounds, tuple(skipped))
    begun = (state or GenerationState()).observed(np.sqrt(np.diag(before)))
    generated = _generated(method, space, before, begun)

    def price() -> CostFunction:
        seen = [view.observation for view in views]
        return make_cost(
            chosen,
            board=board,
            camera=plan,
            information=known,
            sigma_px=sigma_px,
            observations=seen,
            rng=rng,
        )

    if method == "global":
        cheap = _with_effort(space, price())
        found = search_globally(space, cheap, rng, stop=stop, on_move=on_move)
    elif method == "venus" and generated is not None:
        start = generated.vector
        if not space.accepts(start)[0]:
            start = random_pose(space, rng)
        found = anneal(space, price(), start, rng, keep_best=keep_best, stop=stop, on_move=on_move)
    else:
        vector = random_pose(space, rng) if generated is None else generated.vector
        found = Found(vector, float("nan"), 0, False)

    after = sigma_px**2 * predicted_covariance(board, plan, known, found.vector)[0]
    aimed_at = generated.parameter if method == "pose-selection" and generated else None
    serves = _served(before, after, aimed_at)
    pose = Pose.from_vector(found.vector)
    target = Target(
        number=number,
        pose=pose,
        steps=decompose(pose, plan, board),
        method=method,
        cost=chosen,
        serves=serves,
        reason=reason_for(serves, pose, plan, board),
        predicted_sigma=np.sqrt(np.diag(after)),
        predicted_error_px=projection_error_px(plan, after),
        evaluated=found.evaluated,
        search_s=time.perf_counter() - started,
    )
    ended, note = (begun, "") if generated is None else (generated.state, generated.note)
    return Suggestion(target, ended, note)


def _checked(method: Method, cost: Cost | None) -> Cost:
    if method not in METHODS:
        raise VenusError(f"There is no method {method!r}; use one of {', '.join(METHODS)}.")
    if cost is None:
        return DEFAULT_COST[method]
    if cost not in COSTS:
        raise VenusError(f"There is no cost {cost!r}; use one of {', '.join(COSTS)}.")
    if method in ("random", "pose-selection"):
        # Named nevertheless: harmless where it is the default, a misunderstanding elsewhere.
        if cost != DEFAULT_COST[method]:
            raise VenusError(
                f"The method {method} does not search, so the cost {cost} has no use there; "
                "leave the cost out or use the method venus or global."
            )
    elif method == "global" and cost == "rms":
        raise VenusError(
            "The cost rms calibrates anew for every pose and is too slow for the method global; "
            "use it with the method venus, or use projection-variance."
        )
    return cost


def _with_prior(camera: Camera, information: Array, sigma_px: float) -> Array:
    """The information, with the wide prior added while the views alone say less than it does."""
    prior = prior_information(camera, sigma_px)
    believed = sigma_px / np.sqrt(np.diag(prior))
    with np.errstate(all="ignore"):
        try:
            variance = np.diag(covariance_of(information, sigma_px))
        except np.linalg.LinAlgError:
            return information + prior
    settled = bool((variance > 0).all()) and bool((np.sqrt(variance) < believed).all())
    return information if settled else information + prior


def _generated(
    method: Method, space: Space, covariance: Array, state: GenerationState
) -> Generated | None:
    """The rule's next pose that was not skipped; it gives up after eight and takes the last.

    None for methods without a rule.
    """
    if method not in ("venus", "pose-selection"):
        return None
    generate = generate_paper if method == "venus" else generate_rojtberg
    worst = weakest_parameter(space.camera, covariance, state.settled)
    made: Generated | None = None
    for _ in range(8):
        made = generate(space.board, space.camera, space.limits, worst, state)
        if space.accepts(made.vector)[0]:
            break
        state = made.state
    return made


def _with_effort(space: Space, price: CostFunction) -> CostFunction:
    """The cost with a tiny surcharge for the turns a person has to make (see `EFFORT`)."""

    def cost(vectors: Array) -> Array:
        turns = np.abs(vectors[:, :3]).mean(axis=1) / space.limits.max_angle_deg
        return price(vectors) * (1 + EFFORT * turns)

    return cost


def _served(before: Array, after: Array, first: str | None) -> tuple[str, ...]:
    """The parameters whose sigma falls most, best first: at most three, all within 80 % of the
    largest relative drop. The parameter a rule aimed at stands first whatever it gains."""
    with np.errstate(divide="ignore", invalid="ignore"):
        drop = 1 - np.sqrt(np.diag(after) / np.diag(before))
    drop = np.nan_to_num(drop, nan=0.0)
    order = np.argsort(-drop, kind="stable")[:3]
    names = [PARAMETERS[i] for i in order if drop[i] >= 0.8 * drop[order[0]]]
    if first is not None:
        names = [first, *(name for name in names if name != first)][:3]
    return cast(tuple[str, ...], tuple(names))

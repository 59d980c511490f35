"""A trial's plan: the order of helps, the poses, and the times of each help."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.planning.limits import Limits
from venus3d.engine.planning.pose_space import Space, random_pose
from venus3d.scene.pages.exercise.view_model import TRIAL_HELPS, Help
from venus3d.storage.exercise import REACHED, ExerciseRow

# A Latin square and its mirror image: after three participants each help was first, second and
# third equally often, after six each followed each of the others equally often.
_ORDERS: tuple[tuple[int, int, int], ...] = (
    (0, 1, 2),
    (1, 2, 0),
    (2, 0, 1),
    (2, 1, 0),
    (0, 2, 1),
    (1, 0, 2),
)


@dataclass(frozen=True)
class Plan:
    """One participant's trial."""

    participant: str
    number: int
    """1 ...: in order of first appearance."""
    order: tuple[Help, ...]
    done: frozenset[Help] = frozenset()
    """Helps finished in an earlier run."""
    attempts: tuple[tuple[Help, int], ...] = ()
    """How often each help was started before."""

    def attempt(self, help_: Help) -> int:
        """1 ...: number of the next attempt."""
        return dict(self.attempts).get(help_, 0) + 1


@dataclass(frozen=True)
class HelpTimes:
    """The times of one help."""

    help: str
    ends_s: tuple[float, ...]
    """Finishing time of each pose in order, seconds since the first one's."""
    reached_s: tuple[float, ...]
    """Seconds for each reached pose, without the help's first one, which is for practice."""
    given_up: int
    """Number of poses given up."""


def order_of(number: int) -> tuple[Help, ...]:
    """The order of helps for participant `number` (1 ...); all six orders in turn."""
    return tuple(TRIAL_HELPS[i] for i in _ORDERS[(number - 1) % len(_ORDERS)])


def plan_of(name: str | None, rows: Sequence[ExerciseRow]) -> Plan:
    """The plan of a participant, given the rows written so far. A new name, or None for "P1", "P2",
    ..., gets the next order; after an interrupted run, the remaining helps follow. Raises
    `VenusError` for one who has finished everything."""
    numbers = {row.participant: row.number for row in rows}
    count = max(numbers.values(), default=0)
    if name is None:
        name = next(f"P{n}" for n in range(count + 1, 2 * count + 3) if f"P{n}" not in numbers)
    number = numbers.get(name, count + 1)
    mine = [row for row in rows if row.participant == name]
    done = {row.help for row in mine if row.pose == row.poses}
    attempts = {row.help: row.attempt for row in mine}
    if done.issuperset(TRIAL_HELPS):
        raise VenusError(
            f"{name} has done this trial already; name somebody else with --participant."
        )
    return Plan(
        name,
        number,
        order_of(number),
        frozenset(h for h in TRIAL_HELPS if h in done),
        tuple((h, attempts[h]) for h in TRIAL_HELPS if h in attempts),
    )


def targets_of(
    seed: int, camera: Camera, board: Board, limits: Limits, count: int
) -> tuple[Pose, ...]:
    """Random poses within the limits, in the same order for everybody and under every help, so that
    the paths between them are equally long. With the simulated camera they are those of `venus3d
    study table3`."""
    space = Space(board, camera, limits)
    rng = np.random.default_rng([seed, 0])
    return tuple(Pose.from_vector(random_pose(space, rng)) for _ in range(count))


def times_of(rows: Sequence[ExerciseRow]) -> tuple[HelpTimes, ...]:
    """The times of one run's helps, in their order."""
    begun = [row.help for row in rows]
    times: list[HelpTimes] = []
    for help_ in sorted({*begun}.intersection(TRIAL_HELPS), key=begun.index):
        mine = [row for row in rows if row.help == help_]
        reached = [row for row in mine if row.outcome == REACHED]
        seconds = tuple(row.seconds for row in reached if row.pose > 1)
        ends_s = tuple(row.since_first_s for row in mine)
        times.append(HelpTimes(help_, ends_s, seconds, len(mine) - len(reached)))
    return tuple(times)

"""Who gets which help when, which poses are asked for, and how long they took in all."""

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

# A Latin square and its mirror image: after three participants each help has come first, second
# and third equally often, after six each has followed each of the others equally often.
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
    """1 ...: in order of appearance."""
    order: tuple[Help, ...]
    done: frozenset[Help] = frozenset()
    """Helps that an earlier run has finished."""
    attempts: tuple[tuple[Help, int], ...] = ()
    """How often a help was begun before."""

    def attempt(self, help_: Help) -> int:
        """1 ...: the number of the attempt that comes."""
        return dict(self.attempts).get(help_, 0) + 1


@dataclass(frozen=True)
class HelpTimes:
    """How one help went, or goes."""

    help: str
    ends_s: tuple[float, ...]
    """For each pose in order when it was done with, seconds since the first one was."""
    reached_s: tuple[float, ...]
    """Seconds for each pose that was reached, the first one of the help left out: it is there to
    get used to the help."""
    given_up: int
    """How many poses were given up."""


def order_of(number: int) -> tuple[Help, ...]:
    """The helps in the order of participant `number` (1 ...); all six orders take turns."""
    return tuple(TRIAL_HELPS[i] for i in _ORDERS[(number - 1) % len(_ORDERS)])


def plan_of(name: str | None, rows: Sequence[ExerciseRow]) -> Plan:
    """The plan of a participant, given what is written already.

    A new one, or None for "P1", "P2", ..., gets the next order; one whose run was broken off goes
    on with the helps that are left. Raises `VenusError` for one who has done everything.
    """
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
    """Random poses within the limits, the same for everybody and under every help, in one order.

    The same order, so that the ways between the poses are equally long under every help. With the
    simulated camera they are the ten that `venus3d study table3` asks its simulated people for.
    """
    space = Space(board, camera, limits)
    rng = np.random.default_rng([seed, 0])
    return tuple(Pose.from_vector(random_pose(space, rng)) for _ in range(count))


def times_of(rows: Sequence[ExerciseRow]) -> tuple[HelpTimes, ...]:
    """How the helps of one run went, in their order."""
    begun = [row.help for row in rows]
    times: list[HelpTimes] = []
    for help_ in sorted({*begun}.intersection(TRIAL_HELPS), key=begun.index):
        mine = [row for row in rows if row.help == help_]
        reached = [row for row in mine if row.outcome == REACHED]
        seconds = tuple(row.seconds for row in reached if row.pose > 1)
        ends_s = tuple(row.since_first_s for row in mine)
        times.append(HelpTimes(help_, ends_s, seconds, len(mine) - len(reached)))
    return tuple(times)

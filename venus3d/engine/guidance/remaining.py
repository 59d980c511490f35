"""What remains to be done: the four steps from the board as it is held now to its target.

Everything that tells what to do (text, amount, arrow, picture) is read from this one object, so
that no two places can disagree. The decomposition from the upright board (eq. 15), which explains a
pose whatever the board does, is `Target.steps`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.decomposition import Step, Steps
from venus3d.engine.geometry.pose import AXES, Pose
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.prompts import (
    HOLD_HEADLINE,
    HOLD_STILL,
    STEP_DONE,
    STEP_HEADLINE,
    Phase,
    Prompt,
    step_prompt,
    translation_prompt,
)
from venus3d.engine.planning.target import Target


@dataclass(frozen=True, eq=False)
class RemainingStep:
    """One of the four steps, its amount, and its instruction."""

    step: Step
    """What remains of this step; `angle_deg` and `translation` are its amount."""
    done: bool
    """Whether its degree of freedom is within tolerance, or the whole board is at its target."""
    prompt: Prompt
    """The instruction, or that the step is done."""

    @property
    def number(self) -> int:
        """1 ... 4."""
        return self.step.number


@dataclass(frozen=True, eq=False)
class RemainingSteps:
    """The four steps to the target, from the board as it is held now. While the board is not seen,
    from the frontal, upright board."""

    each: tuple[RemainingStep, RemainingStep, RemainingStep, RemainingStep]
    """Steps 1 ... 4."""
    active: int
    """1 ... 4: the first step that is not done (4 if none)."""
    match: Match | None
    """The comparison with the target; None while the board is not seen."""

    @property
    def steps(self) -> Steps:
        """The four steps without their instructions."""
        one, two, three, four = self.each
        return one.step, two.step, three.step, four.step

    @property
    def start(self) -> Pose:
        """`T_camera_board` from which the steps count."""
        return self.each[0].step.before

    @property
    def from_upright(self) -> bool:
        """Whether they count from the upright board, because none is seen."""
        return self.match is None

    @property
    def done(self) -> tuple[bool, ...]:
        """Of each step, whether it is done."""
        return tuple(step.done for step in self.each)

    @property
    def is_over(self) -> bool:
        """Whether nothing is left but to hold still."""
        return all(self.done)

    @property
    def current(self) -> tuple[str, Prompt]:
        """Headline and instruction of the active step, or to hold still."""
        if self.is_over:
            return HOLD_HEADLINE, HOLD_STILL
        return STEP_HEADLINE.format(number=self.active), self.step(self.active).prompt

    def step(self, number: int) -> RemainingStep:
        """Step 1 ... 4."""
        return self.each[number - 1]


def remaining_steps(
    phase: Phase, target: Target | None, match: Match | None
) -> RemainingSteps | None:
    """The steps to this target; None without one, and in a phase in which nothing is to be done.

    Args:
        match: the board now against this target; None while it is not seen.
    """
    if target is None or phase not in ("startup", "guiding"):
        return None
    steps, done = target.steps, (False,) * 4
    if match is not None:
        # A board that covers its target is there, whatever a step's own tolerance says.
        steps, done = match.steps, (True,) * 4 if match.is_there else match.within
    one, two, three, four = (
        RemainingStep(step, is_done, STEP_DONE if is_done else instruction(step, match))
        for step, is_done in zip(steps, done, strict=True)
    )
    active = done.index(False) + 1 if False in done else 4
    return RemainingSteps((one, two, three, four), active, match)


def instruction(step: Step, match: Match | None) -> Prompt:
    """What to do in a step, of a move without the parts that are right already."""
    if match is None or step.axis is not None:
        return step_prompt(step)
    return translation_prompt(step.translation, match.part_limit_mm)


def has_left_the_way(steps: Steps, pose: Pose, *, mm: float, deg: float) -> bool:
    """Whether a board at `pose` is farther than `mm` or `deg` from every pose that is passed on the
    way through these steps."""
    return not any(_passes(step, pose, mm, deg) for step in steps)


def _passes(step: Step, pose: Pose, mm: float, deg: float) -> bool:
    """Whether this step comes within `mm` and `deg` of the pose."""
    begin, along = step.before, step.translation
    if step.axis is None:
        length = float(along @ along)
        share = np.clip((pose.t - begin.t) @ along / length, 0, 1) if length > 0 else 0.0
        nearest = begin.moved(share * along)
    else:
        nearest = begin.turned(step.axis, _nearest_turn_deg(step, pose))
    return 1000 * nearest.distance_to(pose) <= mm and nearest.angle_to_deg(pose) <= deg


def _nearest_turn_deg(step: Step, pose: Pose) -> float:
    """How far into this turn a board is most like `pose`, degrees.

    For the rest turn Q = R R0^T and a turn by a about the axis e, trace(Q R_e(a)^T) is largest at
    tan a = (vex(Q - Q^T) . e) / (trace Q - e^T Q e).
    """
    axis = step.axis or "x"
    rest, k = pose.R @ step.before.R.T, AXES.index(axis)
    i, j = (k + 1) % 3, (k + 2) % 3
    found = float(np.degrees(np.arctan2(rest[j, i] - rest[i, j], rest[i, i] + rest[j, j])))
    low, high = sorted((0.0, step.angle_deg))
    # The same turn the other way round may be the one within the step.
    inside = [a for a in (found - 360, found, found + 360) if low <= a <= high]
    if inside:
        return inside[0]
    return min((low, high), key=lambda a: step.before.turned(axis, a).angle_to_deg(pose))

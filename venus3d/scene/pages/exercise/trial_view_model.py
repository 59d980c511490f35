"""What a trial's page shows of one moment: who, under which help, which pose, how long.

Nothing in here computes; the trial's session fills it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from venus3d.engine.guidance.snapshot import Snapshot

Help = Literal["steps", "axes", "outline"]
"""steps: this program's four steps, one at a time. axes: the board's axes and the target's in the
picture (Rojtberg 2018). outline: the target's filled silhouette in the picture (AprilCal)."""
HELPS: tuple[Help, ...] = ("steps", "axes", "outline")
Stage = Literal["ready", "running", "over"]
"""ready: the teacher explains the help that comes; running: poses are asked for; over: all done."""


@dataclass(frozen=True)
class HelpTimes:
    """How one help went, or goes."""

    help: Help
    ends_s: tuple[float, ...] = ()
    """For each pose in order when it was done with, seconds since the first one was."""
    reached_s: tuple[float, ...] = ()
    """Seconds for each pose that was reached, the first one of the help left out: it is there to
    get used to the help."""
    given_up: int = 0
    """How many poses were given up."""


@dataclass(frozen=True)
class TrialMoment:
    """Where a trial stands."""

    participant: str
    stage: Stage
    order: tuple[Help, ...]
    """The helps in this participant's order; those done in an earlier run among them."""
    place: int
    """1 ...: which of `order` is shown, or comes next."""
    pose: int
    """1 ... `poses`: which pose is asked for."""
    poses: int
    elapsed_s: float
    """Since the first pose of this help was done with; before, since it was asked for."""
    there: bool
    """Whether the board is where it should be and only has to be held still."""
    times: tuple[HelpTimes, ...]
    """The helps that were begun in this run, in order."""
    written: str
    """The file that the times are in."""

    @property
    def help(self) -> Help:
        """The help that is shown, or comes next."""
        return self.order[self.place - 1]


@dataclass(frozen=True, eq=False)
class TrialSnapshot(Snapshot):
    """A moment of guidance with what is known of the trial around it."""

    trial: TrialMoment | None = None

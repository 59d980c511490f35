"""What is known of the pose that is taught now. The app works it out, the page shows it."""

from __future__ import annotations

from dataclasses import dataclass

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.geometry.rotation_orders import Turns
from venus3d.engine.planning.refusals import Refusal
from venus3d.lessons.lesson import Arrangement


@dataclass(frozen=True, eq=False)
class TeachMoment:
    """One pose, taken apart."""

    camera: Camera
    board: Board
    pose: Pose
    """The target, `T_camera_board`."""
    steps: Steps
    refusals: tuple[Refusal, ...]
    """Why a person would not be asked for this pose, worst first."""
    fixed: Turns
    """X, Y, Z about the camera's fixed axes."""
    own: Turns
    """The same numbers about the board's own axes."""
    reordered: Turns
    """The same numbers about fixed axes, in another order."""
    order: str
    """That order."""
    locked: bool
    """Whether Y is so near +-90 degrees that X and Z turn the board alike."""
    sigma_px: float
    """Standard deviation of the focal length from some views like this one; inf: they tell none."""
    sigma_words: str
    """What that means, in one sentence."""

    @property
    def last_busy(self) -> int:
        """1 ... 4: the last step in which something is done; 1 if there is none."""
        return max((step.number for step in self.steps if not step.is_idle), default=1)

    def others(self, arrangement: Arrangement) -> Turns:
        """The turns that are shown beside `fixed`."""
        return self.own if arrangement == "axes" else self.reordered

    def idle(self, arrangement: Arrangement) -> tuple[bool, ...]:
        """Which of the four steps show nothing, as this arrangement plays them."""
        if arrangement not in ("axes", "order"):
            return tuple(step.is_idle for step in self.steps)
        both = zip(self.fixed, self.others(arrangement), strict=True)
        # Two boards side by side do not move, they only turn.
        return (True, *(max(abs(a.angle_deg), abs(b.angle_deg)) < 0.5 for a, b in both))

    def apart_deg(self, arrangement: Arrangement) -> float:
        """The one angle between the two results side by side, degrees."""
        return self.fixed[2].after.angle_to_deg(self.others(arrangement)[2].after)

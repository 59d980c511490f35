"""The pose being taught: its four steps, its other readings, and its information."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps, decompose_vector, home_pose
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.geometry.rotation_orders import TurnSequence, is_near_gimbal_lock, turns
from venus3d.engine.planning.focal_uncertainty import focal_sigma, focal_words
from venus3d.engine.planning.limits import Limits, Refusal, refusals
from venus3d.lessons.lesson import Arrangement
from venus3d.scene.pages.teach.state import Vector


@dataclass(frozen=True, eq=False)
class TaughtPose:
    """One pose, decomposed."""

    camera: Camera
    board: Board
    pose: Pose
    """The target, `T_camera_board`."""
    steps: Steps
    refusals: tuple[Refusal, ...]
    """Why guidance would not ask for this pose, worst first."""
    fixed: TurnSequence
    """X, Y, Z about the camera's fixed axes."""
    own: TurnSequence
    """The same numbers about the board's own axes."""
    reordered: TurnSequence
    """The same numbers about fixed axes, in another order."""
    order: str
    """That order."""
    locked: bool
    """Whether Y is so close to +-90 degrees that X and Z become equivalent (gimbal lock)."""
    sigma_px: float
    """Standard deviation of the focal length from views like this one; inf: undetermined."""
    sigma_words: str
    """Its meaning, in one sentence."""

    @property
    def last_busy(self) -> int:
        """1 ... 4: the last step that is not idle; 1 if there is none."""
        return max((step.number for step in self.steps if not step.is_idle), default=1)

    @property
    def corners_outside(self) -> int:
        """How many of the board's four outer corners are outside the picture."""
        pixels = self.camera.project(self.pose.apply(self.board.outline))
        inside = (pixels >= -0.5) & (pixels <= np.array(self.camera.image_size) - 0.5)
        return int((~inside.all(axis=1)).sum())  # NaN, behind the lens, is not inside

    def others(self, arrangement: Arrangement) -> TurnSequence:
        """The turns shown beside `fixed`."""
        return self.own if arrangement == "axes" else self.reordered

    def idle(self, arrangement: Arrangement) -> tuple[bool, ...]:
        """Which of the four steps are idle in this arrangement."""
        if arrangement not in ("axes", "order"):
            return tuple(step.is_idle for step in self.steps)
        both = zip(self.fixed, self.others(arrangement), strict=True)
        # Boards side by side only turn.
        return (True, *(max(abs(a.angle_deg), abs(b.angle_deg)) < 0.5 for a, b in both))

    def apart_deg(self, arrangement: Arrangement) -> float:
        """The rotation angle between the two results side by side, degrees."""
        return self.fixed[2].after.angle_to_deg(self.others(arrangement)[2].after)


AnalysePose = Callable[[Vector, str], TaughtPose]
"""Analyses the pose of six numbers; the order of turns is compared with "xyz"."""


class PoseAnalysis:
    """Analyses poses of one board as one camera sees it."""

    def __init__(self, camera: Camera, board: Board) -> None:
        """The limits come from board and camera."""
        self._camera, self._board = camera, board
        self._limits = Limits.for_board(board, camera)

    def __call__(self, vector: Vector, order: str = "zyx") -> TaughtPose:
        """Analyse the pose of six numbers, in a few milliseconds; `order` is compared with
        "xyz"."""
        camera, board = self._camera, self._board
        p = np.array([*vector[:3], *(length / 1000 for length in vector[3:])])
        steps = decompose_vector(p, camera, board)
        pose = steps[3].after
        sigma = focal_sigma(camera, board, pose)
        return TaughtPose(
            camera=camera,
            board=board,
            pose=pose,
            steps=steps,
            refusals=refusals(self._limits, camera, board, p),
            fixed=turns(home_pose(), p[:3]),
            own=turns(home_pose(), p[:3], axes="own"),
            reordered=turns(home_pose(), p[:3], order=order),
            order=order,
            locked=is_near_gimbal_lock(p[1]),
            sigma_px=sigma,
            sigma_words=focal_words(sigma, camera),
        )

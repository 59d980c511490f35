"""Tracks the board from frame to frame: pose, match with the target, frames held."""

from __future__ import annotations

import math
from collections import deque

from venus3d.engine.calibration.board_pose import estimate_pose
from venus3d.engine.calibration.observation import Observation
from venus3d.engine.calibration.other_readings import renumbered, turned_pose
from venus3d.engine.errors import CalibrationError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.capture_refusal import refusal
from venus3d.engine.guidance.matching import Match, match, motion_px
from venus3d.engine.guidance.settings import Settings
from venus3d.engine.planning.target import Target
from venus3d.engine.sentences import Sentence


def is_near(camera: Camera, board: Board, pose: Pose, other: Pose, settings: Settings) -> bool:
    """Whether two poses count as the same, by the tolerances of the steps or by the silhouettes."""
    compared = match(camera, board, pose, other, tolerance=settings.tolerance)
    alike = compared.overlap > settings.overlap_needed
    turn_deg = pose.angle_to_deg(other)
    return all(compared.within) or (alike and turn_deg <= settings.tolerance.reached_deg)


class PoseTracker:
    """One board's pose in each frame and its match with the target. Used by one thread."""

    def __init__(self, board: Board, image_size: tuple[int, int], settings: Settings) -> None:
        """Nothing seen yet."""
        self._board, self._settings = board, settings
        self._before = Observation.nothing(image_size)
        self.observation = self._before
        self.pose: Pose | None = None
        """None while the board is not seen."""
        self.match: Match | None = None
        """None while there is no board or no target."""
        # The last match for this target: a board lost for one frame resumes at its step.
        self._last: Match | None = None
        self._quarters = 0  # by which the detector's readings are turned
        self.held_frames = 0
        """Consecutive observations in which the target has been reached."""
        self.refusal: Sentence | None = None
        """Why the last of them shall not become a view."""
        self._good: deque[Observation] = deque(maxlen=max(1, settings.hold_frames))

    def observe(
        self,
        observation: Observation,
        camera: Camera,
        target: Target | None,
        usual_sharpness: float = math.nan,
    ) -> None:
        """Process one frame. `usual_sharpness`: median of the captured views; NaN without any.
        Raises `CalibrationError` if its size differs from the others'."""
        (width, height), (w, h) = self.observation.image_size, observation.image_size
        if (w, h) != (width, height):
            raise CalibrationError(
                f"A frame of {w} x {h} px came into a calibration of {width} x {height} px; "
                "calibrate each image size by itself."
            )
        self._before = self.observation.without_image()
        self.observation = renumbered(self._board, observation, self._quarters)
        self._compare(camera, target, self._before)
        if self.match is None or not self.match.reached:
            self.release()
            return
        self.held_frames += 1
        since_s = observation.time_s - self._before.time_s
        moves = math.isfinite(self._settings.still_px)  # not so for single pictures
        self.refusal = refusal(
            observation,
            self._board,
            motion_px=self.match.motion_px if moves else 0.0,
            since_s=since_s,
            usual_sharpness=usual_sharpness,
        )
        if self.refusal is None:
            self._good.append(observation)

    def release(self) -> None:
        """The hold is over, or has led to a view."""
        self.held_frames, self.refusal = 0, None
        self._good.clear()

    @property
    def best_held(self) -> Observation | None:
        """The sharpest of the last observations at the target that may become a view."""
        return max(self._good, key=lambda seen: seen.sharpness, default=None)

    def set_target(self, camera: Camera, target: Target | None) -> None:
        """Re-evaluate the last frame with another camera or target."""
        self._last = None
        self.release()
        self._compare(camera, target, None)

    @property
    def is_at_target(self) -> bool:
        """Whether the board is at its target, moving or not."""
        return self.match is not None and (self.match.reached or all(self.match.within))

    @property
    def is_still(self) -> bool:
        """Whether the board hardly moved since the last frame."""
        return motion_px(self._before, self.observation) <= self._settings.still_px

    def _compare(self, camera: Camera, target: Target | None, before: Observation | None) -> None:
        last, self.match = self.pose, None
        self.pose = estimate_pose(camera, self._board, self.observation, last)
        self._choose_reading(last, target)
        if self.pose is not None and target is not None:
            self.match = match(
                camera,
                self._board,
                self.pose,
                target.pose,
                observation=self.observation,
                before=before,
                previous=self._last,
                overlap_needed=self._settings.overlap_needed,
                still_px=self._settings.still_px,
                tolerance=self._settings.tolerance,
            )
            self._last = self.match

    def _choose_reading(self, last: Pose | None, target: Target | None) -> None:
        """Of a board that looks the same after a turn: as it was seen last or, where it comes into
        view, nearest to its target. What stands at its target is never told to be turned."""
        near = last or (target and target.pose)
        turns = self._board.of_kind.quarter_turns(self._board)
        if self.pose is None or near is None or not turns:
            return
        poses = {quarters: turned_pose(self.pose, quarters) for quarters in (0, *turns)}
        if target is not None:
            away = {quarters: pose.angle_to_deg(target.pose) for quarters, pose in poses.items()}
            if min(away.values()) <= self._settings.tolerance.reached_deg:
                near = target.pose
        chosen = min(poses, key=lambda quarters: poses[quarters].angle_to_deg(near))
        if chosen:
            self._quarters = (self._quarters + chosen) % 4
            self.pose = poses[chosen]
            self.observation = renumbered(self._board, self.observation, chosen)

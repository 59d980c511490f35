"""How the board as it is compares with where it should be, step by step and as a silhouette."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.decomposition import decompose
from venus3d.engine.observation import Observation
from venus3d.engine.pose import Array, Pose
from venus3d.engine.snapshot import Match

_NEAR_PLANE = 0.01  # metres; what is closer to the lens's plane is cut off before projecting


@dataclass(frozen=True)
class Tolerance:
    """When a step counts as done."""

    mm: float = 8.0
    """Distance of the board's centre to its place, millimetres."""
    fraction: float = 0.02
    """The same as a fraction of the target's distance; the larger of the two counts."""
    deg: float = 3.0
    """What is left of a turn, degrees."""
    hysteresis: float = 1.6
    """A step that was done is open again only beyond this multiple, so that it does not flicker."""
    reached_deg: float = 15.0
    """Beyond this turn the pose is not reached whatever the overlap: a silhouette hardly tells a
    board tilted forwards from one tilted backwards, nor the right way up from upside down."""

    def __post_init__(self) -> None:
        if min(self.mm, self.fraction, self.deg) < 0 or self.hysteresis < 1:
            raise ValueError("tolerances are not negative and the hysteresis is at least 1")


def match(
    camera: Camera,
    board: Board,
    pose: Pose,
    target: Pose,
    *,
    observation: Observation | None = None,
    before: Observation | None = None,
    previous: Match | None = None,
    overlap_needed: float = 0.85,
    still_px: float = 2.0,
    tolerance: Tolerance | None = None,
) -> Match:
    """Compare the board's `pose` with the `target`.

    Args:
        observation, before: the corners now and one frame ago, for the board's motion.
        previous: the match one frame ago, for the hysteresis.
        overlap_needed: Jaccard overlap of the silhouettes above which the pose is reached.
        still_px: mean motion of the corners in a frame below which the board is still.
    """
    allowed = Tolerance() if tolerance is None else tolerance
    steps = decompose(target, camera, board, start=pose)
    remaining_mm = 1000 * (target.t - pose.t)
    remaining_deg = np.array([step.angle_deg for step in steps[1:]])
    limit_mm = max(allowed.mm, 1000 * allowed.fraction * float(np.linalg.norm(target.t)))
    # Each step's rest in units of its tolerance; in the order of the four steps.
    rest = [float(np.linalg.norm(remaining_mm)) / max(limit_mm, 1e-9)]
    rest += [abs(float(angle)) / max(allowed.deg, 1e-9) for angle in remaining_deg]
    done = (False,) * 4 if previous is None else previous.within
    within = [r <= (allowed.hysteresis if d else 1.0) for r, d in zip(rest, done, strict=True)]
    overlap = silhouette_overlap(camera, board, pose, target)
    motion = motion_px(before, observation)
    return Match(
        steps=steps,
        active_step=within.index(False) + 1 if False in within else 4,
        within=(within[0], within[1], within[2], within[3]),
        remaining_mm=remaining_mm,
        remaining_deg=remaining_deg,
        corner_distance_px=_corner_distance_px(camera, board, pose, target),
        overlap=overlap,
        motion_px=motion,
        reached=overlap > overlap_needed
        and motion < still_px
        and pose.angle_to_deg(target) <= allowed.reached_deg,
    )


def motion_px(before: Observation | None, now: Observation | None) -> float:
    """Mean shift, pixels, of the corners that both observations hold; inf if there are none."""
    if before is None or now is None:
        return float("inf")
    _, old, new = np.intersect1d(before.ids, now.ids, assume_unique=True, return_indices=True)
    if old.size == 0:
        return float("inf")
    shift = now.corners[new] - before.corners[old]
    return float(np.linalg.norm(shift, axis=1).mean())


def silhouette_overlap(camera: Camera, board: Board, one: Pose, other: Pose) -> float:
    """Jaccard overlap, 0 ... 1, of the board's two silhouettes.

    By the undistorted pinhole and beyond the image's border, where the lens model has no meaning:
    straight edges stay straight and a board partly outside still compares.
    """
    a, b = _silhouette(camera, board, one), _silhouette(camera, board, other)
    if len(a) < 3 or len(b) < 3:
        return 0.0
    area_a, area_b = cv2.contourArea(a), cv2.contourArea(b)
    common, _ = cv2.intersectConvexConvex(a, b)
    union = area_a + area_b - common
    return float(np.clip(common / union, 0.0, 1.0)) if union > 0 else 0.0


def _silhouette(camera: Camera, board: Board, pose: Pose) -> cv2.typing.MatLike:
    """(K, 2) convex polygon in pixels, cut off at a plane just before the lens."""
    outline = pose.apply(board.outline)
    kept: list[Array] = []
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        inside, next_inside = start[2] >= _NEAR_PLANE, end[2] >= _NEAR_PLANE
        if inside:
            kept.append(start)
        if inside != next_inside:
            kept.append(start + (end - start) * (_NEAR_PLANE - start[2]) / (end[2] - start[2]))
    if not kept:
        return np.zeros((0, 2), np.float32)
    points = np.array(kept)
    # In units of the image's width: OpenCV's polygon clipping is single precision.
    xy = points[:, :2] / points[:, 2:] * [camera.fx, camera.fy] / camera.width
    return xy.astype(np.float32)


def _corner_distance_px(camera: Camera, board: Board, one: Pose, other: Pose) -> float:
    """Mean distance of the projected inner corners, pixels, by the undistorted pinhole."""
    pinhole = camera.without_distortion()
    shift = pinhole.project(one.apply(board.corners)) - pinhole.project(other.apply(board.corners))
    distance = np.linalg.norm(shift, axis=1)
    seen = np.isfinite(distance)
    return float(distance[seen].mean()) if seen.any() else float("inf")

"""Compares the board's pose with the target, step by step and by silhouette."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from venus3d.engine.calibration.observation import Observation
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Array, Pose

_NEAR_PLANE = 0.01  # metres; anything nearer to the lens is clipped before projection
_MOST_SHORT = 25
"""Consecutive frames, about a second, for which a board that falls short of what a capture asks for
may count as done by the hysteresis alone: it would be held still in vain."""


@dataclass(frozen=True)
class Tolerance:
    """Tolerances within which a step is done."""

    mm: float | None = None
    """Distance of the board's centre to its target, millimetres; None: by `fraction`."""
    fraction: float = 0.035
    """The same as a fraction of the board's shorter side: 6 mm for the default board."""
    deg: float = 2.5
    """Remaining turn, degrees. On random targets, a pose with all four steps just within these
    tolerances overlaps by more than 0.85 in 99.8 %, so "all steps done" and "reached" agree."""
    hysteresis: float = 1.6
    """A step that was done reopens only beyond this multiple, to avoid flicker; so does a pose that
    was reached, in what the overlap lacks of 1 and in its turn."""
    reached_deg: float = 15.0
    """Beyond this turn the pose is not reached whatever the overlap: a silhouette hardly
    distinguishes a forward from a backward tilt, or upright from upside down."""

    def __post_init__(self) -> None:
        if min(self.mm or 0.0, self.fraction, self.deg) < 0 or self.hysteresis < 1:
            raise ValueError("tolerances are not negative and the hysteresis is at least 1")

    def centre_mm(self, board: Board) -> float:
        """The tolerance of the centre for this board, millimetres."""
        return 1000 * self.fraction * min(board.width, board.height) if self.mm is None else self.mm


@dataclass(frozen=True, eq=False)
class Match:
    """Comparison of the board's current pose with the target."""

    steps: Steps
    """From the board's current pose to the target: what remains of each degree of freedom."""
    active_step: int
    """1 ... 4: the first step whose degree of freedom is not within tolerance (4 if none)."""
    within: tuple[bool, bool, bool, bool]
    """For each step, whether its degree of freedom is within tolerance."""
    remaining_mm: Array
    """(3,) target minus current position, camera frame, millimetres."""
    remaining_deg: Array
    """(3,) remaining turns about X, Y, Z, degrees."""
    corner_distance_px: float
    """Mean distance of the projected inner corners, pixels."""
    overlap: float
    """Jaccard overlap of the two silhouettes in the image, 0 ... 1."""
    motion_px: float
    """Motion of the corners since the last frame, pixels; inf without one."""
    reached: bool
    """The overlap is large enough and the corners are still."""
    limit_mm: float
    """Tolerance of the centre, millimetres."""
    limit_deg: float
    """Tolerance of a turn, degrees."""
    lingers: bool = False
    """It was there before, and the board has only trembled since."""
    short_frames: int = 0
    """Consecutive frames in which all counted as done, and yet the overlap was too small or the
    turn too large for a capture."""

    @property
    def is_there(self) -> bool:
        """Whether nothing is left to do but to hold still. Unlike `reached`, which a capture asks
        for, it does not change to and fro with a trembling board."""
        return self.reached or self.lingers or all(self.within)

    @property
    def part_limit_mm(self) -> float:
        """The share of `limit_mm` that each part of a move (right, down, away) has, millimetres: a
        part within it is right, and a move of which all three are is done."""
        return self.limit_mm / float(np.sqrt(3))


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
    limit_mm = allowed.centre_mm(board)
    # What remains of each step in units of its tolerance, in the order of the four steps.
    rest = [float(np.linalg.norm(remaining_mm)) / max(limit_mm, 1e-9)]
    rest += [abs(float(angle)) / max(allowed.deg, 1e-9) for angle in remaining_deg]
    overlap, turn_deg = silhouette_overlap(camera, board, pose, target), pose.angle_to_deg(target)
    covers = overlap > overlap_needed and turn_deg <= allowed.reached_deg
    short = 0 if covers or previous is None or not previous.is_there else previous.short_frames + 1
    if short > _MOST_SHORT:
        previous, short = None, 0
    done = (False,) * 4 if previous is None else previous.within
    within = [r <= (allowed.hysteresis if d else 1.0) for r, d in zip(rest, done, strict=True)]
    trembles = (
        1 - overlap <= allowed.hysteresis * (1 - overlap_needed)
        and turn_deg <= allowed.hysteresis * allowed.reached_deg
    )
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
        reached=covers and motion < still_px,
        limit_mm=limit_mm,
        limit_deg=allowed.deg,
        lingers=previous is not None and previous.is_there and trembles,
        short_frames=short,
    )


def motion_px(before: Observation | None, now: Observation | None) -> float:
    """Mean shift of the corners common to both observations, pixels; inf if there are none."""
    if before is None or now is None:
        return float("inf")
    _, old, new = np.intersect1d(before.ids, now.ids, assume_unique=True, return_indices=True)
    if old.size == 0:
        return float("inf")
    shift = now.corners[new] - before.corners[old]
    return float(np.linalg.norm(shift, axis=1).mean())


def silhouette_overlap(camera: Camera, board: Board, one: Pose, other: Pose) -> float:
    """Jaccard overlap, 0 ... 1, of the board's two silhouettes.

    By the undistorted pinhole, also beyond the image's border where the lens model is meaningless:
    straight edges stay straight and a partly visible board can be compared.
    """
    a, b = _silhouette(camera, board, one), _silhouette(camera, board, other)
    common = _area(_clipped(a, b))
    union = _area(a) + _area(b) - common
    return float(np.clip(common / union, 0.0, 1.0)) if union > 0 else 0.0


def _clipped(polygon: Array, convex: Array) -> Array:
    """The intersection of a convex polygon (K, 2) with another one.

    Sutherland and Hodgman in double precision; `cv2.intersectConvexConvex` fails on nearly
    coincident polygons, which is the case here.
    """
    turns = np.sign(_signed_area(convex))
    for start, end in zip(convex, np.roll(convex, -1, axis=0), strict=True):
        edge = end - start
        offset = polygon - start
        side = turns * (edge[0] * offset[:, 1] - edge[1] * offset[:, 0])
        polygon = _kept_side(polygon, side)
    return polygon


def _kept_side(points: Array, side: Array) -> Array:
    """The part of a closed polygon (K, D) where `side` (K,), linear along the edges, is >= 0."""
    kept: list[Array] = []
    for i in range(len(points)):
        k = (i + 1) % len(points)
        if side[i] >= 0:
            kept.append(points[i])
        if (side[i] >= 0) != (side[k] >= 0):
            kept.append(points[i] + (points[k] - points[i]) * side[i] / (side[i] - side[k]))
    return np.array(kept) if kept else np.zeros((0, points.shape[1]))


def _signed_area(polygon: Array) -> float:
    x, y = polygon[:, 0], polygon[:, 1]
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def _area(polygon: Array) -> float:
    return abs(_signed_area(polygon))


def _silhouette(camera: Camera, board: Board, pose: Pose) -> Array:
    """(K, 2) convex polygon in pixels, clipped at a plane just in front of the lens."""
    outline = pose.apply(board.outline)
    if not camera.lens.is_perspective:
        return camera.pixels_of(outline.T).T
    points = _kept_side(outline, outline[:, 2] - _NEAR_PLANE)
    return points[:, :2] / points[:, 2:] * [camera.fx, camera.fy]


def _corner_distance_px(camera: Camera, board: Board, one: Pose, other: Pose) -> float:
    """Mean distance of the projected inner corners, pixels, by the undistorted pinhole or a
    wide lens."""
    seen = camera.unbent
    shift = seen.project(one.apply(board.corners)) - seen.project(other.apply(board.corners))
    distance = np.linalg.norm(shift, axis=1)
    finite = np.isfinite(distance)
    return float(distance[finite].mean()) if finite.any() else float("inf")

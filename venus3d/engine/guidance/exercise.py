"""Practice: a level's targets, and the path of the board towards them.
Pure values: no clock (times are passed in), no screen. `matching` decides when a pose is
reached."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from venus3d.engine.errors import VenusError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import HOME_DISTANCE, home_pose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.limits import Limits, Mask

LEVELS = (1, 2, 3, 4, 5, 6)
"""The level is the number of pose parameters to find, out of six."""
HOLD_S = 1.0
"""Seconds that the board must stay within the tolerances to count as reached."""
LEAST_TURN_DEG = 15.0
"""Smallest turn that a target asks for."""
LEAST_SHIFT = 0.15
"""Smallest shift, as a fraction of the board's width."""
REST_S = 1.0
"""A jump counts towards the path length once the board has rested there this long: when typing
with one finger, the next digit takes most of a second."""
_TRIES, _DRAWS = 40, 512

Free = tuple[bool, bool, bool, bool, bool, bool]
"""Which of xr, yr, zr, xt, yt, zt may be changed."""
Reach = tuple[tuple[float, float], ...]
"""Lowest and highest of xr, yr, zr in degrees and xt, yt, zt in metres."""
NAMES = ("xr", "yr", "zr", "xt", "yt", "zt")


def start_pose(camera: Camera, board: Board, limits: Limits) -> Pose:
    """Start of each exercise: frontal and upright on the optical axis.

    At the usual distance if the limits allow it, else in the middle of their range. Raises
    `VenusError` if they allow no such pose.
    """
    depths = np.geomspace(limits.nearest, limits.farthest, 200)
    vectors = np.zeros((len(depths) + 1, 6))
    vectors[:, 5] = [HOME_DISTANCE, *depths]
    good = limits.accepts(camera, board, vectors)
    if good[0]:
        return home_pose()
    if not good.any():
        raise VenusError(
            "This camera cannot read this board at any distance; choose another --board.columns, "
            "--board.rows or --board.square-mm."
        )
    return home_pose(float(np.median(vectors[good, 5])))


def choose_free(level: int, generator: np.random.Generator) -> Free:
    """The pose parameters that a target of this level changes. 1: any one; 2: a turn and a shift;
    3: all turns or all shifts; 4, 5: all shifts and one or two turns; 6: all."""
    turns, shifts = generator.permutation(3), 3 + generator.permutation(3)
    whole = bool(generator.integers(2))
    chosen: dict[int, list[int]] = {
        1: [int(generator.integers(6))],
        2: [turns[0], shifts[0]],
        3: [*(turns if whole else shifts)],
        4: [*shifts, turns[0]],
        5: [*shifts, *turns[:2]],
        6: [*shifts, *turns],
    }
    free = [number in chosen[level] for number in range(6)]
    return (free[0], free[1], free[2], free[3], free[4], free[5])


def practice_target(
    camera: Camera,
    board: Board,
    limits: Limits,
    start: Pose,
    level: int,
    generator: np.random.Generator,
) -> tuple[Pose, Free]:
    """A target within the limits, and which pose parameters differ from `start`.

    Each free parameter differs clearly from the start's; the others are equal. Raises `VenusError`
    if the limits leave no room.
    """
    for _ in range(_TRIES):
        free = choose_free(level, generator)
        vectors = _drawn(camera, limits, start, free, generator)
        far = _far_enough(vectors, start, free, board)
        vectors = vectors[far]
        for vector in vectors[limits.accepts(camera, board, vectors)][:1]:
            return Pose.from_vector(vector), free
    raise VenusError(
        "These limits leave no room for a target; take a smaller board or a camera that sees more."
    )


def _drawn(
    camera: Camera, limits: Limits, start: Pose, free: Free, generator: np.random.Generator
) -> Array:
    """(N, 6) random pose vectors: free angles uniform over their range, the centre over the image,
    the distance over the logarithm of its range."""
    unit = generator.random((_DRAWS, 6))
    vectors = np.tile(start.vector(), (_DRAWS, 1))
    for number in range(3):
        if free[number]:
            vectors[:, number] = (2 * unit[:, number] - 1) * limits.max_angle_deg
    if free[5]:
        vectors[:, 5] = limits.nearest * (limits.farthest / limits.nearest) ** unit[:, 5]
    if free[3]:
        vectors[:, 3] = (unit[:, 3] * camera.width - camera.cx) / camera.fx * vectors[:, 5]
    if free[4]:
        vectors[:, 4] = (unit[:, 4] * camera.height - camera.cy) / camera.fy * vectors[:, 5]
    return vectors


def _far_enough(vectors: Array, start: Pose, free: Free, board: Board) -> Mask:
    least = np.array([LEAST_TURN_DEG] * 3 + [LEAST_SHIFT * board.width] * 3)
    change = np.abs(vectors - start.vector()) >= least
    return np.asarray((change | ~np.array(free)).all(axis=1), dtype=np.bool_)


def with_free_only(pose: Pose, start: Pose, free: Free) -> Pose:
    """This pose with the parameters that are not free reset to the start's."""
    if all(free):
        return pose
    return Pose.from_vector(np.where(free, pose.vector(), start.vector()))


def reach_of(camera: Camera, limits: Limits) -> Reach:
    """The range in which a practice board can be moved, larger than any target needs."""
    far = 1.2 * limits.farthest
    right, down = (
        0.05 * float(np.ceil(far * half / 0.05))
        for half in (camera.width / (2 * camera.fx), camera.height / (2 * camera.fy))
    )
    shifts = ((-right, right), (-down, down), (0.5 * limits.nearest, far))
    return ((-90.0, 90.0), (-90.0, 90.0), (-180.0, 180.0), *shifts)


def within_reach(pose: Pose, reach: Reach) -> Pose:
    """This pose with each parameter clipped to the range."""
    vector, (low, high) = pose.vector(), np.array(reach).T
    if ((vector >= low) & (vector <= high)).all():
        return pose
    return Pose.from_vector(np.clip(vector, low, high))


@dataclass(frozen=True, eq=False)
class Attempt:
    """One target and the board's path towards it; times are seconds of any clock."""

    start: Pose
    target: Pose
    free: Free
    pose: Pose
    """The board's current pose."""
    began_s: float | None = None
    """Time of the first move; None before it."""
    moved_s: float = 0.0
    """Time of the last move."""
    jumped: bool = False
    """Whether the last move was a jump."""
    corner: Pose | None = None
    """Start of the last straight segment of the path; None for the start pose."""
    legs_mm: float = 0.0
    legs_deg: float = 0.0
    """Length of the path up to there."""

    @staticmethod
    def at(start: Pose, target: Pose, free: Free) -> Attempt:
        """The board at the start."""
        return Attempt(start, target, free, start)

    def moved(self, pose: Pose, now_s: float, *, jump: bool = False) -> Attempt:
        """After the board was moved to `pose`, of which only the free parameters count.

        Jumps within `REST_S` of each other count as one, from the first start to the last end:
        typing "450" does not go by way of "4" and "45".
        """
        pose = with_free_only(pose, self.start, self.free)
        if self.pose.distance_to(pose) < 1e-9 and self.pose.angle_to_deg(pose) < 1e-4:
            return self  # rounding of a matrix
        after = replace(
            self,
            pose=pose,
            began_s=now_s if self.began_s is None else self.began_s,
            moved_s=now_s,
            jumped=jump,
        )
        if jump and self.jumped and now_s - self.moved_s < REST_S:
            return after
        return replace(after, corner=self.pose, legs_mm=self.path_mm, legs_deg=self.path_deg)

    @property
    def path_mm(self) -> float:
        """Path length of the board's centre, millimetres."""
        return self.legs_mm + 1000 * (self.corner or self.start).distance_to(self.pose)

    @property
    def path_deg(self) -> float:
        """Sum of all turns, degrees."""
        return self.legs_deg + (self.corner or self.start).angle_to_deg(self.pose)

    def taken_s(self, now_s: float) -> float:
        """Time since the first move, seconds; 0 before it."""
        return 0.0 if self.began_s is None else now_s - self.began_s

    def still_s(self, now_s: float) -> float:
        """Time since the last move, seconds; 0 before the first one."""
        return 0.0 if self.began_s is None else now_s - self.moved_s

    @property
    def shortest_mm(self) -> float:
        """Straight line from the start to the target, millimetres."""
        return 1000 * self.start.distance_to(self.target)

    @property
    def shortest_deg(self) -> float:
        """Single rotation from the start to the target, degrees."""
        return self.start.angle_to_deg(self.target)


def detour(path_mm: float, shortest_mm: float, path_deg: float, shortest_deg: float) -> float:
    """Path length over the shortest path: the larger of the shift's and the turn's ratio.
    NaN if the target needs neither."""
    pairs = ((path_mm, shortest_mm), (path_deg, shortest_deg))
    ratios = [path / shortest for path, shortest in pairs if shortest >= 1.0]
    return max(ratios, default=float("nan"))

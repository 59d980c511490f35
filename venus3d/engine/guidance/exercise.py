"""Practising: which target a level asks for, and how far the board was moved to get there.

Pure values: no clock (a time is passed in), no screen. When a pose counts as reached is left to
`matching`; who practises, and with which help, to the page.
"""

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
"""A level is how many of the six numbers of the pose have to be found."""
HOLD_S = 1.0
"""How long the board has to stay where it is, within the tolerances, to count as reached."""
LEAST_TURN_DEG = 15.0
"""A turn that is asked for is at least so large."""
LEAST_SHIFT = 0.15
"""And a shift at least this fraction of the board's width."""
REST_S = 1.0
"""A jump counts as a way taken once the board has stood for so long where it brought it: typed with
one finger, the next digit takes most of a second."""
_TRIES, _DRAWS = 40, 512

Free = tuple[bool, bool, bool, bool, bool, bool]
"""Which of xr, yr, zr, xt, yt, zt may be changed."""
Reach = tuple[tuple[float, float], ...]
"""Lowest and highest of xr, yr, zr in degrees and xt, yt, zt in metres."""
NAMES = ("xr", "yr", "zr", "xt", "yt", "zt")


def start_pose(camera: Camera, board: Board, limits: Limits) -> Pose:
    """Where each pose begins: frontal and upright on the optical axis.

    At the usual distance if the limits allow it, else in the middle of what they allow. Raises
    `VenusError` if they allow no such board at all.
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
    """Which numbers a target of this level changes.

    1 any one; 2 a turn and a shift; 3 all turns or all shifts; 4, 5 all shifts and one or two
    turns; 6 all.
    """
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
    """A target within the limits, and which numbers of the pose lead from `start` to it.

    Each free number differs clearly from the start's; the others are the start's own. Raises
    `VenusError` if the limits leave no room for one.
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
    """(N, 6) pose vectors: free angles over their range, the centre over the image, the distance
    over the logarithm of its range."""
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
    """This pose with the numbers that are not free put back to the start's."""
    if all(free):
        return pose
    return Pose.from_vector(np.where(free, pose.vector(), start.vector()))


def reach_of(camera: Camera, limits: Limits) -> Reach:
    """How far a practised board can be moved at all: farther than any target needs."""
    far = 1.2 * limits.farthest
    right, down = (
        0.05 * float(np.ceil(far * half / 0.05))
        for half in (camera.width / (2 * camera.fx), camera.height / (2 * camera.fy))
    )
    shifts = ((-right, right), (-down, down), (0.5 * limits.nearest, far))
    return ((-90.0, 90.0), (-90.0, 90.0), (-180.0, 180.0), *shifts)


def within_reach(pose: Pose, reach: Reach) -> Pose:
    """This pose, with each number that is out of reach put to the end of its range."""
    vector, (low, high) = pose.vector(), np.array(reach).T
    if ((vector >= low) & (vector <= high)).all():
        return pose
    return Pose.from_vector(np.clip(vector, low, high))


@dataclass(frozen=True, eq=False)
class Attempt:
    """One target and how the board has been moved towards it; times are seconds of any clock."""

    start: Pose
    target: Pose
    free: Free
    pose: Pose
    """Where the board is."""
    began_s: float | None = None
    """When it was moved first; None while it has not been."""
    moved_s: float = 0.0
    """When it was moved last."""
    jumped: bool = False
    """Whether that was a jump."""
    corner: Pose | None = None
    """Where the last straight leg of its way begins; None for the start."""
    legs_mm: float = 0.0
    legs_deg: float = 0.0
    """Length of the way up to there."""

    @staticmethod
    def at(start: Pose, target: Pose, free: Free) -> Attempt:
        """The board at the start."""
        return Attempt(start, target, free, start)

    def moved(self, pose: Pose, now_s: float, *, jump: bool = False) -> Attempt:
        """After the board was brought to `pose`, of which only the free numbers count.

        A `jump` that goes on within `REST_S` is one with the next: only the way from where the
        jumps began to where they end counts. So "450" is not by way of "4" and "45".
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
        """Length of the way of its centre, millimetres."""
        return self.legs_mm + 1000 * (self.corner or self.start).distance_to(self.pose)

    @property
    def path_deg(self) -> float:
        """All its turns added up, degrees."""
        return self.legs_deg + (self.corner or self.start).angle_to_deg(self.pose)

    def taken_s(self, now_s: float) -> float:
        """Time since the first move, seconds; 0 before it."""
        return 0.0 if self.began_s is None else now_s - self.began_s

    def still_s(self, now_s: float) -> float:
        """Time since the last move, seconds; 0 before the first one."""
        return 0.0 if self.began_s is None else now_s - self.moved_s

    @property
    def shortest_mm(self) -> float:
        """The straight line from the start to the target, millimetres."""
        return 1000 * self.start.distance_to(self.target)

    @property
    def shortest_deg(self) -> float:
        """The one turn from the start to the target, degrees."""
        return self.start.angle_to_deg(self.target)


def detour(path_mm: float, shortest_mm: float, path_deg: float, shortest_deg: float) -> float:
    """How many times the shortest way was taken: the larger of the shift's and the turn's ratio.

    NaN where the target asks for neither.
    """
    pairs = ((path_mm, shortest_mm), (path_deg, shortest_deg))
    ratios = [path / shortest for path, shortest in pairs if shortest >= 1.0]
    return max(ratios, default=float("nan"))

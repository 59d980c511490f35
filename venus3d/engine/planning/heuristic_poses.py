"""Rule-based poses for the least certain parameter (3.2): the paper's and Rojtberg's.

For a focal length or the principal point the board is tilted, for a distortion coefficient it
covers the most distorted part of the image. The angles differ: eq. (11) averages the last two,
Rojtberg et al. 2018 bisect the range breadth first. The state is a frozen `HeuristicState`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PINHOLE_PARAMETERS, Camera
from venus3d.engine.geometry.lenses import BROWN5, EQUIDISTANT
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.costs import index_of_dispersion
from venus3d.engine.planning.pose_space import Space, brought_within, rays_towards

ROLL_DEG = 22.5
"""pi/8 of eq. (10): keeps the board's rows from being parallel to the image's."""
CELL_PX = 20
"""Cell of the distortion map."""
WINDOW_WIDTH = 0.3
"""Width of a distortion window, as a fraction of the image's."""
_ORBIT_WIDTHS = 1.6  # Rojtberg's distance of an orbit pose, in board widths
_SHIFT = 0.05  # his shift for the principal point, as a fraction of the image
_ABOUT_Y = ("fx", "cx")
_ABOUT_X = ("fy", "cy")
_BROWN5 = (*PINHOLE_PARAMETERS, *BROWN5.coefficient_names)


@dataclass(frozen=True)
class Window:
    """A rectangle of the image, pixels: left, top, width, height."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class HeuristicState:
    """What the rules have used so far."""

    made: tuple[str, ...] = ()
    """The parameters that poses were made for, one after the other."""
    windows: tuple[Window, ...] = ()
    """Distortion windows already shown."""
    sigma: tuple[float, ...] = ()
    """(p,) standard deviations when the last pose was made; empty before."""
    aimed: str = ""
    """The parameter that the last pose was made for; empty before."""
    settled: tuple[str, ...] = ()
    """Parameters no longer aimed at, because their view changed them little."""

    def observed(
        self, sigma: ArrayLike, names: tuple[str, ...] = _BROWN5, epsilon: float = 0.1
    ) -> HeuristicState:
        """The state after the views so far gave standard deviations `sigma` (p,) of these names.

        A parameter whose sigma fell by less than `epsilon` through the view made for it is settled
        and no longer aimed at, as in Rojtberg's program; otherwise k3, which is nearly always the
        worst, would get all poses. When all are settled, all start again. Unchanged values (a
        skipped target) have no effect.
        """
        now = np.asarray(sigma, dtype=np.float64)
        begun = replace(self, sigma=tuple(float(v) for v in now))
        if len(self.sigma) != len(now) or self.aimed not in names:
            return begun
        if np.allclose(now, self.sigma, rtol=1e-6, atol=0):
            return begun
        aimed = names.index(self.aimed)
        if not 0 <= 1 - now[aimed] / self.sigma[aimed] < epsilon:
            return begun
        settled = tuple(sorted({*self.settled, self.aimed}))
        return replace(begun, settled=() if set(names) <= set(settled) else settled)

    def count(self, *names: str) -> int:
        """Number of poses made for these parameters together."""
        return sum(self.made.count(name) for name in names)

    def after(self, name: str, window: Window | None = None) -> HeuristicState:
        """The state after one more pose for the parameter `name`."""
        windows = self.windows if window is None else (*self.windows, window)
        return replace(self, made=(*self.made, name), windows=windows, aimed=name)


@dataclass(frozen=True, eq=False)
class HeuristicPose:
    """A rule-based pose."""

    vector: Array
    """(6,) pose vector, within the limits."""
    parameter: str
    """The parameter it was made for."""
    state: HeuristicState
    """The next state."""
    note: str = ""
    """How the rule's pose was changed to fit the limits; empty if it was not."""


def weakest_parameter(camera: Camera, covariance: ArrayLike, settled: Collection[str] = ()) -> str:
    """The unsettled parameter with the largest index of dispersion, eq. (13)."""
    dispersion = index_of_dispersion(camera, covariance)
    passed_over = [name in settled for name in camera.parameter_names]
    return camera.parameter_names[int(np.argmax(np.where(passed_over, -np.inf, dispersion)))]


def paper_angle_deg(i: int) -> float:
    """Eq. (11) as printed, i from 1: -70, 70, 0, 35, 17.5, 26.25 ... -> 23.3."""
    older, newer = -70.0, 70.0
    if i == 1:
        return older
    for _ in range(i - 2):
        older, newer = newer, (older + newer) / 2
    return newer


def bisection_angle_deg(i: int, half_range_deg: float = 70.0) -> float:
    """Rojtberg's angles, i from 1: midpoints of ever finer halves of the range, level by level.
    For +-70: -35, 35, -52.5, -17.5, 17.5, 52.5, ... (without 0, parallel to the image)."""
    level, first = 2, 1
    while i >= first + level:
        first, level = first + level, level * 2
    return -half_range_deg + 2 * half_range_deg * (i - first + 0.5) / level


def paper_pose(space: Space, parameter: str, state: HeuristicState) -> HeuristicPose:
    """The paper's pose for `parameter`: eqs (10), (11), or the distortion window."""
    if parameter not in _ABOUT_X + _ABOUT_Y:
        return _distortion_pose(space, parameter, state)
    # z is not given: use the nearest at which the whole board is seen, which is the most
    # informative.
    wanted = _nearest_visible(space, _turned(parameter, state, paper_angle_deg))
    return _finished(space, wanted, parameter, state.after(parameter))


def rojtberg_pose(space: Space, parameter: str, state: HeuristicState) -> HeuristicPose:
    """Rojtberg's pose for `parameter`; the first one is frontal and fills the image."""
    if not state.made:
        wanted = _nearest_visible(space, np.array([0.0, 0, 0, 0, 0, 1]))
        return _finished(space, wanted, parameter, state.after(parameter))
    if parameter not in _ABOUT_X + _ABOUT_Y:
        return _distortion_pose(space, parameter, state)
    wanted = _turned(parameter, state, bisection_angle_deg)
    wanted[5] = z = _ORBIT_WIDTHS * space.board.width
    if parameter in ("cx", "cy"):
        sign = 1 if state.count(parameter) % 2 == 0 else -1
        wanted[3] = sign * _SHIFT * space.camera.width / space.camera.fx * z
        wanted[4] = sign * _SHIFT * space.camera.height / space.camera.fy * z
    return _finished(space, wanted, parameter, state.after(parameter))


def distortion_map(camera: Camera) -> Array:
    """(rows, columns) displacement of the cells' points by the distortion, pixels: against the
    pinhole or, of a wide lens, against the equidistant one. 0 where no ray comes from."""
    columns, rows = camera.width // CELL_PX, camera.height // CELL_PX
    u = (np.arange(columns) + 0.5) * camera.width / columns - 0.5
    v = (np.arange(rows) + 0.5) * camera.height / rows - 0.5
    f, c = np.array([camera.fx, camera.fy]), np.array([camera.cx, camera.cy])
    ideal = (np.stack(np.meshgrid(u, v), axis=-1) - c) / f
    if camera.lens.is_perspective:
        return np.linalg.norm((camera.distort(ideal) - ideal) * f, axis=-1)
    rays = np.moveaxis(EQUIDISTANT.rays((), ideal), -1, 0)
    moved = np.moveaxis(camera.lens.image(camera.coefficients, rays), 0, -1) - ideal
    is_seen = np.isfinite(moved).all(axis=-1) & camera.reaches(rays)
    return np.where(is_seen, np.linalg.norm(moved * f, axis=-1), 0.0)


def distortion_window(
    board: Board, camera: Camera, used: tuple[Window, ...] = ()
) -> tuple[Window, bool]:
    """The window of the board's shape with the largest distortion not yet shown, `WINDOW_WIDTH`
    wide, and whether a new round started because everything had been shown."""
    strength = distortion_map(camera)
    rows, columns = strength.shape
    cell = np.array([camera.width / columns, camera.height / rows])
    # While the distortion is unknown, weight the border most, by a cone.
    v, u = np.mgrid[:rows, :columns]
    strength = strength + 1e-6 * np.hypot(u - (columns - 1) / 2, v - (rows - 1) / 2)
    width = WINDOW_WIDTH * camera.width
    shape = np.array([width, min(width * board.height / board.width, camera.height)])
    across, down = (np.maximum(1, np.round(shape / cell))).astype(int)
    free = strength.copy()
    for window in used:
        left, top = np.round(np.array([window.x, window.y]) / cell).astype(int)
        free[top : top + down, left : left + across] = 0.0
    again = float(free.max()) <= 0.0
    sums = np.zeros((rows + 1, columns + 1))
    sums[1:, 1:] = (strength if again else free).cumsum(axis=0).cumsum(axis=1)
    inside = sums[down:, across:] - sums[:-down, across:]
    inside = inside - sums[down:, :-across] + sums[:-down, :-across]
    top, left = np.unravel_index(int(np.argmax(inside)), inside.shape)
    x, y = np.array([left, top]) * cell
    return Window(float(x), float(y), float(across * cell[0]), float(down * cell[1])), again


def window_pose(board: Board, camera: Camera, window: Window) -> Pose:
    """The pose parallel to the image in which the board fills the window's width; for a wide lens
    the board faces it instead: beside the lens, none is parallel to the image."""
    centre = [window.x + window.width / 2 - 0.5, window.y + window.height / 2 - 0.5]
    if not camera.lens.is_perspective:
        return _facing(board, camera, window)
    ray = camera.unproject(np.array(centre))
    if not np.isfinite(ray).all():
        ray = camera.without_distortion().unproject(np.array(centre))
    z = camera.fx * board.width / window.width
    return Pose(np.eye(3), z * np.array([ray[0] / ray[2], ray[1] / ray[2], 1.0]))


def _facing(board: Board, camera: Camera, window: Window) -> Pose:
    y = window.y + window.height / 2 - 0.5
    x = window.x - 0.5 + window.width * np.array([0.5, 0.0, 1.0])
    centre, left, right = rays_towards(camera, np.column_stack([x, np.full(3, y)]))
    half = np.arccos(np.clip(left @ right, -1.0, 1.0)) / 2
    turn = Rotation.align_vectors(centre[None], np.array([[0.0, 0.0, 1.0]]))[0]
    return Pose(turn.as_matrix(), board.width / 2 / np.tan(max(float(half), 1e-3)) * centre)


def _turned(parameter: str, state: HeuristicState, angle_deg: Callable[[int], float]) -> Array:
    """(6,) the parameter's next turn, eq. (10), on the optical axis one metre away."""
    about_y = parameter in _ABOUT_Y
    angle = angle_deg(1 + state.count(*(_ABOUT_Y if about_y else _ABOUT_X)))
    return np.array([*((0.0, angle) if about_y else (angle, 0.0)), ROLL_DEG, 0.0, 0.0, 1.0])


def _finished(space: Space, wanted: Array, parameter: str, state: HeuristicState) -> HeuristicPose:
    vector, note = brought_within(space.board, space.camera, space.limits, wanted)
    return HeuristicPose(vector, parameter, state, note)


def _distortion_pose(space: Space, parameter: str, state: HeuristicState) -> HeuristicPose:
    window, again = distortion_window(space.board, space.camera, state.windows)
    begun = replace(state, windows=()) if again else state
    wanted = window_pose(space.board, space.camera, window).vector()
    return _finished(space, wanted, parameter, begun.after(parameter, window))


def _nearest_visible(space: Space, vector: Array) -> Array:
    """The vector at the smallest distance at which the limits hold. If the tilt alone breaks them,
    only the image's border counts; the rest is for `brought_within`."""
    limits = space.limits
    distances = np.geomspace(limits.nearest, limits.farthest, 121)
    candidates = np.tile(vector, (distances.size, 1))
    candidates[:, 5] = distances
    seen_only = replace(limits, max_tilt_deg=90.0, max_depth_ratio=np.inf, min_square_px=0.0)
    for bounds in (limits, seen_only):
        good = np.flatnonzero(bounds.accepts(space.camera, space.board, candidates))
        if good.size:
            return candidates[good[0]]
    return candidates[distances.size // 2]

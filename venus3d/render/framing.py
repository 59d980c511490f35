"""What a view of the scene must show, and the direction in which it is seen best.

A view frames the camera's frustum, the board as it is held, the target, and the steps' outlines and
arrows; whatever else is drawn is background. Of some hundred directions behind, above and beside
the camera, from which right is right, that one is taken from which

- the line of sight meets no board at less than 25 degrees, that is, none is seen edge-on, neither
  now nor on its way to the target,
- the printed side of the boards is seen,
- no arrow of the active step points along the line of sight within 20 degrees,
- all this is close to the direction that one is used to, and large.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.shapes import (
    FrustumShape,
    GridShape,
    LabelShape,
    LineShape,
    MeshShape,
    PointShape,
    Shape,
)
from venus3d.render.step_shapes import arrow_direction, pose_during
from venus3d.render.viewpoints import BEHIND, eyes_along, view_axes

FLATTEST_DEG, FLATTEST_ARROW_DEG = 25.0, 20.0
"""Smallest angles between the line of sight and a board, or an arrow, of a good view."""
_WANTED_DEG, _WANTED_ARROW_DEG = 38.0, 32.0
"""Angles beyond which more is not better."""
_USUAL = BEHIND / np.linalg.norm(BEHIND)
_BACK, _ON_THE_WAY, _LATER = 2.5, 6.0, 1.0
"""What a board seen from behind costs, where one that is seen edge-on costs 5; the weights of the
board on its way, on average, and of each step's arrow, where what is drawn now counts as 1."""
_HIDDEN = 6.0
_MUCH, _VERY_MUCH = 0.2, 0.35
"""How much better another direction must be than the present one, if that is bad, or good."""
_FRAMED = (
    "/board/",
    "/target/",
    "/steps/",
    "/strip/",
    "/camera/",
    "/views/",
    "/search/b",
    "/search/sheet",
)
_SHARES = (0.25, 0.5, 0.75, 1.0)
"""Moments of each step at which the board on its way is judged."""
_BOARDS = ("/board/live", "/target/board")
_LONGEST_AZIMUTH_DEG = 72.0  # at 90 right and left would change places
_AZIMUTHS = np.radians(np.arange(-_LONGEST_AZIMUTH_DEG, _LONGEST_AZIMUTH_DEG + 1, 8.0))
_GRID = np.stack(np.meshgrid(np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 4), [0.0]), -1)
_GRID = _GRID.reshape(-1, 3)
_HEIGHTS = np.radians(np.arange(-14.0, 75.0, 8.0))


@dataclass(frozen=True, eq=False)
class Content:
    """What a view must show; camera frame, metres."""

    points: Array
    """(N, 3) all of it lies within their hull."""
    surface: Array
    """(S, 3) points spread over the boards."""
    boards: Array
    """(B, 2, 3) centre of each board, and the direction in which its printed side faces."""
    arrows: Array
    """(A, 2, 3) centre of each arrow of the active step, and its direction."""
    picture: Array
    """(3,) half width, half height and depth of the frustum's picture, which may hide a board."""
    steps: tuple[Step, ...] = ()
    """Those that remain, without idle ones."""

    @cached_property
    def way(self) -> Array:
        """(W, 2, 3) like `boards`: the board at moments of its way to the target."""
        return _facing(pose_during(step, share) for step in self.steps for share in _SHARES)

    @cached_property
    def later_arrows(self) -> Array:
        """(N, 2, 3) like `arrows`, roughly: those of all the steps."""
        arrows = [[pose_during(step, 0.5).t, arrow_direction(step)] for step in self.steps]
        return np.array(arrows).reshape(-1, 2, 3)


def content_of(shapes: Iterable[Shape], steps: Iterable[Step] = ()) -> Content:
    """The part of these shapes that a view must show, and the way of the board that remains."""
    framed = [shape for shape in shapes if shape.name.startswith(_FRAMED)]
    boards = [s for s in framed if s.name in _BOARDS and isinstance(s, MeshShape | LineShape)]
    arrows = [
        _axis_of(shape)
        for shape in framed
        if isinstance(shape, MeshShape) and shape.name.startswith("/steps/")
        if shape.name.endswith("/arrow")
    ]
    return Content(
        np.concatenate([points_of(shape) for shape in framed] or [np.zeros((0, 3))]),
        np.array([_surface(board) for board in boards]).reshape(-1, 3),
        _facing(b.pose for b in boards),
        np.array(arrows).reshape(-1, 2, 3),
        picture_among(framed),
        tuple(step for step in steps if not step.is_idle),
    )


def _facing(boards: Iterable[Pose]) -> Array:
    """(B, 2, 3) centres of boards, and the directions in which their printed sides face."""
    return np.array([[pose.t, -pose.R[:, 2]] for pose in boards]).reshape(-1, 2, 3)


@lru_cache(maxsize=256)
def points_of(shape: Shape) -> Array:
    """(N, 3) few points whose hull holds the shape, up to a small part of its size."""
    if isinstance(shape, LabelShape):
        return shape.position.reshape(1, 3)
    if isinstance(shape, PointShape):
        return shape.points.reshape(-1, 3)
    if isinstance(shape, GridShape):  # it has no end
        return np.zeros((0, 3))
    if isinstance(shape, FrustumShape):
        return _frustum_points(shape)
    return shape.pose.apply(_outermost(_own_points(shape)))


def _own_points(shape: MeshShape | LineShape) -> Array:
    own = shape.mesh.vertices if isinstance(shape, MeshShape) else shape.segments
    return np.asarray(own, dtype=np.float64).reshape(-1, 3)


def _surface(board: MeshShape | LineShape) -> Array:
    """(20, 3) a grid of points on a board."""
    low, high = np.min(own := _own_points(board), axis=0), np.max(own, axis=0)
    return board.pose.apply(low + _GRID * (high - low))


def picture_among(shapes: Iterable[Shape]) -> Array:
    """(3,) half width, half height and depth of the frustum's picture; zeros without one."""
    return next((_picture(s) for s in shapes if isinstance(s, FrustumShape)), np.zeros(3))


def _picture(shape: FrustumShape) -> Array:
    # The inverse of frustum.frustum: viser gives a frustum a volume.
    slope = np.tan(shape.fov_y_rad / 2)
    depth = shape.scale / np.cbrt(slope**2 * shape.aspect / 3)
    return depth * np.array([slope * shape.aspect, slope, 1.0])


def _frustum_points(shape: FrustumShape) -> Array:
    signs = np.array([[0, 0, 0], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
    return signs * _picture(shape)


@lru_cache(maxsize=1)
def _all_around() -> Array:
    """(3, 26) directions to the faces, edges and corners of a cube."""
    grid = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3), axis=-1).reshape(-1, 3)
    grid = grid[np.any(grid != 0, axis=1)]
    return (grid / np.linalg.norm(grid, axis=1, keepdims=True)).T


def _outermost(points: Array) -> Array:
    if len(points) <= 26:
        return points
    return points[np.unique(np.argmax(points @ _all_around(), axis=0))]


@lru_cache(maxsize=64)
def _axis_of(arrow: MeshShape) -> Array:
    """(2, 3) centre and longest axis of an arrow: of a bent one, roughly from tail to tip."""
    points = arrow.pose.apply(np.asarray(arrow.mesh.vertices, dtype=np.float64))
    centre = points.mean(axis=0)
    longest = np.linalg.eigh((points - centre).T @ (points - centre))[1][:, -1]
    return np.stack([centre, longest])


# -- the direction ---------------------------------------------------------------------------------


def best_direction(content: Content, aspect: float, present: Array | None = None) -> Array:
    """(3,) unit vector along which this content is best seen, in a window of this width over
    height. `present`, the direction at the moment, is kept while it is good."""
    known = [_USUAL] if present is None else [present, _USUAL]
    directions = np.concatenate([known, _directions()])
    costs, bad = _judge(content, directions, aspect)
    best = int(np.argmin(costs))
    if present is not None and costs[0] < costs[best] + (_MUCH if bad[0] else _VERY_MUCH):
        return present
    return directions[best]


def good_direction(content: Content, aspect: float, usual: Array) -> Array:
    """(3,) the usual direction, unless it misses one of the two bars; then the best one."""
    _, bad = _judge(content, usual[None], aspect)
    return best_direction(content, aspect) if bad[0] else usual


@lru_cache(maxsize=1)
def _directions() -> Array:
    """(D, 3) unit vectors, from behind the camera forward."""
    azimuth, height = (a.ravel() for a in np.meshgrid(_AZIMUTHS, _HEIGHTS))
    flat = np.cos(height)
    return np.column_stack([-flat * np.sin(azimuth), np.sin(height), flat * np.cos(azimuth)])


def _judge(content: Content, directions: Array, aspect: float) -> tuple[Array, NDArray[np.bool_]]:
    """(D,) how much is amiss in each direction, and (D,) whether one of the two bars is missed."""
    points = _outermost(content.points)
    eyes = eyes_along(view_axes(directions), points, aspect)
    boards, arrows = sight_angles_deg(content, eyes)
    flat = np.abs(boards)
    bad = np.any(flat < FLATTEST_DEG, axis=1) | np.any(arrows < FLATTEST_ARROW_DEG, axis=1)
    costs = _unseen(boards).sum(axis=1)
    costs += _lacking(arrows, FLATTEST_ARROW_DEG, _WANTED_ARROW_DEG).sum(axis=1)
    if content.steps:
        costs += _ON_THE_WAY * _unseen(_toward_deg(content.way, eyes)).mean(axis=1)
        later = 90.0 - np.abs(_toward_deg(content.later_arrows, eyes))
        costs += _LATER * _lacking(later, FLATTEST_ARROW_DEG, _WANTED_ARROW_DEG).sum(axis=1)
    costs += 0.5 * np.square(np.arccos(np.clip(directions @ _USUAL, -1, 1)))
    costs += _HIDDEN * _hidden(content, eyes)
    away = np.linalg.norm(eyes - points.mean(axis=0), axis=1)
    return costs + 1.5 * np.log(away / away.min()), bad


def _hidden(content: Content, eyes: Array) -> Array:
    """(D,) share of the boards that the frustum's picture hides from each eye (D, 3)."""
    if not len(content.surface):
        return np.zeros(len(eyes))
    return np.mean(shares_at_picture(content.surface, eyes, content.picture) < 1, axis=1)


def shares_at_picture(points: Array, eyes: Array, picture: Array) -> Array:
    """(D, N) the share of the way from each eye (D, 3) to each of these points (N, 3) at which the
    line of sight passes the frustum's `picture` (`picture_among`); 1 where it does not."""
    rays = points[None] - eyes[:, None]
    share = (picture[2] - eyes[:, None, 2]) / np.where(
        np.abs(rays[..., 2]) < 1e-9, 1e-9, rays[..., 2]
    )
    across = np.abs(eyes[:, None, :2] + share[..., None] * rays[..., :2])
    passes = (share > 0) & (share < 1) & np.all(across < picture[:2], axis=2)
    return np.where(passes, share, 1.0)


def sight_angles_deg(content: Content, eyes: Array) -> tuple[Array, Array]:
    """Angles at which lines of sight from each eye (D, 3) meet the content: (D, B) the boards'
    planes, negative from behind; (D, A) the arrows."""
    boards, arrows = (_toward_deg(places, eyes) for places in (content.boards, content.arrows))
    return boards, 90.0 - np.abs(arrows)


def _toward_deg(places: Array, eyes: Array) -> Array:
    """(D, P) how far a direction of `places` (P, 2, 3), a centre and a direction each, leans
    towards each eye (D, 3): 90 straight to it, 0 across the line of sight."""
    to_eye = eyes[:, None] - places[None, :, 0]
    to_eye = to_eye / np.linalg.norm(to_eye, axis=2, keepdims=True)
    return np.degrees(np.arcsin(np.clip((to_eye * places[None, :, 1]).sum(axis=2), -1, 1)))


def _unseen(boards: Array) -> Array:
    """(D, B) how badly boards are seen at these angles (D, B): edge-on worst, then from behind."""
    return _lacking(np.abs(boards), FLATTEST_DEG, _WANTED_DEG) + _BACK * (boards < 0)


def _lacking(angles: Array, least: float, wanted: float) -> Array:
    """(D, P) by how much the angles (D, P) are too small; below `least` it counts more."""
    little = np.clip((wanted - angles) / wanted, 0, 1)
    return 2 * little**2 + 3 * np.clip((least - angles) / least, 0, 1)

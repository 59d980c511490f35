"""What makes left, right, near and up explain themselves in the scene: a floor, lines that drop
from board and target to it, and a grey figure who holds the board and faces the camera. None of it
is in the camera's pictures, and none of it counts where a view is fitted."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import trimesh

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.render.arrows import frame_along
from venus3d.render.palette import ground, mixed
from venus3d.render.shapes import Colour, GridShape, LineShape, MeshShape, Shape

FLOOR = 0.45
"""How far the floor is below the camera, metres: the height of a table, so that it is in sight."""
_CELL, _SECTION = 0.1, 0.5
_RING = 0.03
"""Radius of the ring where a drop line meets the floor, metres."""
_CHEST = np.array([0.0, -0.14, 0.36])
"""The figure's chest, between the shoulders, from the board's centre."""
_SHOULDER = 0.19
_UPPER_ARM, _FOREARM = 0.28, 0.27
_OPACITY = 0.3
_trimesh: Any = trimesh  # its annotations leave most return types open


@lru_cache(maxsize=2)
def floor(dark: bool) -> GridShape:
    """The grid below the camera: a line each 10 cm, a stronger one each 50 cm."""
    colours = ground(dark)
    fine, strong = (mixed(colours.background, colours.text, share) for share in (0.16, 0.3))
    return GridShape("/ground/grid", FLOOR, _CELL, _SECTION, fine, strong)


@lru_cache(maxsize=64)
def drop_line(pose: Pose, name: str, colour: Colour) -> LineShape:
    """From the board's centre down to a ring on the floor."""
    x, y, z = pose.t
    # In whole centimetres, so that a moving board is mostly the same line at another place.
    segments = _drop_segments(round(max(FLOOR - y, 0.0), 2))
    foot = Pose(np.eye(3), np.array([x, max(y, FLOOR), z]))
    return LineShape(f"/ground/{name}", segments, foot, colour, 1.5, in_projection=False)


@lru_cache(maxsize=128)
def _drop_segments(height: float) -> Array:
    """(25, 2, 3) the ring about the origin, and the line up from it."""
    angles = np.linspace(0, 2 * np.pi, 25)
    ring = _RING * np.column_stack([np.cos(angles), np.zeros(25), np.sin(angles)])
    line = np.array([[[0.0, 0.0, 0.0], [0.0, -height, 0.0]]])
    return np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1), line])


def surroundings(board: Board, pose: Pose | None, target: Pose | None, dark: bool) -> list[Shape]:
    """Floor and drop lines, and the figure who holds the board at `pose`."""
    colours = ground(dark)
    shapes: list[Shape] = [floor(dark)]
    if target is not None:
        shapes.append(drop_line(target, "below_target", colours.ghost))
    if pose is not None:
        shapes.append(drop_line(pose, "below_board", colours.ghost))
        shapes += figure(board, pose, dark)
    return shapes


def figure(board: Board, pose: Pose, dark: bool) -> list[Shape]:
    """Head and trunk, two upper arms, two forearms. The same meshes at other poses when the board
    moves."""
    colours = ground(dark)
    colour = mixed(colours.background, colours.text, 0.5)
    chest = pose.t + _CHEST
    shapes = [_part("body", _body(), Pose(np.eye(3), chest), colour)]
    for side, hand in zip((1.0, -1.0), _hands(board, pose), strict=True):
        shoulder = chest + side * _SHOULDER * np.eye(3)[0]
        elbow, hand = _bent_arm(shoulder, hand, side)
        name = "left" if side > 0 else "right"  # the figure's own, who faces the camera
        upper, lower = frame_along(elbow - shoulder, shoulder), frame_along(hand - elbow, elbow)
        shapes.append(_part(f"{name}_upper_arm", _limb(_UPPER_ARM, 0.042), upper, colour))
        shapes.append(_part(f"{name}_forearm", _limb(_FOREARM, 0.034), lower, colour))
    return list(shapes)


def _part(name: str, mesh: trimesh.Trimesh, pose: Pose, colour: Colour) -> MeshShape:
    return MeshShape(f"/figure/{name}", mesh, pose, colour, _OPACITY, in_projection=False)


def _hands(board: Board, pose: Pose) -> tuple[Array, Array]:
    """Where the left and the right hand hold the board: at the two opposite edges that are
    farthest apart from left to right."""
    reach = [np.array([board.width / 2, 0.0, 0.0]), np.array([0.0, board.height / 2, 0.0])]
    along = max((pose.R @ r for r in reach), key=lambda edge: abs(float(edge[0])))
    along = along if along[0] > 0 else -along
    return pose.t + along, pose.t - along


def _bent_arm(shoulder: Array, hand: Array, side: float) -> tuple[Array, Array]:
    """The elbow, below and outside, and the hand, drawn back if it is out of reach."""
    way = hand - shoulder
    distance = float(np.linalg.norm(way))
    ahead = way / distance
    distance = min(distance, 0.999 * (_UPPER_ARM + _FOREARM))
    along = (_UPPER_ARM**2 - _FOREARM**2 + distance**2) / (2 * distance)
    down = np.array([0.6 * side, 1.0, 0.3])
    down = down - (down @ ahead) * ahead
    down = down / np.linalg.norm(down)
    bend = np.sqrt(max(_UPPER_ARM**2 - along**2, 0.0))
    return shoulder + along * ahead + bend * down, shoulder + distance * ahead


@lru_cache(maxsize=1)
def _body() -> trimesh.Trimesh:
    """Head, nose, neck and trunk; the origin between the shoulders, facing -z."""
    head = _ball(1.0, 2)
    head.apply_scale([0.078, 0.108, 0.095])
    head.apply_translation([0.0, -0.24, -0.01])
    nose = _ball(0.02)
    nose.apply_translation([0.0, -0.235, -0.108])
    neck = _trimesh.creation.cylinder(0.042, segment=[[0, -0.04, 0], [0, -0.15, 0]], sections=16)
    ends = ((0.155, 0.0, 0.06), (0.05, -0.04, 0.05), (0.125, 0.22, 0.07), (0.12, 0.4, 0.075))
    corners = [
        np.add(_ball(radius).vertices, [side * x, y, 0.0])
        for x, y, radius in ends
        for side in (1, -1)
    ]
    trunk = _trimesh.convex.convex_hull(np.vstack(corners))
    return _trimesh.util.concatenate([head, nose, neck, trunk])


@lru_cache(maxsize=2)
def _limb(length: float, radius: float) -> trimesh.Trimesh:
    """A rounded limb from the origin to (0, 0, length)."""
    return _trimesh.creation.capsule(length, radius, count=[12, 12])


def _ball(radius: float, subdivisions: int = 1) -> Any:
    return _trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)

"""All that is wrong with a pose, named so that a person can mend it, the worst first.

`Limits` decides and has one sentence for the command line; here each broken limit is told, with
the corner or the turn that breaks it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import AXES, Array, rotations_of
from venus3d.engine.geometry.visibility import Visibility, visibility_of
from venus3d.engine.planning.limits import Limits

Kind = Literal["behind", "outside", "tilt", "angle", "near", "far", "depth", "small"]
# The first four and the last four of the points that `visibility_of` looks at.
_CORNERS = ("top left", "top right", "bottom right", "bottom left")
_EDGES = ("top", "right", "bottom", "left")
_SIDES = (("left", "right"), ("top", "bottom"))
_SLACK = 1e-9


@dataclass(frozen=True)
class Refusal:
    """One limit that a pose breaks."""

    kind: Kind
    text: str
    """One sentence."""
    excess: float
    """By how much, relative to what is allowed."""
    corners: tuple[int, ...] = ()
    """Which of the board's outline corners are to blame, 0 ... 3 clockwise from the top left."""


def refusals(
    limits: Limits, camera: Camera, board: Board, vector: ArrayLike
) -> tuple[Refusal, ...]:
    """Why a pose vector (6,), degrees and metres, is not asked of a person; empty if it may be."""
    p = np.asarray(vector, dtype=np.float64)
    sight = visibility_of(camera, board, p[None])
    found = [*_turned_too_far(limits, p), *_tilted(limits, sight)]
    if not sight.seen[0]:
        text = "Part of the board is beside or behind the lens, where it cannot be seen."
        found.append(Refusal("behind", text, np.inf))
    else:
        found += [*_outside(limits, camera, sight), *_small(limits, sight)]
    found += _distances(limits, board, p, sight)
    return tuple(sorted(found, key=lambda refusal: -refusal.excess))


def _turned_too_far(limits: Limits, p: Array) -> list[Refusal]:
    limit = limits.max_angle_deg
    return [
        Refusal(
            "angle",
            f"The turn about {axis.upper()} is {abs(angle):.0f}°; more than {limit:g}° is hard to "
            "hold.",
            abs(angle) / limit - 1,
        )
        for axis, angle in zip(AXES, p[:3].tolist(), strict=True)
        if abs(angle) > limit + _SLACK
    ]


def _tilted(limits: Limits, sight: Visibility) -> list[Refusal]:
    if sight.cosine[0] >= np.cos(np.radians(limits.max_tilt_deg)) - _SLACK:
        return []
    tilt = float(np.degrees(np.arccos(np.clip(sight.cosine[0], -1, 1))))
    text = (
        f"The board is tilted by {tilt:.0f}° away from the camera's line of sight; beyond "
        f"{limits.max_tilt_deg:g}° its pattern blurs."
    )
    if tilt > 90:
        text = "The camera sees the back of the board."
    return [Refusal("tilt", text, tilt / limits.max_tilt_deg - 1)]


def _outside(limits: Limits, camera: Camera, sight: Visibility) -> list[Refusal]:
    low, high = limits.frame(camera)
    pixels = sight.pixels[:, [0, 1, 2, 3, 12, 13, 14, 15], 0]
    border = limits.margin * camera.width
    found: list[Refusal] = []
    for axis in range(2):
        for side, past in enumerate((low[axis] - pixels[axis], pixels[axis] - high[axis])):
            if past.max() <= _SLACK:
                continue
            worst, name = int(np.argmax(past)), _SIDES[axis][side]
            who = _named(worst)
            if past[worst] > border:
                text = f"{who} leaves the picture {_where(name)} by {past[worst] - border:.0f} px."
            else:
                text = (
                    f"{who} is only {border - past[worst]:.0f} px from the picture's {name} edge; "
                    f"{border:.0f} px must stay free."
                )
            corners = tuple(int(i) for i in np.flatnonzero(past[:4] > _SLACK))
            found.append(Refusal("outside", text, float(past[worst]) / camera.width, corners))
    return found


def _named(point: int) -> str:
    if point < 4:
        return f"The {_CORNERS[point]} corner"
    return f"The middle of the {_EDGES[point - 4]} edge"


def _where(side: str) -> str:
    return f"on the {side}" if side in ("left", "right") else f"at the {side}"


def _small(limits: Limits, sight: Visibility) -> list[Refusal]:
    side, needed = float(sight.side[0]), limits.min_square_px
    if side >= needed - _SLACK:
        return []
    text = (
        f"The smallest square is {side:.0f} px wide in the picture; its marker is read from "
        f"{needed:.0f} px on."
    )
    return [Refusal("small", text, 1 - side / needed)]


def _distances(limits: Limits, board: Board, p: Array, sight: Visibility) -> list[Refusal]:
    corners = board.outline @ rotations_of(p)[0].T + p[3:]
    distances = np.linalg.norm(corners, axis=1)
    near, far = float(sight.near[0]), float(sight.far[0])
    nearest, farthest = int(np.argmin(distances)), int(np.argmax(distances))
    found: list[Refusal] = []
    if near < limits.nearest - _SLACK:
        text = (
            f"{_named(nearest)} is too near: {near * 1000:.0f} mm from the lens, and "
            f"{limits.nearest * 1000:.0f} mm is the nearest."
        )
        found.append(Refusal("near", text, 1 - near / limits.nearest, (nearest,)))
    if far > limits.farthest + _SLACK:
        text = (
            f"{_named(farthest)} is too far away: {far * 1000:.0f} mm from the lens, and "
            f"{limits.farthest * 1000:.0f} mm is the farthest."
        )
        found.append(Refusal("far", text, far / limits.farthest - 1, (farthest,)))
    ratio = far / max(near, 1e-9)
    if far > (limits.max_depth_ratio + _SLACK) * near:
        text = (
            f"{_named(farthest)} is {ratio:.1f} times as far away as the nearest one; beyond "
            f"{limits.max_depth_ratio:g} times, not all of the board is in focus."
        )
        found.append(Refusal("depth", text, ratio / limits.max_depth_ratio - 1, (farthest,)))
    return found

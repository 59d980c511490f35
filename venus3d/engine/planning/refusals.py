"""Why a pose is not allowed as a target, in sentences that help to correct it, worst first.

`Limits.margins` decides; here each broken limit is named, with the corner or turn that breaks it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import AXES, Array, rotations_of
from venus3d.engine.geometry.visibility import Visibility, visibility_of
from venus3d.engine.planning.limits import RULES, SLACK, Limits, Rule

# The first four and last four of the points of `visibility_of`.
_POINTS = (
    "The top left corner",
    "The top right corner",
    "The bottom right corner",
    "The bottom left corner",
    "The middle of the top edge",
    "The middle of the right edge",
    "The middle of the bottom edge",
    "The middle of the left edge",
)
_SIDES = (
    ("left", "on the left"),
    ("right", "on the right"),
    ("top", "at the top"),
    ("bottom", "at the bottom"),
)

ANGLE = "The turn about {axis} is {value:.0f}°; more than {limit:g}° is hard to hold."
TILT = (
    "The board is tilted by {value:.0f}° away from the camera's line of sight; beyond {limit:g}° "
    "its pattern blurs."
)
BACK = "The camera sees the back of the board."
BEHIND = "Part of the board is beside or behind the lens, where it cannot be seen."
NEAR = "{point} is too near: {value:.0f} mm from the lens, and {limit:.0f} mm is the nearest."
FAR = "{point} is too far away: {value:.0f} mm from the lens, and {limit:.0f} mm is the farthest."
DEPTH = (
    "{point} is {value:.1f} times as far away as the nearest one; beyond {limit:g} times, not all "
    "of the board is in focus."
)
OUTSIDE = "{point} leaves the picture {side} by {value:.0f} px."
AT_THE_EDGE = (
    "{point} is only {value:.0f} px from the picture's {side} edge; {limit:.0f} px must stay free."
)
SMALL = (
    "The smallest square is {value:.0f} px wide in the picture; its marker is read from "
    "{limit:.0f} px on."
)


@dataclass(frozen=True)
class Refusal:
    """One limit that a pose breaks."""

    kind: Rule
    text: str
    """One sentence."""
    excess: float
    """By how much, relative to what is allowed."""
    corners: tuple[int, ...] = ()
    """The board's outline corners concerned, 0 ... 3 clockwise from the top left."""


def refusals(
    limits: Limits, camera: Camera, board: Board, vector: ArrayLike
) -> tuple[Refusal, ...]:
    """Why a pose vector (6,), degrees and metres, is not allowed; empty if it is."""
    p = np.asarray(vector, dtype=np.float64)
    seen = visibility_of(camera, board, p[None])
    margins = limits.margins(camera, p[None], seen)[:, 0]
    excess: dict[Rule, float] = dict(zip(RULES, (-margins).tolist(), strict=True))
    broken: list[Rule] = [rule for rule in RULES if excess[rule] > SLACK]
    if "behind" in broken:  # nothing is known of the image
        broken = [rule for rule in broken if rule != "outside" and rule != "small"]
    found: list[Refusal] = []
    for rule in broken:
        if rule == "angle":
            found += _angles(limits, p)
        elif rule == "outside":
            found += _sides(limits, camera, seen)
        else:
            text, corners = _sentence(rule, limits, board, p, seen)
            worst = np.inf if rule == "behind" else excess[rule]
            found.append(Refusal(rule, text, worst, corners))
    return tuple(sorted(found, key=lambda refusal: -refusal.excess))


def _sentence(
    rule: Rule, limits: Limits, board: Board, p: Array, seen: Visibility
) -> tuple[str, tuple[int, ...]]:
    """The sentence for a rule that is broken at one place only, and the corner concerned."""
    distances = np.linalg.norm(board.outline @ rotations_of(p)[0].T + p[3:], axis=1)
    nearest, farthest = int(np.argmin(distances)), int(np.argmax(distances))
    near, far = 1000 * distances[nearest], 1000 * distances[farthest]
    tilt = np.degrees(np.arccos(np.clip(seen.cosine[0], -1, 1)))
    match rule:
        case "tilt":
            text = BACK if tilt > 90 else TILT.format(value=tilt, limit=limits.max_tilt_deg)
            return text, ()
        case "near":
            text = NEAR.format(point=_POINTS[nearest], value=near, limit=1000 * limits.nearest)
            return text, (nearest,)
        case "far":
            text = FAR.format(point=_POINTS[farthest], value=far, limit=1000 * limits.farthest)
            return text, (farthest,)
        case "depth":
            ratio = far / max(near, 1e-6)
            text = DEPTH.format(point=_POINTS[farthest], value=ratio, limit=limits.max_depth_ratio)
            return text, (farthest,)
        case "small":
            return SMALL.format(value=seen.side[0], limit=limits.min_square_px), ()
        case _:
            return BEHIND, ()


def _angles(limits: Limits, p: Array) -> Iterator[Refusal]:
    limit = limits.max_angle_deg
    for axis, angle in zip(AXES, np.abs(p[:3]).tolist(), strict=True):
        if angle / limit - 1 > SLACK:
            text = ANGLE.format(axis=axis.upper(), value=angle, limit=limit)
            yield Refusal("angle", text, angle / limit - 1)


def _sides(limits: Limits, camera: Camera, seen: Visibility) -> Iterator[Refusal]:
    """Each border of the image that the board crosses, by the point farthest outside."""
    low, high = limits.frame(camera)
    x, y = seen.pixels[:, [0, 1, 2, 3, 12, 13, 14, 15], 0]
    border = limits.margin * camera.width
    for (side, where), past in zip(
        _SIDES, (low[0] - x, x - high[0], low[1] - y, y - high[1]), strict=True
    ):
        worst = int(np.argmax(past))
        beyond = float(past[worst])
        if beyond / camera.width <= SLACK:
            continue
        if beyond > border:
            text = OUTSIDE.format(point=_POINTS[worst], side=where, value=beyond - border)
        else:
            text = AT_THE_EDGE.format(
                point=_POINTS[worst], side=side, value=border - beyond, limit=border
            )
        corners = tuple(int(i) for i in np.flatnonzero(past[:4] > 0))
        yield Refusal("outside", text, beyond / camera.width, corners)

"""The limits on target poses, the margin that a pose leaves to each, and why one is refused.

Everything uses `Limits.margins`: `accepts`, the sentences of `refusals`, the corrections in
`pose_space`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from venus3d.engine.amounts import whole
from venus3d.engine.calibration.legibility import legible_square_px
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.pose import AXES, Array, rotations_of
from venus3d.engine.geometry.visibility import Visibility, visibility_of
from venus3d.engine.sentences import Sentence

Mask = NDArray[np.bool_]
SLACK = 1e-9
"""Of a margin: a pose exactly on a limit must not be lost to rounding."""
_OF_WIDEST = 0.75
"""Share of the largest square that a wide lens shows at a board's end, asked for at most: half of
the poses that are within the other limits are within this one."""
WIDEST = float(np.radians(88.0))
"""From the axis to a board's centre: nothing is held behind a lens that sees there."""

Rule = Literal["angle", "tilt", "behind", "near", "far", "depth", "outside", "small"]
RULES: tuple[Rule, ...] = get_args(Rule)
"""angle: of the pose vector; tilt: of the board to the line of sight; behind: the lens, or beyond
the lens model; near, far, depth: the corners' distances and their ratio; outside: the image;
small: the squares in it."""


@dataclass(frozen=True)
class Limits:
    """Limits of a target. Without them the best view is absurd: 15 cm away, tilted 75°."""

    max_angle_deg: float = 70.0
    """Each angle of the pose vector, degrees (the paper's solution space, 3.3.1)."""
    max_tilt_deg: float = 55.0
    """Between the board's normal and the line of sight to its centre: beyond, corners blur."""
    nearest: float = 0.2
    """Least distance of the board's corners from the lens, metres."""
    farthest: float = 1.2
    """Largest distance, metres."""
    max_depth_ratio: float = 2.2
    """Farthest over nearest corner, before a wide lens over the nearest point: limited by the depth
    of field, and by how different circles may be in size."""
    margin: float = 0.02
    """Free border around the whole board, as a fraction of the image's width."""
    min_square_px: float = 12.0
    """The shortest side of a square in the image, pixels: below it markers are not detected."""

    @staticmethod
    def for_board(board: Board, camera: Camera) -> Limits:
        """The default limits, adapted where they do not suit the board.

        A square is at least the default's 12 px, and large enough for its marker to be read
        (`legible_square_px`).

        `z_fill` is the distance at which the frontal board fills the image, `z_small` the one at
        which its squares become too small. The default 0.2 ... 1.2 m stays if it leaves room
        between the two (farthest over nearest usable distance at least 1.6). Otherwise the
        distances become the multiples 0.75 and 4.5 of `z_fill`, as for the default board and a
        usual webcam.
        """
        least = max(Limits.min_square_px, legible_square_px(board))
        if not camera.lens.is_perspective:
            # f s z / (z^2 + x^2) at the end x of a board that faces the lens is at most f s / 2 x:
            # no pose of a wide board shows larger squares.
            widest = min(camera.fx, camera.fy) * board.square / max(board.width, board.height)
            least = min(least, _OF_WIDEST * widest)
        limits = Limits(min_square_px=least)
        room = 1 - 2 * limits.margin
        height_px = camera.height - 2 * limits.margin * camera.width
        z_fill = max(
            _filling_distance(camera, board.width, room * camera.width / camera.fx),
            _filling_distance(camera, board.height, height_px / camera.fy),
        )
        z_small = min(camera.fx, camera.fy) * board.square / limits.min_square_px
        usable = min(limits.farthest, z_small) / max(limits.nearest, z_fill)
        # A far limit below 1.6 z_fill would forbid nearly all; one set by z_small cannot be moved.
        if usable >= 1.6 or (limits.nearest <= z_fill and z_small <= limits.farthest):
            return limits
        return replace(limits, nearest=0.75 * z_fill, farthest=4.5 * z_fill)

    def accepts(self, camera: Camera, board: Board, vectors: ArrayLike) -> Mask:
        """Which of the pose vectors (N, 6) are within the limits: (N,) bool."""
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        # Most candidates of a search fail the cheap tests; only the rest is projected.
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = np.einsum("ni,ni->n", _normals(p), p[:, 3:]) / np.linalg.norm(p[:, 3:], axis=1)
        good = cosine >= np.cos(np.radians(self.max_tilt_deg)) - SLACK
        good &= (p[:, 5] > 0) & (p[:, 5] <= self.farthest)
        left = np.flatnonzero(good)
        good[left] = self.within(camera, p[left], visibility_of(camera, board, p[left]))
        return good

    def within(self, camera: Camera, vectors: Array, seen: Visibility) -> Mask:
        """As `accepts`, for pose vectors (N, 6) with known visibility."""
        return np.all(self.margins(camera, vectors, seen) >= -SLACK, axis=0)

    def margins(self, camera: Camera, vectors: Array, seen: Visibility) -> Array:
        """(8, N) margins of pose vectors (N, 6) to each of the `RULES`; negative if broken.

        As a share of the limit; for "outside" of the image's width. 1 or -1 for "behind", and -1
        for what cannot be measured of a board behind the lens.
        """
        low, high = (bound[:, None] for bound in self.frame(camera))
        # Behind the lens or absurdly far away, figures are meaningless and may be infinite.
        with np.errstate(invalid="ignore", over="ignore"):
            tilt = np.degrees(np.arccos(np.clip(seen.cosine, -1.0, 1.0)))
            border = np.minimum(seen.low - low, high - seen.high).min(axis=0)
            if camera.image_circle is not None:
                room = camera.image_circle.room(seen.pixels).min(axis=0)
                border = np.minimum(border, room - self.margin * camera.width)
            margins = np.stack(
                [
                    1 - np.abs(vectors[:, :3]).max(axis=1) / self.max_angle_deg,
                    1 - tilt / self.max_tilt_deg,
                    np.where(seen.seen, 1.0, -1.0),
                    (seen.near - self.nearest) / (self.nearest or 1.0),
                    1 - seen.far / self.farthest,
                    1 - seen.far / np.maximum(seen.closest, 1e-9) / self.max_depth_ratio,
                    border / camera.width,
                    (seen.side - self.min_square_px) / (self.min_square_px or 1.0),
                ]
            )
        margins[6:, ~seen.seen] = -1.0
        return np.where(np.isnan(margins), -1.0, margins)

    def excess(self, camera: Camera, board: Board, vectors: ArrayLike) -> Array:
        """By how much the limits are broken, (N,): 0 within them, else a slope to follow back.
        The broken `margins`, all together."""
        p = np.atleast_2d(np.asarray(vectors, dtype=np.float64))
        margins = self.margins(camera, p, visibility_of(camera, board, p))
        return np.maximum(-SLACK - margins, 0.0).sum(axis=0)

    def frame(self, camera: Camera) -> tuple[Array, Array]:
        """(2,) smallest and (2,) largest pixel allowed for the board: the image less a margin."""
        border = self.margin * camera.width - 0.5
        return np.full(2, border), np.array([camera.width - 1, camera.height - 1]) - border


def _filling_distance(camera: Camera, side: float, extent: float) -> float:
    """The distance at which a frontal board of this side, metres, has this extent in normalised
    image coordinates, on the axis and without distortion."""
    if camera.lens.is_perspective:
        return side / extent
    return side / 2 / float(np.tan(min(extent / 2, WIDEST)))


def _normals(vectors: Array) -> Array:
    """(N, 3) the board's z axes under pose vectors (N, 6): the last column of Rz Ry Rx."""
    (sx, sy, sz), (cx, cy, cz) = (f(np.radians(vectors[:, :3])).T for f in (np.sin, np.cos))
    return np.stack([cz * sy * cx + sz * sx, sz * sy * cx - cz * sx, cy * cx], axis=1)


# The first four and last four of the points of `visibility_of`.
_POINTS = (
    Sentence("The top left corner"),
    Sentence("The top right corner"),
    Sentence("The bottom right corner"),
    Sentence("The bottom left corner"),
    Sentence("The middle of the top edge"),
    Sentence("The middle of the right edge"),
    Sentence("The middle of the bottom edge"),
    Sentence("The middle of the left edge"),
)
# Each border of the image: that a point is beyond it, and that it is too near it.
_SIDES = (
    (
        Sentence("{point} leaves the picture on the left by {value} px."),
        Sentence(
            "{point} is only {value} px from the picture's left edge; {limit} px must stay free."
        ),
    ),
    (
        Sentence("{point} leaves the picture on the right by {value} px."),
        Sentence(
            "{point} is only {value} px from the picture's right edge; {limit} px must stay free."
        ),
    ),
    (
        Sentence("{point} leaves the picture at the top by {value} px."),
        Sentence(
            "{point} is only {value} px from the picture's top edge; {limit} px must stay free."
        ),
    ),
    (
        Sentence("{point} leaves the picture at the bottom by {value} px."),
        Sentence(
            "{point} is only {value} px from the picture's bottom edge; {limit} px must stay free."
        ),
    ),
)
_MORE_THAN = Sentence("more than {value}")

ANGLE = Sentence("The turn about {axis} is {value}°; more than {limit:g}° is hard to hold.")
TILT = Sentence(
    "The board is tilted by {value}° away from the camera's line of sight; beyond {limit:g}° "
    "its pattern blurs."
)
BACK = Sentence("The camera sees the back of the board.")
BEHIND = Sentence("Part of the board is beside or behind the lens, where it cannot be seen.")
NEAR = Sentence("{point} is too near: {value} mm from the lens, and {limit} mm is the nearest.")
FAR = Sentence("{point} is too far away: {value} mm from the lens, and {limit} mm is the farthest.")
DEPTH = Sentence(
    "{point} is {value:.1f} times as far away as the nearest one; beyond {limit:g} times, not all "
    "of the board is in focus."
)
SMALL = Sentence(
    "The smallest square is {value} px wide in the picture; its marker is read from {limit} px on."
)
SMALL_PLAIN = Sentence(
    "The smallest square is {value} px wide in the picture; the board is read from {limit} px on."
)
SMALL_CIRCLES = Sentence(
    "The smallest circle is {value} px wide in the picture; the board is read from {limit} px on."
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
    near, far = 1000 * float(distances[nearest]), 1000 * float(distances[farthest])
    closest, most = whole(1000 * limits.nearest), whole(1000 * limits.farthest)
    tilt = np.degrees(np.arccos(np.clip(seen.cosine[0], -1, 1)))
    match rule:
        case "tilt":
            text = BACK if tilt > 90 else TILT.format(value=whole(tilt), limit=limits.max_tilt_deg)
            return text, ()
        case "near":
            text = NEAR.format(point=_POINTS[nearest], value=whole(near), limit=closest)
            return text, (nearest,)
        case "far":
            text = FAR.format(point=_POINTS[farthest], value=whole(far), limit=most)
            return text, (farthest,)
        case "depth":
            ratio = far / max(1000 * float(seen.closest[0]), 1e-6)
            text = DEPTH.format(point=_POINTS[farthest], value=ratio, limit=limits.max_depth_ratio)
            return text, (farthest,)
        case "small":
            return _small(board, float(seen.side[0]), limits.min_square_px), ()
        case _:
            return BEHIND, ()


def _small(board: Board, side: float, limit: float) -> str:
    """By the sides of squares in pixels; circles are told by their diameters."""
    if board.has("dictionary"):
        return SMALL.format(value=whole(side), limit=whole(limit))
    if board.of_kind.radius(board) == 0:
        return SMALL_PLAIN.format(value=whole(side), limit=whole(limit))
    share = board.marker / board.square
    return SMALL_CIRCLES.format(value=whole(share * side), limit=whole(share * limit))


def _angles(limits: Limits, p: Array) -> Iterator[Refusal]:
    limit = limits.max_angle_deg
    for axis, angle in zip(AXES, np.abs(p[:3]).tolist(), strict=True):
        if angle / limit - 1 > SLACK:
            text = ANGLE.format(axis=axis.upper(), value=whole(angle), limit=limit)
            yield Refusal("angle", text, angle / limit - 1)


def _sides(limits: Limits, camera: Camera, seen: Visibility) -> Iterator[Refusal]:
    """Each border of the image that the board crosses, by the point farthest outside."""
    low, high = limits.frame(camera)
    x, y = seen.pixels[:, [0, 1, 2, 3, 12, 13, 14, 15], 0]
    border = limits.margin * camera.width
    for (outside, at_the_edge), past in zip(
        _SIDES, (low[0] - x, x - high[0], low[1] - y, y - high[1]), strict=True
    ):
        worst = int(np.argmax(past))
        beyond = float(past[worst])
        if beyond / camera.width <= SLACK:
            continue
        if beyond > border:
            by, most = whole(beyond - border), camera.width
            # Far outside, the distortion's polynomial gives pixels without a meaning.
            value = by if by <= most else _MORE_THAN.format(value=most)
            text = outside.format(point=_POINTS[worst], value=value)
        else:
            text = at_the_edge.format(
                point=_POINTS[worst], value=whole(border - beyond), limit=whole(border)
            )
        corners = tuple(int(i) for i in np.flatnonzero(past[:4] > 0))
        yield Refusal("outside", text, beyond / camera.width, corners)

"""The next target: the pose, its expected gain, and its purpose and hold in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from venus3d.engine.amounts import size_deg, whole
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PARAMETERS, Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.settings import Cost, Method

_FOCAL = {"fx": "horizontal", "fy": "vertical"}
_CENTRE = {"cx": "left to right", "cy": "up and down"}
_FULL = "over most"
# By row (middle, lower, upper) and column (middle, right, left), so that -1 is the last.
_PLACES = (
    ("in the middle", "on the right", "on the left"),
    ("at the bottom", "at the lower right", "at the lower left"),
    ("at the top", "at the upper right", "at the upper left"),
)
_LENS = ("k1", "k2", "k3", "p1", "p2")


@dataclass(frozen=True, eq=False)
class Target:
    """A pose for the user to reach, its purpose, and the steps to it."""

    number: int
    """Counts from 1; skipped targets are counted."""
    pose: Pose
    steps: Steps
    """Eq. (15): from the frontal, upright board to the target."""
    method: Method
    cost: Cost
    serves: tuple[str, ...]
    """The parameters this view helps most, best first."""
    reason: str
    """One sentence: the purpose of this pose."""
    predicted_sigma: Array
    """(9,) expected standard deviations after this view; NaN if unknown."""
    predicted_uncertainty_px: float
    """Projection uncertainty over the image after this view, pixels; NaN if unknown."""
    evaluated: int
    """Number of candidate poses evaluated."""
    search_s: float
    """Duration of the search."""
    uncertainty_px: float = float("nan")
    """Projection uncertainty over the image before this view, pixels; NaN if unknown."""
    alternatives: tuple[Target, ...] = ()
    """Clearly different poses that are nearly as good, best first."""
    held: str = ""
    """How the board is held, in a few words: upright or turned, place, tilt, distance."""

    @property
    def gain_px(self) -> float:
        """Expected drop of the projection uncertainty by this view, pixels; NaN if unknown."""
        return self.uncertainty_px - self.predicted_uncertainty_px


def unpredicted_target(
    number: int,
    pose: Pose,
    camera: Camera,
    board: Board,
    *,
    reason: str,
    method: Method = "global",
    cost: Cost = "projection-variance",
    serves: tuple[str, ...] = (),
) -> Target:
    """A target without a search, whose gain is unknown."""
    return Target(
        number=number,
        pose=pose,
        steps=decompose(pose, camera, board),
        method=method,
        cost=cost,
        serves=serves,
        reason=reason,
        predicted_sigma=np.full(len(PARAMETERS), np.nan),
        predicted_uncertainty_px=float("nan"),
        evaluated=0,
        search_s=0.0,
    )


def served(before: Array, after: Array, first: str | None = None) -> tuple[str, ...]:
    """The parameters whose sigma falls most between two covariances (9, 9), best first.

    At most three, all within 80 % of the largest relative drop. The parameter `first`, which a rule
    aimed at, comes first whatever its drop.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        drop = np.nan_to_num(1 - np.sqrt(np.diag(after) / np.diag(before)), nan=0.0)
    order = np.argsort(-drop, kind="stable")[:3]
    names = [PARAMETERS[i] for i in order if drop[i] >= 0.8 * drop[order[0]]]
    return tuple(dict.fromkeys(names if first is None else [first, *names]))[:3]


def reason_for(serves: Sequence[str], pose: Pose, camera: Camera, board: Board) -> str:
    """One sentence: what in this pose is most informative about the parameters it serves."""
    lens = bool(serves) and serves[0] in _LENS
    return f"{_what_it_does(pose, camera, board, lens)} {_what_it_finds(serves)}."


def held_in_words(pose: Pose, camera: Camera) -> str:
    """How the board is held: turn in the image, place, tilt, distance. Sides are the image's."""
    roll = float(pose.vector()[2])
    turn = "clockwise" if roll > 0 else "counter-clockwise"
    u, v = camera.without_distortion().project(pose.t) / (camera.width, camera.height)
    x, y = (-1 if share < 0.38 else 1 if share > 0.62 else 0 for share in (float(u), float(v)))
    tilt = tilt_deg(pose)
    parts = (
        "upright" if abs(roll) < 8 else f"turned {size_deg(roll)} {turn}",
        _PLACES[y][x],
        "facing the camera" if tilt < 8 else f"{_edge_in_front(pose)} {size_deg(tilt)} nearer",
        f"{whole(100 * float(np.linalg.norm(pose.t)))} cm away",
    )
    return ", ".join(parts)


def tilt_deg(pose: Pose) -> float:
    """Angle between the board's normal and the line of sight to its centre, degrees."""
    cosine = pose.R[:, 2] @ pose.t / max(float(np.linalg.norm(pose.t)), 1e-9)
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _edge_in_front(pose: Pose) -> str:
    """The edge or corner in the image that is nearer than the line of sight alone makes it:
    opposite the side towards which the normal (away from the camera) leans."""
    line = pose.t / np.linalg.norm(pose.t)
    x, y = (pose.R[:, 2] - (pose.R[:, 2] @ line) * line)[:2]
    across, up = "right" if x > 0 else "left", "top" if y < 0 else "bottom"
    if abs(x) > 2.4 * abs(y):
        return f"{across} edge"
    return f"{up} edge" if abs(y) > 2.4 * abs(x) else f"{up} {across} corner"


def _what_it_does(pose: Pose, camera: Camera, board: Board, lens: bool) -> str:
    """The subject of the sentence: the tilt, or for the lens the place in the image."""
    tilt, place = tilt_deg(pose), _place(pose, camera, board)
    if lens and place == _FULL:
        return "A board over most of the picture shows"
    if lens and place:
        return f"The board {place} of the picture, where the lens bends most, shows"
    if tilt >= 12:
        x, y = (abs(float(angle)) for angle in pose.vector()[:2])
        axis = "about X" if x > 2 * y else "about Y" if y > 2 * x else "about X and Y"
        return f"Tilting the board {axis} makes one side look smaller, and that shows"
    if place:
        return f"Holding the board {place} of the picture shows"
    return "Facing the camera squarely, the board shows"


def _place(pose: Pose, camera: Camera, board: Board) -> str:
    """Where the board reaches furthest out in the image; empty in the middle."""
    pixels = camera.without_distortion().project(pose.apply(board.outline))
    size = np.array([camera.width, camera.height])
    if not np.isfinite(pixels).all():
        return ""
    # Gaps to the left/top and right/bottom border, as shares of the image.
    low, high = pixels.min(axis=0) / size, 1 - pixels.max(axis=0) / size
    # Near a border, and not equally near to the opposite one.
    x, y = (
        (-1 if a < b else 1) if min(a, b) < 0.15 and abs(a - b) > 0.12 else 0
        for a, b in zip(low, high, strict=True)
    )
    if not x and not y:
        return _FULL if max(*low, *high) < 0.12 else ""
    sides = {(0, -1): "top", (0, 1): "bottom", (-1, 0): "left side", (1, 0): "right side"}
    if x and y:
        return f"in the {'top' if y < 0 else 'bottom'} {'left' if x < 0 else 'right'} corner"
    return f"at the {sides[(x, y)]}"


def _what_it_finds(serves: Sequence[str]) -> str:
    """The object of the sentence: the parameters by kind, the most served kind first."""
    focal, centre, lens = (sorted(set(kind) & set(serves)) for kind in (_FOCAL, _CENTRE, _LENS))
    phrases: dict[str, str] = {}
    if focal:
        kind = "" if len(focal) == 2 else _FOCAL[focal[0]] + " "
        phrases |= dict.fromkeys(focal, f"the {kind}focal length ({', '.join(focal)})")
    if centre:
        where = "" if len(centre) == 2 else f", {_CENTRE[centre[0]]}"
        phrases |= dict.fromkeys(centre, f"where the lens points{where} ({', '.join(centre)})")
    if lens:
        phrases |= dict.fromkeys(lens, f"how the lens bends straight lines ({', '.join(lens)})")
    parts = list(dict.fromkeys(phrases[name] for name in serves if name in phrases))
    if len(parts) > 1:
        return ", ".join(parts[:-1]) + " and " + parts[-1]
    return parts[0] if parts else "a little of everything"

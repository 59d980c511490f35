"""The next target: the pose, its expected gain, and its purpose and hold in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from venus3d.engine.amounts import size_deg, whole
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Steps, decompose
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.planning.settings import Cost, Method
from venus3d.engine.sentences import Sentence, listed, with_commas

_FOCAL, _CENTRE = ("fx", "fy"), ("cx", "cy")
# By row (middle, lower, upper) and column (middle, right, left), so that -1 is the last.
_PLACES = (
    (Sentence("in the middle"), Sentence("on the right"), Sentence("on the left")),
    (Sentence("at the bottom"), Sentence("at the lower right"), Sentence("at the lower left")),
    (Sentence("at the top"), Sentence("at the upper right"), Sentence("at the upper left")),
)
# The same where the board reaches out to the image's border.
_BORDERS = (
    ("", Sentence("at the right side"), Sentence("at the left side")),
    (
        Sentence("at the bottom"),
        Sentence("in the bottom right corner"),
        Sentence("in the bottom left corner"),
    ),
    (
        Sentence("at the top"),
        Sentence("in the top right corner"),
        Sentence("in the top left corner"),
    ),
)
_FULL = "full"
# By row (middle, lower, upper) and column (middle, right, left) of what is nearer.
_NEARER = (
    ("", Sentence("right edge {angle} nearer"), Sentence("left edge {angle} nearer")),
    (
        Sentence("bottom edge {angle} nearer"),
        Sentence("bottom right corner {angle} nearer"),
        Sentence("bottom left corner {angle} nearer"),
    ),
    (
        Sentence("top edge {angle} nearer"),
        Sentence("top right corner {angle} nearer"),
        Sentence("top left corner {angle} nearer"),
    ),
)
_UPRIGHT = Sentence("upright")
_CLOCKWISE = Sentence("turned {angle} clockwise")
_COUNTER = Sentence("turned {angle} counter-clockwise")
_FACING = Sentence("facing the camera")
_DISTANCE = Sentence("{cm} cm away")

_REASON = Sentence("{does} {finds}.")
_COVERS = Sentence("A board over most of the picture shows")
_BENDS = Sentence("The board {place} of the picture, where the lens bends most, shows")
_TILTS = {
    "x": Sentence("Tilting the board about X makes one side look smaller, and that shows"),
    "y": Sentence("Tilting the board about Y makes one side look smaller, and that shows"),
    "xy": Sentence("Tilting the board about X and Y makes one side look smaller, and that shows"),
}
_HOLDS = Sentence("Holding the board {place} of the picture shows")
_FACES = Sentence("Facing the camera squarely, the board shows")
_FOCAL_LENGTHS = {
    "fx": Sentence("the horizontal focal length ({names})"),
    "fy": Sentence("the vertical focal length ({names})"),
    "": Sentence("the focal length ({names})"),
}
_CENTRES = {
    "cx": Sentence("where the lens points, left to right ({names})"),
    "cy": Sentence("where the lens points, up and down ({names})"),
    "": Sentence("where the lens points ({names})"),
}
_LENS_BENDS = Sentence("how the lens bends straight lines ({names})")
_ANYTHING = Sentence("a little of everything")
_LENS = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "s1", "s2", "s3", "s4")


@dataclass(frozen=True, eq=False)
class Target:
    """A pose for the user to reach, its purpose, and the steps to it."""

    number: int
    """Counts from 1; skipped targets are counted."""
    pose: Pose
    steps: Steps = field(repr=False)
    """Eq. (15): from the frontal, upright board to the target."""
    method: Method
    cost: Cost
    serves: tuple[str, ...]
    """The parameters this view helps most, best first."""
    reason: str
    """One sentence: the purpose of this pose."""
    predicted_sigma: Array = field(repr=False)
    """(p,) expected standard deviations after this view; NaN if unknown."""
    predicted_uncertainty_px: float
    """Projection uncertainty over the image after this view, pixels; NaN if unknown."""
    evaluated: int = 0
    """Number of candidate poses evaluated."""
    search_s: float = 0.0
    """Duration of the search."""
    uncertainty_px: float = float("nan")
    """Projection uncertainty over the image before this view, pixels; NaN if unknown."""
    alternatives: tuple[Target, ...] = field(default=(), repr=False)
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
        predicted_sigma=np.full(len(camera.parameters), np.nan),
        predicted_uncertainty_px=float("nan"),
    )


def served(
    before: Array, after: Array, parameters: Sequence[str], first: str | None = None
) -> tuple[str, ...]:
    """The parameters whose sigma falls most between two covariances (p, p), best first.

    At most three, all within 80 % of the largest relative drop. The parameter `first`, which a rule
    aimed at, comes first whatever its drop.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        drop = np.nan_to_num(1 - np.sqrt(np.diag(after) / np.diag(before)), nan=0.0)
    order = np.argsort(-drop, kind="stable")[:3]
    names = [parameters[int(i)] for i in order if drop[i] >= 0.8 * drop[order[0]]]
    return tuple(dict.fromkeys(names if first is None else [first, *names]))[:3]


def reason_for(serves: Sequence[str], pose: Pose, camera: Camera, board: Board) -> str:
    """One sentence: what in this pose is most informative about the parameters it serves."""
    lens = bool(serves) and serves[0] in _LENS
    return _REASON.format(
        does=_what_it_does(pose, camera, board, lens), finds=_what_it_finds(serves)
    )


def held_in_words(pose: Pose, camera: Camera) -> str:
    """How the board is held: turn in the image, place, tilt, distance. Sides are the image's."""
    roll = float(pose.vector()[2])
    turn = _CLOCKWISE if roll > 0 else _COUNTER
    u, v = camera.unbent.project(pose.t) / (camera.width, camera.height)
    x, y = (-1 if share < 0.38 else 1 if share > 0.62 else 0 for share in (float(u), float(v)))
    tilt = tilt_deg(pose)
    parts = (
        _UPRIGHT if abs(roll) < 8 else turn.format(angle=size_deg(roll)),
        _PLACES[y][x],
        _FACING if tilt < 8 else _in_front(pose).format(angle=size_deg(tilt)),
        _DISTANCE.format(cm=whole(100 * float(np.linalg.norm(pose.t)))),
    )
    return with_commas(parts)


def tilt_deg(pose: Pose) -> float:
    """Angle between the board's normal and the line of sight to its centre, degrees."""
    cosine = pose.R[:, 2] @ pose.t / max(float(np.linalg.norm(pose.t)), 1e-9)
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def _in_front(pose: Pose) -> str:
    """The edge or corner in the image that is nearer than the line of sight alone makes it:
    opposite the side towards which the normal (away from the camera) leans."""
    line = pose.t / np.linalg.norm(pose.t)
    x, y = (pose.R[:, 2] - (pose.R[:, 2] @ line) * line)[:2]
    across, up = 1 if x > 0 else -1, -1 if y < 0 else 1
    return _NEARER[0 if abs(x) > 2.4 * abs(y) else up][0 if abs(y) > 2.4 * abs(x) else across]


def _what_it_does(pose: Pose, camera: Camera, board: Board, lens: bool) -> str:
    """The subject of the sentence: the tilt, or for the lens the place in the image."""
    tilt, place = tilt_deg(pose), _place(pose, camera, board)
    if lens and place == _FULL:
        return _COVERS
    if lens and place:
        return _BENDS.format(place=place)
    if tilt >= 12:
        x, y = (abs(float(angle)) for angle in pose.vector()[:2])
        return _TILTS["x" if x > 2 * y else "y" if y > 2 * x else "xy"]
    if place == _FULL:
        return _COVERS
    return _HOLDS.format(place=place) if place else _FACES


def _place(pose: Pose, camera: Camera, board: Board) -> str:
    """Where the board reaches furthest out in the image; empty in the middle, `_FULL` if it covers
    most of it."""
    pixels = camera.unbent.project(pose.apply(board.outline))
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
    return _BORDERS[y][x]


def _what_it_finds(serves: Sequence[str]) -> str:
    """The object of the sentence: the parameters by kind, the most served kind first."""
    focal, centre, lens = (sorted(set(kind) & set(serves)) for kind in (_FOCAL, _CENTRE, _LENS))
    phrases: dict[str, str] = {}
    for names, words in (
        (focal, _FOCAL_LENGTHS["" if len(focal) != 1 else focal[0]]),
        (centre, _CENTRES["" if len(centre) != 1 else centre[0]]),
        (lens, _LENS_BENDS),
    ):
        phrases |= dict.fromkeys(names, words.format(names=", ".join(names)))
    parts = list(dict.fromkeys(phrases[name] for name in serves if name in phrases))
    return listed(parts) if parts else _ANYTHING

"""Replays a search afterwards, at a speed that a person can follow.

Each evaluated pose is two dots: at the board's centre, and in a box with three axes, the turns
about X and Y and the distance. The smaller the cost, the stronger the dot. A batch search is shown
batch by batch, annealing move by move, with a line along the accepted poses.

    /search/places, /search/angles            the dots in front of the camera, and in the box
    /search/faint                             outlines of a few of the newest poses
    /search/best, sheet, best_label           the best board so far
    /search/best_angles                       and its dot in the box
    /search/live                              the board as it is now
    /search/now                               the pose looked at (walk)
    /search/walk, /search/walk_angles         the line of the poses taken (walk)
    /search/box, /search/axis_1 ... axis_3    the box, the names of its axes; with _line the axes
    /search/title                             what the box is
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from venus3d.engine.amounts import figure
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Array, Pose
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.engine.planning.search_trace import SearchStep, SearchTrace
from venus3d.languages import cached_by_language
from venus3d.render.board_mesh import board_ghost, board_outline, outline_segments
from venus3d.render.colour_scale import colours_of
from venus3d.render.palette import ground, mixed, step_colour
from venus3d.render.shapes import LabelShape, LineShape, PointShape, Shape
from venus3d.scene.pages.guide.uncertainty import texts

SECONDS, REST_SECONDS = 13.0, 4.0
"""Duration of the replay, and of the rest at its end."""
_FAINT = 10  # outlined boards of a batch
_DOT, _UNSEEN = 0.0035, 1e-6
_AGED = 0.6  # share of the background's colour in dots of earlier batches
# Lowest corner and side of the box, metres, at the usual viewing distance.
_BOX, _SIDE = np.array([-0.14, 0.17, 0.10]), 0.14
_FURTHEST_M = 1.2
_NEAR_TARGET = 0.45
"""Largest target distance, metres, at which they have their usual size."""


def shown_after(search_trace: SearchTrace, seconds: float) -> int:
    """How many moves are shown this long after the start; at least 1."""
    count = len(search_trace.steps)
    return min(count, 1 + int(count * max(seconds, 0.0) / SECONDS))


@cached_by_language(maxsize=4)
def search_shapes(
    search_trace: SearchTrace, shown: int, board: Board, dark: bool
) -> tuple[Shape, ...]:
    """The search after `shown` moves."""
    colours, moves = ground(dark), search_trace.steps[:shown]
    is_last = shown == len(search_trace.steps)
    # Relative to the usual viewing distance; the box grows with it.
    back = _steps_back(float(np.linalg.norm(search_trace.end[3:])))
    poses, colour, fresh = _dots(search_trace, shown, dark)
    shapes: list[Shape] = [
        PointShape("/search/places", poses[:, 3:], colour, back * _DOT),
        PointShape("/search/angles", _in_box(poses, back), colour, 0.7 * back * _DOT),
        _bests(board, search_trace),
        LineShape("/search/faint", _outlines(board, fresh), Pose.identity(), colours.ghost, 1.0),
        *_box_shapes(dark, back),
    ]
    if not search_trace.is_batched:
        shapes += _walk_shapes(moves, back, board, dark)
    best = search_trace.end if is_last else moves[-1].best_vector
    word = texts.SEARCH_CHOSEN if is_last else texts.SEARCH_BEST
    pose, marked = Pose.from_vector(best), np.array([colours.warning], dtype=np.uint8)
    return (
        *shapes,
        board_ghost(board, pose, "/search/sheet", colours.warning, 0.35),
        board_outline(board, pose, "/search/best", colours.warning, 4.0),
        LabelShape("/search/best_label", word, pose.t, colours.text, in_projection=False),
        PointShape("/search/best_angles", _in_box(best[None], back), marked, 2.2 * back * _DOT),
    )


def _steps_back(distance: float) -> float:
    """Factor, 1 ... 2.5, by which box and dots grow for a target `distance` metres from the camera,
    which is seen from farther away; in halves."""
    return float(np.clip(np.ceil(2 * distance / _NEAR_TARGET) / 2, 1.0, 2.5))


def caption(search_trace: SearchTrace, shown: int, *, in_px: bool) -> str:
    """One line on what is shown; `in_px` if the cost is a mean variance in square pixels."""
    last, title = search_trace.steps[shown - 1], texts.SEARCH_TITLE
    best, is_last = _cost_text(last.best_cost, in_px), shown == len(search_trace.steps)
    if search_trace.is_batched:
        text = texts.SEARCH_DONE if is_last else texts.SEARCH_BATCH
        return f"{title}: {text.format(looked=last.evaluated, best=best)}"
    taken = [move for move in search_trace.steps[:shown] if move.accepted]
    if is_last:
        at_end = [
            move.cost for move in taken if np.allclose(move.vector, search_trace.end, atol=1e-6)
        ]
        end = _cost_text(at_end[-1] if at_end else last.best_cost, in_px)
        done = texts.SEARCH_DONE_WALK.format(looked=last.evaluated, end=end, best=best)
        return f"{title}: {done}"
    told = texts.SEARCH_MOVE.format(
        move=shown,
        moves=len(search_trace.steps),
        verdict=texts.SEARCH_TAKEN if last.accepted else texts.SEARCH_REFUSED,
        accepted=len(taken),
        best=best,
    )
    return f"{title}: {told}"


def _cost_text(cost: float, in_px: bool) -> str:
    value = float(np.sqrt(cost)) if in_px else cost
    return (texts.SEARCH_PX if in_px else texts.SEARCH_COST).format(value=figure(value))


def _dots(
    search_trace: SearchTrace, shown: int, dark: bool
) -> tuple[Array, NDArray[np.uint8], Array]:
    """All poses so far (N, 6), their colours (N, 3), and a few of the newest (K, 6)."""
    batches = [
        (move.candidates, move.candidate_costs)
        if len(move.candidates)
        else (move.vector[None], np.array([move.cost]))
        for move in search_trace.steps
    ]
    every = np.log(np.concatenate([costs for _, costs in batches]))
    low, high = np.percentile(every, [1, 90])
    seen = batches[:shown]
    costs = np.log(np.concatenate([costs for _, costs in seen]))
    newest, worth = seen[-1]
    few = newest[np.argsort(worth)[:: max(1, len(worth) // _FAINT)][:_FAINT]]
    # Low costs contrast with the ground: bright on dark, dark on light.
    ends = (-costs, -high, -low) if dark else (costs, low, high)
    colour = colours_of(*ends).astype(np.float64)
    if search_trace.is_batched and shown < len(batches):
        older = slice(0, len(costs) - len(worth))
        colour[older] += _AGED * (np.array(ground(dark).background) - colour[older])
    colour = np.rint(colour).astype(np.uint8)
    return np.concatenate([poses for poses, _ in seen]), colour, few


@lru_cache(maxsize=4)
def _bests(board: Board, search_trace: SearchTrace) -> PointShape:
    """The board's corners at each pose that is the best for a time, too small to be seen: so the
    view holds all of them from the start, and stays."""
    vectors = np.array([*(step.best_vector for step in search_trace.steps), search_trace.end])
    poses = [Pose.from_vector(vector) for vector in np.unique(vectors, axis=0)]
    corners = np.concatenate([pose.apply(board.outline) for pose in poses])
    return PointShape("/search/bests", corners, np.zeros(corners.shape, np.uint8), _UNSEEN)


def _outlines(board: Board, poses: Array) -> Array:
    """(4 K, 2, 3) edges of boards under pose vectors (K, 6), camera frame."""
    edges = outline_segments(board)
    return np.concatenate([Pose.from_vector(pose).apply(edges) for pose in poses])


def _in_box(poses: Array, back: float) -> Array:
    """(N, 3) points in the box of pose vectors (N, 6), camera frame, metres."""
    share = np.stack(
        [
            (poses[:, 0] + 90) / 180,
            (poses[:, 1] + 90) / 180,
            np.linalg.norm(poses[:, 3:], axis=1) / _FURTHEST_M,
        ],
        axis=1,
    )
    return back * (_BOX + _SIDE * np.clip(share, 0.0, 1.0))


def _walk_shapes(moves: Sequence[SearchStep], back: float, board: Board, dark: bool) -> list[Shape]:
    """The line of accepted poses, and the pose being evaluated."""
    colours = ground(dark)
    taken = [move.vector for move in moves if move.accepted]
    last = moves[-1]
    colour = step_colour(1, dark) if last.accepted else colours.ghost
    now = Pose.from_vector(last.vector)
    shapes: list[Shape] = [
        board_outline(board, now, "/search/now", colour, 3.0 if last.accepted else 1.5)
    ]
    if len(taken) > 1:
        path = np.array(taken)
        ink, here = mixed(step_colour(1, dark), colours.text, 0.2), Pose.identity()
        shapes += [
            LineShape("/search/walk", _chain(path[:, 3:]), here, ink, 2.5),
            LineShape("/search/walk_angles", _chain(_in_box(path, back)), here, ink, 2.5),
        ]
    return shapes


def _chain(points: Array) -> Array:
    """(N - 1, 2, 3) segments between consecutive points (N, 3)."""
    return np.array([[a, b] for a, b in pairwise(points)])


@cached_by_language(maxsize=4)
def _box_shapes(dark: bool, back: float) -> tuple[Shape, ...]:
    """The box's edges; three of them are labelled axes."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    edges = [(a, b) for a in corners for b in corners if np.sum(b - a) == 1 and np.sum(a != b) == 1]
    here, colours = Pose.identity(), ground(dark)
    lines = back * (_BOX + _SIDE * np.array(edges, dtype=np.float64))
    shapes: list[Shape] = [LineShape("/search/box", lines, here, colours.ghost, 1.0)]
    # The turns have their steps' colours, the distance the move's.
    for index, (text, step) in enumerate(zip(texts.SEARCH_AXES, (2, 3, 1), strict=True)):
        name, colour, along = f"/search/axis_{index + 1}", step_colour(step, dark), np.eye(3)[index]
        ends = back * (_BOX + _SIDE * np.array([[0 * along, along]]))
        at = back * (_BOX + 1.12 * _SIDE * along)
        shapes += [
            LineShape(f"{name}_line", ends, here, colour, 3.5),
            LabelShape(name, text, at, colour, in_projection=False),
        ]
    at = back * (_BOX + _SIDE * np.array([0.0, 1.4, 0.0]))
    return (*shapes, LabelShape("/search/title", texts.SEARCH_BOX, at, colours.text, False))


_WHOLE = SECONDS + REST_SECONDS
_KEPT = "/camera/"


class SearchReplay:
    """The replay on one page."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        """`clock` returns seconds."""
        self._clock = clock
        self._search_trace: SearchTrace | None = None
        self._began = 0.0
        self.caption = ""
        """One line on the search shown in the scene; empty for none."""

    @property
    def is_moving(self) -> bool:
        """Whether a search is being replayed."""
        return self._search_trace is not None and self._clock() - self._began < _WHOLE

    def of(
        self, snapshot: Snapshot, shapes: tuple[Shape, ...], *, on: bool, dark: bool
    ) -> tuple[Shape, ...]:
        """The scene's shapes; a replayed search replaces all but the camera. A new search starts;
        switching off and on restarts it."""
        self.caption = ""
        target, search_trace = snapshot.target, snapshot.search_trace
        if not on or target is None or search_trace is None:
            self._search_trace = None
            if on and target is not None:
                self.caption = texts.SEARCH_NOTHING
            return shapes
        if search_trace is not self._search_trace:
            self._search_trace, self._began = search_trace, self._clock()
        if not self.is_moving:
            return shapes
        shown = shown_after(search_trace, self._clock() - self._began)
        in_px = target.cost == "projection-variance"
        self.caption = caption(search_trace, shown, in_px=in_px)
        search = search_shapes(search_trace, shown, snapshot.board, dark)
        calm = tuple(shape for shape in shapes if shape.name.startswith(_KEPT))
        if snapshot.pose is None:
            return (*calm, *search)
        # Only its outline: the printed board would hide the dots behind it.
        live = board_outline(snapshot.board, snapshot.pose, "/search/live", ground(dark).text)
        return (*calm, *search, live)

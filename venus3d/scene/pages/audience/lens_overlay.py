"""The 3D steps over the live picture: the target, and the active step from the board's current
pose. The picture shows the board, the dial the numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.matching import Match
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import CASING
from venus3d.render.board_mesh import board_ghost, board_outline
from venus3d.render.palette import ground, step_colour
from venus3d.render.shapes import LabelShape, LineShape, Shape
from venus3d.render.step_shapes import instruction_shapes
from venus3d.scene.pages.audience.state import AudienceState

_GHOST_OPACITY = 0.25
"""Opacity at which the board in the picture shows through."""
_BEHIND = 1.004
"""Relative distance of a line's casing, which the line then hides."""
_SEEN_DEG, _SEEN_MM = 0.7, 2.0
"""Below this motion (a hand's tremor) arrows are not rebuilt."""


class LensOverlay:
    """Shapes over the picture, in the colours of a dark ground and without letters, which a mirror
    would reverse. Used by one thread."""

    def __init__(self) -> None:
        self._drawn: tuple[Snapshot, tuple[Shape, ...]] | None = None

    def shapes(self, snapshot: Snapshot | None, look: AudienceState) -> tuple[Shape, ...]:
        """The shapes for this moment; none unless the lens view is on."""
        if not look.lens or snapshot is None or snapshot.target is None:
            return ()
        if snapshot.phase not in ("startup", "guiding"):
            return ()
        if self._drawn is None or not _looks_alike(self._drawn[0], snapshot):
            self._drawn = (snapshot, _shapes(snapshot, snapshot.target.pose))
        return self._drawn[1]


def _looks_alike(one: Snapshot, other: Snapshot) -> bool:
    a, b = _to_do(one), _to_do(other)
    same = one.target is other.target and one.camera is other.camera
    if a is None or b is None or not same:
        return same and a is b
    return (
        a.active_step == b.active_step
        and float(np.abs(a.remaining_deg - b.remaining_deg).max()) < _SEEN_DEG
        and float(np.abs(a.remaining_mm - b.remaining_mm).max()) < _SEEN_MM
    )


def _to_do(snapshot: Snapshot) -> Match | None:
    match = snapshot.match
    done = match is None or match.reached or all(match.within)
    return None if done else match


def _shapes(snapshot: Snapshot, target: Pose) -> tuple[Shape, ...]:
    board = snapshot.board
    goal = board_outline(board, target, "/target/board", ground(True).target, 4.0)
    match = _to_do(snapshot)
    if match is None:
        return _cased(goal)
    step = match.steps[match.active_step - 1]
    return (*_cased(goal), *_step_shapes(board, snapshot.camera, step))


def _step_shapes(board: Board, camera: Camera, step: Step) -> list[Shape]:
    name, colour = f"/steps/{step.number}", step_colour(step.number, True)
    arrow = instruction_shapes(board, camera, step, dark=True, for_camera=True)
    return [
        *_cased(board_outline(board, step.after, f"{name}/outline", colour, 5.0)),
        board_ghost(board, step.after, f"{name}/after", colour, _GHOST_OPACITY),
        *(shape for shape in arrow if not isinstance(shape, LabelShape)),
    ]


def _cased(line: LineShape) -> tuple[Shape, Shape]:
    """The line with a dark edge, visible on white paper."""
    casing = replace(
        line,
        name=f"{line.name}_casing",
        segments=_BEHIND * line.segments,
        pose=Pose(line.pose.R, _BEHIND * line.pose.t),
        colour=CASING,
        width_px=line.width_px + 4,
    )
    return casing, line

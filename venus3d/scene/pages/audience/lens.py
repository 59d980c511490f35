"""Through the lens: the 3D steps over the undistorted live picture (`render.picture_plane`)."""

from __future__ import annotations

from dataclasses import replace

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import Camera
from venus3d.engine.geometry.decomposition import Step
from venus3d.engine.geometry.pose import Pose
from venus3d.engine.guidance.remaining import RemainingSteps
from venus3d.engine.guidance.snapshot import Snapshot
from venus3d.render.annotated_picture import CASING
from venus3d.render.board_mesh import board_ghost, board_outline
from venus3d.render.palette import ground, step_colour
from venus3d.render.redrawing import looks_alike
from venus3d.render.shapes import LabelShape, LineShape, Shape
from venus3d.render.step_shapes import instruction_shapes
from venus3d.scene.pages.audience.state import AudienceState

_GHOST_OPACITY = 0.25
"""Opacity at which the board in the picture shows through."""
_BEHIND = 1.004
"""Relative distance of a line's casing, which the line then hides."""


class LensOverlay:
    """Shapes over the picture, in the colours of a dark ground and without letters, which a mirror
    would reverse. Used by one thread."""

    def __init__(self) -> None:
        self._drawn: tuple[Snapshot, tuple[Shape, ...]] | None = None

    def shapes(self, snapshot: Snapshot | None, look: AudienceState) -> tuple[Shape, ...]:
        """The shapes for this moment; none unless the lens view is on."""
        if not look.lens or snapshot is None or snapshot.remaining is None:
            return ()
        drawn, todo = self._drawn, snapshot.remaining
        if (
            drawn is None
            or drawn[0].camera is not snapshot.camera
            or not looks_alike(drawn[0].remaining, todo)
        ):
            self._drawn = drawn = (snapshot, _shapes(snapshot, todo))
        return drawn[1]


def _shapes(snapshot: Snapshot, todo: RemainingSteps) -> tuple[Shape, ...]:
    board, target = snapshot.board, todo.steps[3].after
    goal = board_outline(board, target, "/target/board", ground(True).target, 4.0)
    if todo.from_upright or todo.is_over:
        return _cased(goal)
    step = todo.step(todo.active).step
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

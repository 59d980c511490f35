"""The 3D steps over the live picture: the target, and what the active step does, from where the
board is now. The board itself is in the picture, and the numbers are the dial's."""

from __future__ import annotations

from venus3d.engine.board import Board
from venus3d.engine.camera import Camera
from venus3d.engine.decomposition import Step
from venus3d.engine.snapshot import Snapshot
from venus3d.scene.audience.look import Look
from venus3d.scene.board_shape import board_ghost, board_outline
from venus3d.scene.instruction import instruction_shapes
from venus3d.scene.palette import ground, step_colour
from venus3d.scene.shapes import LabelShape, Shape

_GHOST_OPACITY = 0.25
"""The board in the picture shows through."""


def lens_shapes(snapshot: Snapshot | None, look: Look) -> tuple[Shape, ...]:
    """What is drawn over the picture; nothing unless the look is through the lens.

    Always in the colours of a dark ground: the ground is the picture. No letters: in a mirror
    they could not be read.
    """
    if not look.lens or snapshot is None or snapshot.target is None:
        return ()
    if snapshot.phase not in ("startup", "guiding"):
        return ()
    board, target = snapshot.board, snapshot.target.pose
    shapes: list[Shape] = [board_outline(board, target, "/target/board", ground(True).target, 4.0)]
    match = snapshot.match
    if match is not None and not (match.reached or all(match.within)):
        shapes += _step_shapes(board, snapshot.camera, match.steps[match.active_step - 1])
    return tuple(shapes)


def _step_shapes(board: Board, camera: Camera, step: Step) -> list[Shape]:
    name, colour = f"/steps/{step.number}", step_colour(step.number, True)
    arrow = instruction_shapes(board, camera, step, dark=True, for_camera=True)
    return [
        board_outline(board, step.after, f"{name}/outline", colour, 5.0),
        board_ghost(board, step.after, f"{name}/after", colour, _GHOST_OPACITY),
        *(shape for shape in arrow if not isinstance(shape, LabelShape)),
    ]

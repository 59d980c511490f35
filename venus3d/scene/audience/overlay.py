"""The 3D steps over the live picture: the target, and what the active step does, from where the
board is now. The board itself is in the picture, and the numbers are the dial's."""

from __future__ import annotations

from venus3d.engine.snapshot import Snapshot
from venus3d.scene.audience.look import Look
from venus3d.scene.board_shape import board_outline
from venus3d.scene.describe import SceneOptions, active_shapes
from venus3d.scene.palette import ground
from venus3d.scene.shapes import LabelShape, Shape


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
        number = match.active_step
        options = SceneOptions(step=number, dark=True)
        active = active_shapes(board, snapshot.camera, match.steps[number - 1], options)
        before = f"/steps/{number}/before"
        shapes += [s for s in active if s.name != before and not isinstance(s, LabelShape)]
    return tuple(shapes)

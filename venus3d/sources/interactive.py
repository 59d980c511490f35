"""The source that a person holds a board before: what they named, or the simulation."""

from __future__ import annotations

from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.camera import PAPER_CAMERA
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.frame import Source
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.sim import Simulation
from venus3d.threads.latency import limit_gl_threads

SIMULATED = "sim"
# Headless, the simulated hand is looked at this often; a person's viewer gets every frame.
_HEADLESS_FPS, _LIVE_FPS = 5.0, 25.0
_HEADLESS_HASTE = 2.5
_IN_SIGHT = Pose.from_vector([12, -8, 4, 0, 0, 0.5])


def open_interactive(
    spec: str,
    board: Board,
    *,
    size: tuple[int, int] | None,
    seed: int,
    headless: bool,
    autopilot: bool,
    speed: float,
) -> Source:
    """Open what `spec` names, or with "sim" the simulation of the paper's camera.

    Args:
        size: (width, height) to ask a camera for, or to simulate.
        headless: nobody looks on: frames come as fast as they can be made or read.
        autopilot: whether the simulated hand has the board.
        speed: of the simulated hand; 1 is a calm person.

    Raises `SourceError` for all that cannot be opened.
    """
    if not headless:
        limit_gl_threads()
    if spec != SIMULATED:
        return open_frame_source(spec, size=size, realtime=not headless)
    return Simulation(
        PAPER_CAMERA if size is None else PAPER_CAMERA.scaled(size),
        board,
        seed=seed,
        fps=_HEADLESS_FPS if headless else _LIVE_FPS,
        realtime=not headless,
        autopilot=autopilot,
        speed=speed * (_HEADLESS_HASTE if headless else 1.0),
        # A hand brings the board into sight by itself; a person needs something to take hold of.
        start=None if autopilot else _IN_SIGHT,
    )

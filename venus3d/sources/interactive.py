"""Opens the source for a guided session: what the user named, or the simulation."""

from __future__ import annotations

from dataclasses import replace

from venus3d.engine.errors import SourceError
from venus3d.engine.geometry.board import Board
from venus3d.engine.geometry.pose import Pose
from venus3d.sources.camera_settings import CameraSettings
from venus3d.sources.frame import Source
from venus3d.sources.open_frame_source import open_frame_source
from venus3d.sources.sim import Simulation
from venus3d.sources.sim_cameras import FIELD_DEG, SIMULATED, SimCamera, simulated_camera
from venus3d.sources.view_errors import ViewErrors
from venus3d.threads.latency import limit_gl_threads

# The simulated hand's frame rate without and with a viewer.
_HEADLESS_FPS, _LIVE_FPS = 5.0, 25.0
_HEADLESS_HASTE = 2.5
_IN_SIGHT = Pose.from_vector([12, -8, 4, 0, 0, 0.5])


def open_interactive(
    spec: str,
    board: Board,
    *,
    size: tuple[int, int] | None = None,
    camera: SimCamera = "webcam",
    settings: CameraSettings | None = None,
    seed: int = 0,
    headless: bool = False,
    autopilot: bool = False,
    speed: float = 1.0,
    bow: float = 0.0,
    view_errors: ViewErrors | None = None,
    flip: bool = False,
) -> Source:
    """Open what `spec` names, or with "sim" a simulated camera.

    Args:
        size: (width, height) to request from a camera, or to simulate.
        camera: the one to simulate.
        settings: of a camera, to set when it is opened.
        headless: without a viewer: frames come as fast as they can be made or read.
        autopilot: whether the simulated hand holds the board.
        speed: of the simulated hand; 1 is a calm person.
        bow: of the simulated board, metres.
        view_errors: of the simulated views; see `Simulation`.
        flip: exchange left and right in the pictures, which are mirrored.

    Raises `SourceError` for whatever cannot be opened.
    """
    if not headless:
        limit_gl_threads()
    if spec != SIMULATED:
        return open_frame_source(
            spec, size=size, settings=settings, realtime=not headless, flip=flip
        )
    if settings is not None and settings.wanted():
        raise SourceError("The simulated camera has nothing to set; leave out --camera.")
    if flip:
        raise SourceError("The simulated pictures are not mirrored; leave out --flip.")
    return Simulation(
        simulated_camera(camera, size),
        replace(board, bow=(bow, 0.0)),
        field_deg=FIELD_DEG.get(camera),
        seed=seed,
        fps=_HEADLESS_FPS if headless else _LIVE_FPS,
        realtime=not headless,
        autopilot=autopilot,
        view_errors=view_errors,
        speed=speed * (_HEADLESS_HASTE if headless else 1.0),
        # The simulated hand brings the board into view by itself; a person needs to see it to drag
        # it.
        start=None if autopilot else _IN_SIGHT,
    )

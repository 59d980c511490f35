"""The 3D scene of a page as a recording that viser's own player shows, offline too.

A recording holds the scene and no panels, so what the scene must say it says by labels; the words
stand around it, in `document`.
"""

from __future__ import annotations

import base64
from importlib.util import find_spec
from pathlib import Path

from venus3d.scene.export.journey import journey
from venus3d.scene.server import LocalServer
from venus3d.scene.teach.moment import TeachMoment
from venus3d.scene.teach.stage import stage_shapes, stage_view
from venus3d.scene.teach.state import TeachState
from venus3d.scene.view import SceneView

FPS = 15
_BEFOREHAND = 8  # states; every step is longer
ASPECT = 1.3
"""Width over height of the scene in the document, at least: a view cannot be told anew there."""


def recorded(server: LocalServer, moment: TeachMoment, state: TeachState) -> str:
    """Play the page's way on this server, which nobody needs to look at, and keep what it sent.

    Returns the recording, base64.
    """
    server.scene.reset()
    view = SceneView(server)
    states = journey(moment, state, FPS)
    _look(server, moment, states[0])
    # Made beforehand and hidden: a new shape stands for a moment where the camera is.
    for now in (*states[::_BEFOREHAND], states[0]):
        view.draw(stage_shapes(moment, now), dark=state.dark)
    serializer = server.get_scene_serializer()
    for now in states[1:]:
        view.draw(stage_shapes(moment, now), dark=state.dark)
        serializer.insert_sleep(1 / FPS)
    return base64.b64encode(serializer.serialize()).decode("ascii")


def player() -> str:
    """viser's client as one HTML document, to which a recording is given before it starts.

    Raises `FileNotFoundError` if viser was installed without it.
    """
    spec = find_spec("viser")
    assert spec is not None and spec.origin is not None
    return (Path(spec.origin).parent / "client" / "build" / "index.html").read_text("utf-8")


def _look(server: LocalServer, moment: TeachMoment, state: TeachState) -> None:
    view = stage_view(moment, state, stage_shapes(moment, state), ASPECT)
    camera = server.initial_camera
    x, y, z = (float(value) for value in view.position)
    camera.position = (x, y, z)
    x, y, z = (float(value) for value in view.look_at)
    camera.look_at = (x, y, z)
    camera.fov, camera.near, camera.far = view.fov_rad, 0.01, 50.0

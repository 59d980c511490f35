"""Where one tab looks from, and its flight from one view to another."""

from __future__ import annotations

import time

import numpy as np
import viser

from venus3d.engine.geometry.pose import Array
from venus3d.scene.pages.exercise.view_model import PracticeMoment
from venus3d.scene.render.frustum import AXIS_LENGTH
from venus3d.scene.render.viewpoints import FLIGHT_SECONDS, SceneCamera, between, view_from

_TIPS = 1.3 * AXIS_LENGTH * np.eye(4, 3)  # the last row is the lens


class TabView:
    """The camera of one tab. `go` and `advance` are called by one thread."""

    def __init__(self, client: viser.ClientHandle) -> None:
        """Nothing moves until `go`."""
        self._client = client
        self._start: SceneCamera | None = None
        self._moment: PracticeMoment | None = None
        self._begun = 0.0
        self._aspect = 0.0
        self._goal: SceneCamera | None = None
        self._arrived, self._astray = False, False
        client.camera.on_update(self._told)

    def go(self, moment: PracticeMoment, *, at_once: bool = False) -> None:
        """Fly to where camera, board and target are seen, or into the camera."""
        camera = self._client.camera
        self._moment, self._begun = moment, time.monotonic()
        self._start = SceneCamera(camera.position.copy(), camera.look_at.copy(), camera.fov)
        if at_once:
            self._begun -= FLIGHT_SECONDS

    @property
    def is_due(self) -> bool:
        """Whether `advance` has something to do."""
        return self._start is not None or self._reshaped or self._astray

    def advance(self) -> None:
        """Move the camera on."""
        camera, moment = self._client.camera, self._moment
        if moment is None or not self.is_due:
            return
        self._aspect, self._astray = camera.aspect, False
        viewpoint = "camera" if moment.look == "through" else "outside"
        goal = view_from(viewpoint, moment.camera, _seen(moment), self._aspect)
        self._goal = goal
        done = (time.monotonic() - self._begun) / FLIGHT_SECONDS
        view = goal if self._start is None or done >= 1 else between(self._start, goal, done)
        with self._client.atomic():
            camera.position, camera.look_at = view.position, view.look_at
            camera.fov = view.fov_rad
        if done >= 1:
            self._start = None

    def _told(self, _: object) -> None:
        # A browser that is still setting its scene up turns the first view it is sent along with
        # the scene, or forgets it: it is sent again until the browser says that it is there.
        if self._goal is not None and not self._arrived:
            off = np.linalg.norm(self._client.camera.position - self._goal.position)
            self._arrived = bool(off < 0.01)
            self._astray = not self._arrived

    @property
    def _reshaped(self) -> bool:
        # A window of another shape shows another part of the camera's picture.
        return self._moment is not None and abs(self._client.camera.aspect - self._aspect) > 0.01


def _seen(moment: PracticeMoment) -> Array:
    """(N, 3) the camera with the tips of its axes, the board and the target."""
    outline = moment.board.outline
    boards = [pose.apply(outline) for pose in (moment.pose, moment.target)]
    return np.concatenate([_TIPS, *boards])

"""The scene cameras of a page's tabs, or of one tab, and their flights between views.

    rig = CameraRig(server, wake=page.wake)                 # or CameraRig(client), for one tab
    rig.go(lambda aspect: view_from("outside", camera, points, aspect))
    ... in the drawing loop: if rig.is_due: rig.advance()

A view is a function of the window's aspect (width over height), so that it fits every tab. A new
tab, or one whose aspect changes, jumps to the view at once.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import viser

from venus3d.render.viewpoints import FLIGHT_SECONDS, SceneCamera, between
from venus3d.scene.web.scene_view import Host

View = Callable[[float], SceneCamera]
"""A view, as a function of the window's width over height."""
NEAR, FAR = 0.01, 50.0
"""Clipping planes, metres."""
_USUAL_ASPECT = 1.0
_THERE = 0.01
"""A tab this near its goal, metres, has arrived."""


class CameraRig:
    """The cameras of all tabs of a server, or of one tab. One thread calls `go` and `advance`."""

    def __init__(
        self, host: Host, *, wake: Callable[[], None] = lambda: None, tolerance: float = 0.01
    ) -> None:
        """Nothing moves until `go`.

        Args:
            wake: called on viser's threads when `advance` is due without a flight.
            tolerance: relative change of a window's aspect beyond which its view is set again.
        """
        self._host, self._wake, self._tolerance = host, wake, tolerance
        self._tabs: dict[int, _Tab] = {}
        self._view: View | None = None
        self._lock = threading.Lock()
        if isinstance(host, viser.ClientHandle):
            self._come(host)
        else:
            host.initial_camera.near, host.initial_camera.far = NEAR, FAR
            host.on_client_connect(self._come)
            host.on_client_disconnect(self._leave)

    def go(self, view: View, *, at_once: bool = False) -> None:
        """Fly to this view, or jump there."""
        self._view = view
        if not isinstance(self._host, viser.ClientHandle):
            first, usual = self._host.initial_camera, view(_USUAL_ASPECT)
            first.position, first.look_at, first.fov = usual.position, usual.look_at, usual.fov_rad
        now = time.monotonic()
        for tab in self._all:
            tab.start = None if at_once else tab.seen
            tab.begun, tab.aspect = now, 0.0 if at_once else tab.aspect

    @property
    def is_due(self) -> bool:
        """Whether `advance` has something to do."""
        return self._view is not None and any(tab.is_due(self._tolerance) for tab in self._all)

    def advance(self) -> None:
        """Advance the cameras."""
        if self._view is not None:
            for tab in self._all:
                if tab.is_due(self._tolerance):
                    tab.advance(self._view)

    @property
    def _all(self) -> tuple[_Tab, ...]:
        with self._lock:
            return tuple(self._tabs.values())

    def _come(self, client: viser.ClientHandle) -> None:
        tab = _Tab(client)
        with self._lock:
            self._tabs[client.client_id] = tab

        def moved(_: object) -> None:  # also when the window is resized
            tab.check()
            if self._view is not None and tab.is_due(self._tolerance):
                self._wake()

        client.camera.on_update(moved)
        self._wake()

    def _leave(self, client: viser.ClientHandle) -> None:
        with self._lock:
            self._tabs.pop(client.client_id, None)


@dataclass(eq=False)
class _Tab:
    """One tab's camera."""

    client: viser.ClientHandle
    start: SceneCamera | None = None
    """Start of the flight; None without one."""
    begun: float = 0.0
    aspect: float = 0.0
    """The window's aspect when its view was last set."""
    goal: SceneCamera | None = None
    arrived: bool = False
    astray: bool = False

    @property
    def seen(self) -> SceneCamera:
        camera = self.client.camera
        return SceneCamera(camera.position.copy(), camera.look_at.copy(), camera.fov)

    @property
    def window(self) -> float:
        camera = self.client.camera
        return camera.image_width / max(camera.image_height, 1)

    def is_due(self, tolerance: float) -> bool:
        other_shape = abs(self.window - self.aspect) > tolerance * self.window
        return self.start is not None or other_shape or self.astray

    def check(self) -> None:
        # A browser that is still setting up its scene changes or drops the first view: resend it
        # until the browser confirms.
        if self.goal is not None and not self.arrived:
            off = np.linalg.norm(self.client.camera.position - self.goal.position)
            self.arrived = bool(off < _THERE)
            self.astray = not self.arrived

    def advance(self, view: View) -> None:
        self.aspect, self.astray = self.window, False
        self.goal = view(self.aspect)
        shown, done = self.goal, (time.monotonic() - self.begun) / FLIGHT_SECONDS
        if self.start is not None and done < 1:
            shown = between(self.start, self.goal, max(0.0, done))
        else:
            self.start = None
        camera = self.client.camera
        with self.client.atomic():
            camera.position, camera.look_at = shown.position, shown.look_at
            camera.fov = shown.fov_rad

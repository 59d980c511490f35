"""The scene cameras of a page's tabs, or of one tab, and their flights between views.

    rig = CameraRig(server, wake=page.wake)                 # or CameraRig(client), for one tab
    rig.go(lambda aspect: view_from("outside", camera, points, aspect))
    ... in the drawing loop: if rig.is_due: rig.advance()

A view is a function of the window's aspect (width over height), so that it fits every tab. A new
tab, or one whose aspect changes, jumps to the view at once. A browser that is still setting up its
scene may drop or change its first view; it is sent again until the browser confirms it.
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

Framing = Callable[[float], SceneCamera]
"""How a scene is framed: the view for a window of this width over height."""
NEAR, FAR = 0.01, 50.0
"""Clipping planes, metres."""
_USUAL_ASPECT = 1.0
_THERE = 0.01
"""A tab this near its goal, metres, has arrived."""
_RESENT, _FIRST_RESENT_S = 5, 0.25
"""How often an unconfirmed first view is sent again, and after how long at first: twice as long
each time."""
_A_TURN = 0.5
"""Two reports nearer than this, relative to the distance looked at, are a person's movement; what a
browser does while it starts are jumps."""


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
        self._view: Framing | None = None
        self._lock = threading.Lock()
        if isinstance(host, viser.ClientHandle):
            self._come(host)
        else:
            host.initial_camera.near, host.initial_camera.far = NEAR, FAR
            host.on_client_connect(self._come)
            host.on_client_disconnect(self._leave)

    def go(self, view: Framing, *, at_once: bool = False) -> None:
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

        # Also when the window is resized. On the loop's thread: what is read there is what the
        # browser has just sent, and not what was set meanwhile.
        async def moved(_: object) -> None:
            tab.report()
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
    settled: bool = False
    """Whether the browser has shown its goal once, or a person has turned it, or it never will."""
    resent: int = 0
    sent_at: float = 0.0
    reported: SceneCamera | None = None

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
        return self.start is not None or other_shape or self._unheard

    @property
    def _unheard(self) -> bool:
        """Whether the browser has had time enough to confirm its first view, and has not."""
        if self.settled or self.goal is None:
            return False
        return time.monotonic() - self.sent_at > _FIRST_RESENT_S * 2**self.resent

    def report(self) -> None:
        """Note where the browser says that its camera is."""
        seen, before = self.seen, self.reported
        self.reported = seen
        if self.settled or self.goal is None:
            return
        there = np.linalg.norm(seen.position - self.goal.position) < _THERE
        self.settled = bool(there) or (before is not None and _is_turned(before, seen))

    def advance(self, view: Framing) -> None:
        again = self._unheard
        self.resent += again
        self.settled = self.settled or self.resent > _RESENT
        self.aspect, self.sent_at = self.window, time.monotonic()
        self.goal = view(self.aspect)
        shown, done = self.goal, (self.sent_at - self.begun) / FLIGHT_SECONDS
        if self.start is not None and done < 1:
            shown = between(self.start, self.goal, max(0.0, done))
        else:
            self.start = None
        with self.client.atomic():
            if again:
                # viser sends nothing that it thinks is there already.
                self._set(SceneCamera(shown.position + 1.0, shown.look_at, 0.9 * shown.fov_rad))
            self._set(shown)

    def _set(self, view: SceneCamera) -> None:
        camera = self.client.camera
        camera.position, camera.look_at = view.position, view.look_at
        camera.fov = view.fov_rad  # the browser answers this with its camera


def _is_turned(before: SceneCamera, after: SceneCamera) -> bool:
    """Whether a person turned or moved the camera a little between two reports."""
    moved = float(np.linalg.norm(after.position - before.position))
    distance = float(np.linalg.norm(after.position - after.look_at))
    return 1e-4 * distance < moved < _A_TURN * distance
